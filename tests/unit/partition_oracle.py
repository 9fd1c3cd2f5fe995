#!/usr/bin/python3
"""Checks partition signatures and their differences against numpy: partition_oracle.py PRINT_PARTITION"""
import itertools
import subprocess
import sys

try:
    import numpy
except ImportError:
    print("skipped: numpy is not installed")
    sys.exit(77)


def read(program, seed, level):
    """{(word, shape): numbers}"""
    text = subprocess.run([program, str(seed), str(level)], check=True, capture_output=True, text=True).stdout
    rows = (line.split() for line in text.splitlines())
    return {(word, of): numpy.array(numbers, dtype=float) for word, of, *numbers in rows}


def signature(centres):
    pairs = numpy.array(list(itertools.combinations(range(len(centres)), 2)), dtype=int).reshape(-1, 2)
    fours = numpy.array(list(itertools.combinations(range(len(centres)), 4)), dtype=int).reshape(-1, 4)
    distances = numpy.linalg.norm(centres[pairs[:, 0]] - centres[pairs[:, 1]], axis=1)
    homogeneous = numpy.concatenate([numpy.ones((len(centres), 1)), centres], axis=1)
    return distances, numpy.linalg.det(homogeneous[fours]) / 6 if len(fours) else numpy.zeros(0)


def mean(numbers):
    return numbers.mean() if len(numbers) else 0


def difference(a, b, scale):
    distances = mean(abs(a[0] - scale * b[0]))
    v, w = a[1], scale**3 * b[1]
    return [distances, mean(abs(abs(v) - abs(w))), mean(abs(v - w)), mean(abs(v + w))]


def check(found, expected, what):
    assert len(found) == len(expected), f"{what}: {len(found)} numbers, expected {len(expected)}"
    if len(found) and abs(found - expected).max() > 1e-9 * (1 + abs(numpy.asarray(expected)).max()):
        raise AssertionError(f"{what}: {found}, expected {expected}")


def main():
    for seed, level in itertools.product(range(5), (1, 2, 3, 4, 6, 11, 16, 32)):
        found = read(sys.argv[1], seed, level)
        shapes = {name: found["centres", name][1:].reshape(-1, 3) for name in "AB"}
        shapes["B"] = shapes["B"][found["order", "-"].astype(int)]
        expected = {name: signature(centres) for name, centres in shapes.items()}
        for name in "AB":
            check(found["distances", name], expected[name][0], f"distances {name} {level}")
            check(found["tetrahedra", name], expected[name][1], f"tetrahedra {name} {level}")
        scale = (found["centres", "A"][0] / found["centres", "B"][0]) ** (1 / 3)
        check(found["fixed", "-"], difference(expected["A"], expected["B"], 1), f"fixed {level}")
        check(found["free", "-"], difference(expected["A"], expected["B"], scale), f"free {level}")
    print("40 pairs agree")


if __name__ == "__main__":
    main()
