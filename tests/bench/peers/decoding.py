"""nibabel's load of a label map into a NumPy array: decoding.py FIGURE FILE"""
import sys

import nibabel
import numpy

from measure import least_milliseconds, peak_megabytes, show

figure, path = sys.argv[1:]
show(figure, "nibabel to an array", least_milliseconds(lambda: numpy.asanyarray(nibabel.load(path).dataobj)), "ms")
show(figure, "nibabel to an array", peak_megabytes(), "MB")
