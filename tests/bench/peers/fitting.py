"""SciPy's least squares on what bench_fit fitted: fitting.py FILE. One superquadric a class, from the same start, between the
same bounds, to the same points with the same residuals and pull, written down again from eskel_surface.h and joint_fit.c."""
import sys
import time

import numpy
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from measure import least_milliseconds, show

ROUNDING = 2.0**-24
# x, y, z; rotation vector; ln radii; e1, e2
LOW = [-numpy.inf] * 6 + [-1.5] * 3 + [0.2] * 2
HIGH = [numpy.inf] * 6 + [1.2] * 3 + [1.8] * 2
BEGIN = numpy.array([0.0] * 9 + [1, 1])


class Class:
    def __init__(self, head, start, end, points):
        self.length, spacing = head
        self.centre, self.axes, self.radii = start[:3], start[3:12].reshape(3, 3), start[12:15]
        self.points = points
        self.pull = (1e-3 * spacing**2) ** 0.5
        moved = self.axes @ (end[:3] - self.centre) / self.radii[2]
        turned = Rotation.from_matrix((end[3:12].reshape(3, 3) @ self.axes.T).T).as_rotvec()
        self.end = numpy.concatenate([moved, turned, numpy.log(end[12:15] / self.radii), end[15:17]])

    def residuals(self, t):
        """Distances of the first order, saturated, each over the root of their count; then the pull."""
        radii = self.radii * numpy.exp(t[6:9])
        axes = Rotation.from_rotvec(t[3:6]).as_matrix().T @ self.axes
        u = ((self.points - self.centre - self.radii[2] * t[:3] @ self.axes) @ axes.T / radii).T
        x, y, z = u * u + ROUNDING
        e1, e2 = t[9:]
        xs, ys, zs = x ** (1 / e1), y ** (1 / e1), z ** (1 / e2)
        across = xs + ys
        powered = across ** (e1 / e2)
        whole = powered + zs
        size = whole**e2
        shares = powered / across * xs / x, powered / across * ys / y, zs / z
        square = sum((2 * size / whole * s * v / r) ** 2 for s, v, r in zip(shares, u, radii))
        delta = (size - 1) / numpy.sqrt(square + ((size - 1) / self.length) ** 2)
        return numpy.concatenate([delta / len(delta) ** 0.5, self.pull * numpy.delete(t - BEGIN, [3, 4, 5])])

    def fit(self):
        self.found = least_squares(self.residuals, BEGIN, bounds=(LOW, HIGH), x_scale="jac")


def read(path):
    classes = []
    with open(path, encoding="utf-8") as lines:
        for line in lines:
            name, *numbers = line.split()
            if name == "class":
                classes.append({"point": []})
            target, numbers = classes[-1], numpy.array(numbers, float)
            if name == "point":
                target["point"].append(numbers)
            else:
                target[name] = numbers
    return [Class(c["class"], c["start"], c["end"], numpy.array(c["point"])) for c in classes]


classes = read(sys.argv[1])
count = len(classes)
show("fit/residual", "NumPy", 1e3 * sum(least_milliseconds(lambda: c.residuals(c.end)) for c in classes) / count, "us")
scipy = "SciPy least_squares"
show("fit/class", scipy, sum(least_milliseconds(c.fit) for c in classes) / count, "ms")
begin = time.process_time()
for c in classes:
    c.fit()
show("fit/class", scipy, 1e3 * (time.process_time() - begin) / count, "ms of processor")
ours = [sum(c.residuals(c.end) ** 2) for c in classes]
theirs = [2 * c.found.cost for c in classes]
show("fit/class", "eskel, Tabu and polish", (sum(ours) / count) ** 0.5, "mm rms")
show("fit/class", scipy, (sum(theirs) / count) ** 0.5, "mm rms")
show("fit/class", scipy, max(o / t for o, t in zip(ours, theirs)), "is the most that eskel's cost is over it")
show("fit/class", scipy, sum(c.found.nfev for c in classes) / count, "evaluations with a Jacobian each")
