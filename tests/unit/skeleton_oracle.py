#!/usr/bin/python3
"""Checks the skeletons that print_skeleton makes of real bones against their voxels, read with nibabel.

At every level each voxel is given to the nearest printed centre; the classes must then have the printed voxels, centres
and covariances (so the partition is a fixed point), the variance must decompose, and eigenvalues, axes, rho and the
ratios must be those that numpy finds.

skeleton_oracle.py PRINT_SKELETON DATA_FOLDER"""
import pathlib
import subprocess
import sys

try:
    import nibabel
    import numpy
except ImportError:
    print("skipped: nibabel is not installed")
    sys.exit(77)

FILES = (
    "MyoSimHand/generic_hamate_R.nii.gz",
    "VisibleHuman_Denver/VHF_fibula_R.nii.gz",
    "VisibleHuman_Denver/VHM_talus_L.nii.gz",
    "io_variants/*oblique*.nii.gz",
    "io_variants/*aniso*.nii.gz",
)
LEVELS = 12


class Node:
    def __init__(self, numbers):
        self.voxels, self.weight = numbers[0], numbers[1]
        self.centre = numbers[2:5]
        self.covariance = numbers[5:14].reshape(3, 3)
        self.eigenvalues = numbers[14:17]
        self.axes = numbers[17:26].reshape(3, 3)
        self.rho = numbers[26]


def read_skeleton(program, path, metric, start):
    """[(split class, split ratio, intraclass ratio, nodes)]"""
    text = subprocess.run(
        [program, path, str(LEVELS), metric, start], check=True, capture_output=True, text=True
    ).stdout
    levels = []
    for line in text.splitlines():
        kind, *fields = line.split()
        numbers = numpy.array(fields, dtype=float)
        if kind == "level":
            levels.append((int(numbers[1]), numbers[2], numbers[3], []))
        else:
            levels[-1][3].append(Node(numbers))
    return levels


def read_points(path):
    image = nibabel.load(path)
    values = numpy.asanyarray(image.dataobj)
    index = numpy.argwhere(values == values[values != 0].min())
    return index @ image.affine[:3, :3].T + image.affine[:3, 3]


def close(found, expected, scale, what):
    error = numpy.abs(numpy.asarray(found) - expected).max()
    assert error <= 1e-6 * scale, f"{what}: {found}, expected {expected}"


def nearest(points, nodes, whiten):
    """The index of the nearest centre, and the labels that would do within 1e-6 of the object's squared size."""
    centres = numpy.array([node.centre for node in nodes])
    mapped, targets = points @ whiten, centres @ whiten
    squared = ((mapped[:, None, :] - targets[None, :, :]) ** 2).sum(axis=2)
    size = numpy.ptp(mapped, axis=0).max() ** 2
    return squared.argmin(axis=1), squared <= squared.min(axis=1, keepdims=True) + 1e-6 * size


def check_level(points, level, whiten, root):
    nodes = level[3]
    labels, allowed = nearest(points, nodes, whiten)
    scale = root.eigenvalues[0]
    inside = 0
    for j, node in enumerate(nodes):
        certain = allowed.sum(axis=1) == 1
        ties = allowed[~certain][:, j].sum()
        mine = points[labels == j]
        assert abs(len(mine) - node.voxels) <= ties, f"class {j}: {node.voxels} voxels, expected {len(mine)}"
        if ties == 0:
            close(node.centre, mine.mean(axis=0), scale**0.5, "centre")
            close(node.covariance, numpy.cov(mine.T, bias=True).reshape(3, 3), scale, "covariance")
        inside += node.weight * numpy.trace(node.covariance @ whiten @ whiten.T)
        values = numpy.linalg.eigvalsh(node.covariance)[::-1]
        close(node.eigenvalues, values, scale, "eigenvalues")
        close(node.axes @ node.axes.T, numpy.eye(3), 1, "axes")
        close(node.axes @ node.covariance @ node.axes.T, numpy.diag(values), scale, "axes")
        assert numpy.linalg.det(node.axes) > 0
        close(node.rho, numpy.linalg.norm(node.centre - root.centre), scale**0.5, "rho")
    weights = numpy.array([node.weight for node in nodes])
    centres = numpy.array([node.centre for node in nodes])
    assert weights.sum() == root.weight == len(points)
    between = numpy.cov(centres.T, aweights=weights, bias=True) if len(nodes) > 1 else numpy.zeros((3, 3))
    within = sum(node.weight / root.weight * node.covariance for node in nodes)
    close(between + within, root.covariance, scale, "decomposition")
    whole = root.weight * numpy.trace(root.covariance @ whiten @ whiten.T)
    close(level[2], inside / whole, 3, "intraclass ratio")


def check(program, path, metric, start):
    points = read_points(path)
    levels = read_skeleton(program, path, metric, start)
    assert len(levels) == LEVELS
    root = levels[0][3][0]
    drift = root.centre - points.mean(axis=0)
    assert abs(drift).max() < numpy.ptp(points, axis=0).max() / 1024, f"the whole lies {drift} mm off"
    points += drift  # clouds round the offset of their affine, and only that
    whiten = numpy.eye(3)
    if metric == "mahalanobis":
        values, vectors = numpy.linalg.eigh(numpy.cov(points.T, bias=True))
        whiten = vectors / values**0.5
    for level in levels:
        check_level(points, level, whiten, root)
    for above, below in zip(levels, levels[1:]):
        assert 0 <= below[0] < len(above[3]) and 0 < below[1] < 1
        assert below[2] < above[2], "the intraclass ratio does not fall"


def main():
    program, data = sys.argv[1], pathlib.Path(sys.argv[2])
    paths = sorted(path for pattern in FILES for path in data.glob(pattern))
    if not paths:
        print(f"skipped: no bones in {data}")
        sys.exit(77)
    for path in paths:
        for metric in ("euclidean", "mahalanobis"):
            for start in ("plain", "coarse"):
                try:
                    check(program, path, metric, start)
                except AssertionError as failure:
                    sys.exit(f"{path.name}, {metric}, {start}: {failure}")
    print(f"{len(paths)} bones agree")


if __name__ == "__main__":
    main()
