#!/usr/bin/python3
"""Compares print_labels with teem and numpy: random volumes that teem's unu stores in every encoding, type and byte order,
in every space, and the NRRD files below the folders given as unu reads them.

nrrd_oracle.py PRINT_LABELS FOLDER..."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

try:
    import numpy
except ImportError:
    print("skipped: numpy is not installed")
    sys.exit(77)

UNU = shutil.which("teem-unu") or shutil.which("unu")
TYPES = {"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "int64": "i8",
         "uint64": "u8", "float": "f4", "double": "f8", "signed char": "i1", "unsigned char": "u1", "short": "i2",
         "unsigned short": "u2", "int": "i4", "unsigned int": "u4", "long long int": "i8",
         "unsigned long long int": "u8"}
SPACES = {"right-anterior-superior": (1, 1), "left-anterior-superior": (-1, 1), "left-posterior-superior": (-1, -1)}
ENCODINGS = ["raw", "gzip", "bzip2", "ascii"]


def unu_save(source, target, encoding, endian="little"):
    subprocess.run([UNU, "save", "-f", "nrrd", "-e", encoding, "-en", endian, "-i", str(source), "-o", str(target)],
                   check=True, capture_output=True)


def read_raw(path):
    """Values by (x, y, z) and the affine to RAS, of a file as unu writes it raw."""
    header, data = path.read_bytes().split(b"\n\n", 1)
    fields = dict(line.split(": ", 1) for line in header.decode().splitlines()[1:] if re.match(r"[a-z ]+: ", line))
    sizes = [int(size) for size in fields["sizes"].split()]
    values = numpy.frombuffer(data, "<" + TYPES[fields["type"]]).reshape(sizes, order="F")
    affine = numpy.eye(4)
    vectors = re.findall(r"\(([^)]*)\)", fields["space directions"])
    affine[:3, :3] = numpy.array([[float(number) for number in vector.split(",")] for vector in vectors]).T
    affine[:3, 3] = [float(number) for number in fields["space origin"].strip("()").split(",")]
    return values, numpy.diag([*SPACES[fields["space"]], 1, 1]) @ affine


def expected_labels(values, affine):
    """{label: (voxels, volume, centroid)}"""
    result = {}
    for label in numpy.unique(values[values != 0]):
        index = numpy.argwhere(values == label)
        centroid = affine[:3, :3] @ index.mean(axis=0) + affine[:3, 3]
        result[int(label)] = (len(index), len(index) * abs(numpy.linalg.det(affine[:3, :3])), centroid)
    return result


def compare(program, path, values, affine):
    printed = subprocess.run([program, str(path)], check=True, capture_output=True, text=True).stdout
    expected, lines = expected_labels(values, affine), printed.splitlines()
    assert [int(line.split()[0]) for line in lines] == sorted(expected), f"{path}: {printed}"
    for line in lines:
        label, voxels, volume, *centroid = line.split()[:6]
        want = expected[int(label)]
        where = f"{path}: {line}, expected {want}"
        assert int(voxels) == want[0], where
        assert abs(float(volume) - want[1]) <= 2e-6 * want[1], where
        # The canonical offset is rounded to 1/1024 of less than the largest matrix entry.
        assert numpy.abs(numpy.array(centroid, float) - want[2]).max() <= numpy.abs(affine[:3, :3]).max() / 1024, where
    return len(lines)


def write_random(rng, path):
    shape = rng.integers(1, 20, 3)
    kind = rng.choice(list(TYPES))
    values = numpy.zeros(shape, "<" + TYPES[kind])
    for label in rng.integers(1, 120, 4):
        low = rng.integers(0, shape)
        high = rng.integers(low, shape) + 1
        values[tuple(slice(a, b) for a, b in zip(low, high))] = label
    values[tuple(shape // 2)] = 1
    axes = numpy.linalg.qr(rng.normal(size=(3, 3)))[0] * rng.uniform(0.2, 5, 3)  # either handedness
    vectors = " ".join("(%r,%r,%r)" % tuple(axes[:, column].tolist()) for column in range(3))
    origin = "(%r,%r,%r)" % tuple(rng.uniform(-300, 300, 3).tolist())
    sizes = " ".join(str(size) for size in shape)
    path.write_bytes(f"NRRD0004\ntype: {kind}\ndimension: 3\nspace: {rng.choice(list(SPACES))}\nsizes: {sizes}\n"
                     f"space directions: {vectors}\nendian: little\nencoding: raw\nspace origin: {origin}\n\n".encode()
                     + values.tobytes(order="F"))


def main(program, folders):
    files = sorted(path for folder in folders for path in pathlib.Path(folder).rglob("*.nrrd"))
    labels = 0
    rng = numpy.random.default_rng(20)
    with tempfile.TemporaryDirectory() as folder:
        random, raw, stored = (pathlib.Path(folder, name) for name in ("random.nrrd", "raw.nrrd", "stored.nrrd"))
        for path in files:
            unu_save(path, raw, "raw")
            labels += compare(program, path, *read_raw(raw))
        for number in range(60):
            write_random(rng, random)
            unu_save(random, raw, "raw")
            encoding = ENCODINGS[number % len(ENCODINGS)]
            # Asked for the other byte order, unu exchanges the bytes of numbers before it writes them as text too.
            unu_save(random, stored, encoding, "big" if encoding != "ascii" and rng.integers(2) else "little")
            labels += compare(program, stored, *read_raw(raw))
    print(f"{len(files)} files and 60 random ones, {labels} labels agree")


if __name__ == "__main__":
    if not UNU:
        print("skipped: teem's unu is not installed")
        sys.exit(77)
    main(sys.argv[1], sys.argv[2:])
