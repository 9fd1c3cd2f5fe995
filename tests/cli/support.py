"""Runs eskel and eskeld, and makes volumes for them. The build says where they are: ESKEL and ESKELD."""
import gzip
import os
import re
import shutil
import struct
import subprocess
import tempfile
import unittest

import numpy

ESKEL, ESKELD = os.environ["ESKEL"], os.environ["ESKELD"]
NOWHERE = "http://127.0.0.1:9"  # the discard port: nobody listens


def eskel(*arguments, environment=None, stdin=None):
    """One run without a terminal; .returncode, .stdout and .stderr."""
    inherited = {k: v for k, v in os.environ.items() if not k.startswith("ESKEL_") and k != "NO_COLOR"}
    return subprocess.run([ESKEL, *map(str, arguments)], capture_output=True, text=True, timeout=120,
                          stdin=stdin or subprocess.DEVNULL, env={**inherited, "LC_ALL": "C.UTF-8", **(environment or {})})


def write_nifti(path, labels, spacing=1.0, extension=b""):
    """A NIfTI-1 file of 16-bit labels, x to the right, y to the front, z to the head; gzipped if it is called .gz. The
    header extension has code 0."""
    if extension:
        extension += bytes(-(len(extension) + 8) % 16)
        extension = struct.pack("<2i", len(extension) + 8, 0) + extension
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, *labels.shape, 1, 1, 1, 1)
    struct.pack_into("<2h", header, 70, 4, 16)  # DT_INT16
    struct.pack_into("<8f", header, 76, 1, *[spacing] * 3, 0, 0, 0, 0)
    struct.pack_into("<f", header, 108, 352 + len(extension))
    struct.pack_into("<B", header, 123, 2)  # mm
    struct.pack_into("<2h", header, 252, 0, 2)  # sform_code
    for row in range(3):
        struct.pack_into("<4f", header, 280 + 16 * row, *[spacing * (row == c) for c in range(3)], 0)
    header[344:349] = b"n+1\0" + bytes([bool(extension)])
    data = bytes(header) + extension + labels.astype("<i2").tobytes(order="F")
    with (gzip.open if str(path).endswith(".gz") else open)(path, "wb") as file:
        file.write(data)


def hook():
    """A shape with a handedness: three bars of different lengths and widths at right angles."""
    voxels = numpy.zeros((36, 28, 44), bool)
    voxels[4:10, 4:10, 4:40] = True
    voxels[4:30, 4:9, 4:9] = True
    voxels[5:9, 4:24, 30:36] = True
    return voxels


def ball(radius):
    grid = numpy.indices([2 * radius + 5] * 3) - (radius + 2)
    return (grid ** 2).sum(0) <= radius ** 2


def side_by_side(*shapes):
    """Labels 1, 2, 3 ... along x."""
    extent = numpy.max([s.shape for s in shapes], axis=0)
    labels = numpy.zeros((sum(s.shape[0] for s in shapes), extent[1], extent[2]), numpy.int16)
    x = 0
    for label, shape in enumerate(shapes, 1):
        labels[x:x + shape.shape[0], :shape.shape[1], :shape.shape[2]][shape] = label
        x += shape.shape[0]
    return labels


class Folder(unittest.TestCase):
    """Tests with a folder of their own, removed afterwards."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="eskel-cli-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def write(cls, name, text):
        with open(cls.path(name), "wb") as file:
            file.write(text if isinstance(text, bytes) else text.encode())
        return cls.path(name)

    def assert_run(self, run, code, *said):
        """The exit code, and parts of the one line on standard error; nothing there for code 0."""
        self.assertEqual(run.returncode, code, run.stderr)
        for part in said:
            self.assertIn(part, run.stderr)
        if code:
            self.assertRegex(run.stderr, r"(?m)\Aeskel: [^\n]+\n\Z")


class Served(Folder):
    """Tests against a started eskeld."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.database = cls.path("shapes.db")
        cls.before_start()
        cls.log = open(cls.path("eskeld.log"), "w+")
        cls.addClassCleanup(cls.log.close)
        cls.daemon = subprocess.Popen([ESKELD, "--database", cls.database, "--listen", "127.0.0.1:0"],
                                      stdout=subprocess.PIPE, stderr=cls.log, text=True)
        cls.addClassCleanup(cls.stop)
        cls.url = cls.daemon.stdout.readline().strip()
        if not cls.url:
            cls.log.seek(0)
            raise AssertionError("eskeld did not start: " + cls.log.read())

    @classmethod
    def before_start(cls):
        """For what the database should hold before it is served."""

    @classmethod
    def stop(cls):
        cls.daemon.terminate()
        cls.daemon.stdout.close()
        if cls.daemon.wait(60):
            cls.log.seek(0)
            raise AssertionError("eskeld ended badly: " + cls.log.read()[-8000:])

    @classmethod
    def eskel(cls, *arguments, environment=None, stdin=None):
        return eskel(*arguments, environment={"ESKEL_SERVER": cls.url, **(environment or {})}, stdin=stdin)

    @staticmethod
    def rows(run):
        """The rows of the first table that a successful run printed, a dict each."""
        if run.returncode:
            raise AssertionError(f"exit code {run.returncode}: {run.stderr}")
        heading, *rows = [re.split(r" {2,}", line.strip()) for line in run.stdout.split("\n\n")[0].splitlines()]
        return [dict(zip(heading, row)) for row in rows]
