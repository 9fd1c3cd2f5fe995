#!/usr/bin/python3
"""Least assignment costs by SciPy: reads matrices (k, then k*k numbers, repeated) from a file, prints one cost a line."""
import sys

import numpy
from scipy.optimize import linear_sum_assignment

numbers = iter(open(sys.argv[1]).read().split())
for k in numbers:
    k = int(k)
    costs = numpy.array([float(next(numbers)) for _ in range(k * k)]).reshape(k, k)
    rows, columns = linear_sum_assignment(costs)
    print(repr(float(costs[rows, columns].sum())))
