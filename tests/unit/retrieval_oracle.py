#!/usr/bin/python3
"""Retrieval measures by their definitions: ties by going through every order of the equals, the rest by NumPy.

retrieval_oracle.py PRINT_RETRIEVAL"""
import itertools
import subprocess
import sys

try:
    import numpy
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

STEPS = 20


def measures_of_order(relevant):
    """Of one order, the nearest first, of which some are relevant."""
    n, total = len(relevant), relevant.sum()
    gains = 1 / numpy.maximum(1, numpy.log2(numpy.arange(1, n + 1)))
    page = min(32, n)
    hits = relevant[:page].sum()
    recall, precision = hits / total, hits / page
    return numpy.array([relevant[0], relevant[:total].sum() / total, relevant[:2 * total].sum() / total,
                        2 / (1 / recall + 1 / precision) if hits else 0, (gains * relevant).sum() / gains[:total].sum()])


def orders(distances):
    """Every order in which distances ascend."""
    groups = [numpy.flatnonzero(distances == value) for value in numpy.unique(distances)]
    for parts in itertools.product(*map(itertools.permutations, groups)):
        yield numpy.array([i for part in parts for i in part], int)


def measures(distances, relevant):
    if not relevant.any():
        return numpy.zeros(5 + STEPS)
    ranked = [relevant[order] for order in orders(distances)]
    plain = numpy.mean([measures_of_order(r) for r in ranked], axis=0)
    ranks = numpy.mean([numpy.flatnonzero(r) + 1 for r in ranked], axis=0)
    precisions = numpy.arange(1, len(ranks) + 1) / ranks
    curve = [max(p for j, p in enumerate(precisions, 1) if j * STEPS >= step * len(ranks)) for step in range(1, STEPS + 1)]
    return numpy.concatenate([plain, curve])


def expected(classes, subjects, distances):
    rows, counted = [], []
    for query, row in enumerate(distances):
        out = numpy.arange(len(classes)) == query
        if subjects[query] >= 0:
            out |= subjects == subjects[query]
        relevant = (classes[~out] == classes[query]) & (classes[query] >= 0)
        rows.append(measures(row[~out], relevant))
        counted.append(relevant.any())
    rows = numpy.array(rows)
    mean = rows[counted].mean(axis=0) if any(counted) else numpy.zeros(5 + STEPS)
    return numpy.vstack([rows, mean])


def random_set(generator, count, class_count, values):
    """Distances among so many values: few make ties. Among 0 values there is none."""
    classes = generator.integers(-1, class_count, count)
    subjects = generator.integers(-1, max(2, count // 3), count) if generator.random() < .5 else numpy.full(count, -1)
    distances = generator.integers(0, values, (count, count)) if values else generator.random((count, count))
    return classes, subjects, distances.astype(float)


def main(program):
    generator = numpy.random.default_rng(1)
    sets = [random_set(generator, int(generator.integers(1, 9)), int(generator.integers(1, 4)), values)
            for values in (1, 2, 3, 4, 9, 0) for _ in range(40)]
    sets += [random_set(generator, count, classes, 0) for count in (2, 31, 33, 40, 150) for classes in (1, 2, 5, 30)]
    text = "".join(f"{len(c)}\n{' '.join(map(str, c))}\n{' '.join(map(str, s))}\n"
                   f"{' '.join(repr(float(d)) for d in distances.flat)}\n" for c, s, distances in sets) + "0\n"
    printed = subprocess.run([program], input=text, capture_output=True, text=True, check=True).stdout
    got = numpy.array([line.split() for line in printed.splitlines()], float)
    wanted = numpy.vstack([expected(*one) for one in sets])
    worst = abs(got - wanted).max()
    print(f"{len(sets)} sets, {len(wanted)} rows, {int((wanted.sum(1) > 0).sum())} with a relevant shape: "
          f"largest difference {worst:.2g}")
    return got.shape != wanted.shape or not worst < 1e-12


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
