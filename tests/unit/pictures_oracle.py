#!/usr/bin/python3
"""Average linkage by SciPy and classical scaling by NumPy: pictures_oracle.py clustering|scaling FILE

FILE has matrices: n, then n * n distances, repeated. Prints, of each, the merges (first, second, height, size) or the
points of the plane with the sign of each coordinate such that its largest value is positive."""
import sys

import numpy
from scipy.cluster.hierarchy import linkage
from scipy.spatial.distance import squareform

numbers = iter(open(sys.argv[2]).read().split())
for n in numbers:
    n = int(n)
    distances = numpy.array([float(next(numbers)) for _ in range(n * n)]).reshape(n, n)
    if sys.argv[1] == "clustering":
        for first, second, height, size in linkage(squareform(distances, checks=False), "average"):
            print(int(first), int(second), repr(float(height)), int(size))
    else:
        centring = numpy.eye(n) - 1 / n
        values, vectors = numpy.linalg.eigh(-0.5 * centring @ distances ** 2 @ centring)
        points = vectors[:, :-3:-1] * numpy.sqrt(numpy.maximum(values[:-3:-1], 0))
        points *= numpy.sign(points[numpy.abs(points).argmax(0), [0, 1]])
        for x, y in points:
            print(repr(float(x)), repr(float(y)))
