#!/usr/bin/python3
"""Compares the joint fit with SciPy's least squares: fit_oracle.py PRINT_FIT

The potential, the residuals and the pull are written down again, from eskel_surface.h and joint_fit.c, with differences in the place
of derivatives. The cost that the fit states must be that of where it ended, and SciPy, from the same start, must not end
with a lower one."""
import subprocess
import sys

try:
    import numpy as np
    from scipy.optimize import least_squares
    from scipy.spatial.transform import Rotation
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

ROUNDING = 2.0**-24
# x, y, z; rotation vector; ln radii; taper x, y; bend x, y; twist; alpha; e1, e2
BOUNDS = [(-np.inf, np.inf)] * 6 + [(-1.5, 1.2)] * 3 + [(-1.2, 1.2)] * 2 + [(-1, 1)] * 2 + [(-1.5, 1.5), (0.5, 10)] + [(0.2, 1.8)] * 2
TARGETS = np.array([0] * 14 + [1] * 3)


def norm(u, v, e):
    return (u ** (1 / e) + v ** (1 / e)) ** e


def potential(parameters, starts, points):
    total = []
    for t, (centre, axes, radii) in zip(parameters.reshape(-1, 17), starts):
        turned = Rotation.from_rotvec(t[3:6]).as_matrix().T @ axes
        a, b, c = radii * np.exp(t[6:9])
        q = (points - centre - (t[:3] * radii[2]) @ axes) @ turned.T / c
        z = np.clip(q[:, 2], -1.25, 1.25)
        x, y = q[:, 0] - t[11] * z**2, q[:, 1] - t[12] * z**2
        cosine, sine = np.cos(t[13] * z), np.sin(t[13] * z)
        x, y = cosine * x + sine * y, cosine * y - sine * x
        x, y = x * c / a * np.exp(-t[9] * z), y * c / b * np.exp(-t[10] * z)
        u, v, w = x * x + ROUNDING, y * y + ROUNDING, q[:, 2] ** 2 + ROUNDING
        total.append(-t[14] * (norm(norm(u, v, t[15]), w, t[16]) - 1))
    return -np.logaddexp.reduce(total, axis=0)


def residuals(parameters, starts, data):
    points, kinds, margins, weights, length, pull = data
    step = 1e-6  # mm: creases are rounded within 2^-12 of a radius
    value = potential(parameters, starts, points)
    square = (value / length) ** 2
    for axis in np.eye(3) * step:
        square += ((potential(parameters, starts, points + axis) - potential(parameters, starts, points - axis)) / (2 * step)) ** 2
    delta = value / np.sqrt(square)
    residual = np.where(kinds == 2, -delta, delta) + margins
    residual = np.where((kinds > 0) & (residual < 0), 0, residual) * np.sqrt(weights)
    pulled = np.delete(parameters.reshape(-1, 17) - TARGETS, [3, 4, 5], axis=1).ravel() * np.sqrt(pull)
    return np.concatenate([residual, pulled])


def read(program, level, count):
    lines = subprocess.run([program, str(level), str(count)], check=True, capture_output=True, text=True).stdout.splitlines()
    table = {}
    for line in lines:
        name, *numbers = line.split()
        table.setdefault(name, []).append([float(n) for n in numbers])
    return {name: np.array(rows) for name, rows in table.items()}


def parameters_of(ends, starts):
    out = []
    for end, (centre, axes, radii) in zip(ends, starts):
        rotation = Rotation.from_matrix((end[3:12].reshape(3, 3) @ axes.T).T).as_rotvec()
        out.append(np.concatenate([axes @ (end[:3] - centre) / radii[2], rotation, np.log(end[12:15] / radii), end[15:]]))
    return np.concatenate(out)


def compare(program, level, count):
    table = read(program, level, count)
    starts = [(row[:3], row[3:12].reshape(3, 3), row[12:15]) for row in table["start"]]
    p = table["point"]
    pull = 1e-3 * table["spacing"][0, 0] ** 2 / level
    data = (p[:, 1:4], p[:, 0], p[:, 4], p[:, 5], table["length"][0, 0], pull)
    stated, ended = table["cost"][0, 0], np.sum(residuals(parameters_of(table["end"], starts), starts, data) ** 2)
    begin = np.tile(TARGETS.astype(float), level)
    low, high = np.array(BOUNDS * level).T
    found = least_squares(residuals, begin, args=(starts, data), bounds=(low, high), x_scale="jac", max_nfev=150)
    print(f"level {level}, {count} points: cost {stated:.6f}, computed again {ended:.6f}, SciPy {2 * found.cost:.6f}, "
          f"at the start {np.sum(residuals(begin, starts, data) ** 2):.4f}")
    return abs(ended / stated - 1) < 1e-4 and stated <= 2 * found.cost * 1.02


if __name__ == "__main__":
    good = [compare(sys.argv[1], level, count) for level, count in ((1, 150), (2, 200), (3, 250))]
    sys.exit(0 if all(good) else 1)
