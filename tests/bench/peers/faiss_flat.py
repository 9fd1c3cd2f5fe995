"""FAISS's flat index, one thread, forty floats a shape, Euclidean, without matching: what reading a whole library
costs at least when nothing is pruned. Its time does not depend on the numbers. faiss_flat.py SHAPES"""
import sys

import faiss
import numpy

from measure import least_milliseconds, peak_megabytes, show

count = int(sys.argv[1])
faiss.omp_set_num_threads(1)
index = faiss.IndexFlatL2(40)
random = numpy.random.default_rng(1)
for first in range(0, count, 10000):
    index.add(random.random((min(10000, count - first), 40), dtype=numpy.float32))
query = random.random((1, 40), dtype=numpy.float32)
figure = f"search-paper-level/shapes={count}"
show(figure, "FAISS flat, no matching", least_milliseconds(lambda: index.search(query, 5)), "ms")
show(figure, "FAISS flat, no matching", peak_megabytes(), "MB")
