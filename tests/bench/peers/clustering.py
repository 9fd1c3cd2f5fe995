"""scikit-learn's k-means on the voxels of every label of a volume, one level of ten classes only:
clustering.py FIGURE FILE. Reading the file and listing the voxels of a label are timed apart."""
import sys
import time

import nibabel
import numpy
from sklearn.cluster import BisectingKMeans, KMeans

from measure import least_milliseconds, peak_megabytes, show

figure, path = sys.argv[1:]
start = time.perf_counter()
volume = nibabel.load(path)
labels = numpy.asanyarray(volume.dataobj)
index = numpy.argwhere(labels)
points = nibabel.affines.apply_affine(volume.affine, index)
of = labels[tuple(index.T)]
clouds = [points[of == label] for label in numpy.unique(of)]
reading = 1e3 * (time.perf_counter() - start)


def cluster(make):
    for cloud in clouds:
        make().fit(cloud)


spent = least_milliseconds(lambda: cluster(lambda: KMeans(10, n_init=1, random_state=0)))
show(figure, "scikit-learn KMeans, 10 only", spent, "ms")
show(figure, "scikit-learn KMeans, 10 only", peak_megabytes(), "MB")
if len(clouds) > 1:
    show(figure, "nibabel and KMeans, 10 only", reading + spent, "ms")
spent = least_milliseconds(lambda: cluster(lambda: BisectingKMeans(10, random_state=0)))
show(figure, "scikit-learn BisectingKMeans, 10 only", spent, "ms")
