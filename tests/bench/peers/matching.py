"""scipy.optimize.linear_sum_assignment on the matrices of costs of files: matching.py FILE..."""
import sys
import time

import numpy
from scipy.optimize import linear_sum_assignment

from measure import peak_megabytes, show

for path in sys.argv[1:]:
    kind, k = path.rsplit("/", 1)[-1].split("-")
    matrices = numpy.fromfile(path, numpy.float32).astype(float).reshape(-1, int(k), int(k))
    start = time.perf_counter()
    done = 0
    while time.perf_counter() - start < 0.2:
        for matrix in matrices:
            linear_sum_assignment(matrix)
        done += len(matrices)
    figure = f"match-{kind}/k={k}"
    show(figure, "SciPy", 1e6 * (time.perf_counter() - start) / done, "us")
    show(figure, "SciPy", peak_megabytes(), "MB")
