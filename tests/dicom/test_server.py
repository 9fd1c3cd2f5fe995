"""DICOM segmentations posted to a started eskeld, and read by eskel."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

from segmentation import *

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "http"))
from daemon import Daemon

PLAIN = numpy.diag([-1.0, -1.0, 1.0, 1.0])
PRIVATE = [b"Nobody^Knows", b"Nobody", b"4711-0815", b"Private matters"]


def hook(mirrored):
    """A shape with a handedness."""
    voxels = numpy.zeros((60, 28, 44), bool)
    voxels[4:10, 4:10, 4:40] = True
    voxels[4:27, 4:9, 4:9] = True
    voxels[5:9, 4:24, 30:36] = True
    return voxels[::-1] if mirrored else voxels


def hooks():
    side = lambda *of: {"AnatomicRegionSequence": nested(code("T-1", "SRT", "Hook", AnatomicRegionModifierSequence=nested(code(*of))))}
    segments = [segment(3, "Segment_1", **side("G-A100", "SRT", "Right")),
                segment(9, "Hook", **side("7771000", "SCT", "Left"))]
    frames = frames_of(hook(False), PLAIN, 3) + frames_of(hook(True), PLAIN, 9)
    return build(frames[::-1], segments, PLAIN)


def contents(folder):
    """Of all files below it; some come and go."""
    for path in folder.rglob("*"):
        try:
            yield path.read_bytes()
        except (FileNotFoundError, IsADirectoryError):
            pass


class Server(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = save(hooks(), pathlib.Path(self.folder.name) / "hooks.dcm")

    def post(self, daemon, target, body=None):
        status, _, answer = daemon.request("POST", target, body or self.path.read_bytes(),
                                           {"Content-Type": "application/dicom"})
        return status, answer

    def test_segments_are_stored_recognised_and_checked_and_nothing_of_the_patient(self):
        with Daemon() as daemon:
            status, stored = self.post(daemon, "/shapes?subject=A")
            self.assertEqual(201, status, stored)
            shapes = stored["shapes"]
            self.assertEqual([(3, "Hook right", "hook", "right"), (9, "Hook left", "hook", "left")],
                             [(s["label"], s["name"], s["class"], s["side"]) for s in shapes])
            self.assertEqual([int(hook(False).sum())] * 2, [s["voxels"] for s in shapes])
            status, found = self.post(daemon, "/recognize?label=9")
            self.assertEqual(200, status, found)
            result, = found["results"]
            self.assertEqual((shapes[1]["id"], "Hook left"), (result["query"]["id"], result["query"]["name"]))
            self.assertEqual({s["id"] for s in shapes}, {n["id"] for n in result["neighbours"]})
            status, checked = self.post(daemon, "/check")
            self.assertEqual(200, status, checked)
            self.assertEqual(2, len(checked["labels"]))
            status, refused = self.post(daemon, "/shapes", self.path.read_bytes()[:400])
            self.assertEqual(422, status, refused)
            for private in PRIVATE:
                for text in (json.dumps([stored, found, checked, refused]).encode(), daemon.log_text().encode(),
                             *contents(pathlib.Path(daemon.database).parent)):
                    self.assertNotIn(private, text)

    def test_the_same_object_has_the_same_id_in_any_order_of_frames(self):
        with Daemon() as daemon:
            _, first = self.post(daemon, "/shapes?label=3")
            made = hooks()
            made.PerFrameFunctionalGroupsSequence = made.PerFrameFunctionalGroupsSequence[::-1]
            rows = numpy.unpackbits(numpy.frombuffer(made.PixelData, numpy.uint8), bitorder="little")
            frames = rows[:made.NumberOfFrames * made.Rows * made.Columns].reshape(made.NumberOfFrames, -1)[::-1]
            made.PixelData = numpy.packbits(frames.ravel(), bitorder="little").tobytes()
            save(made, self.path)
            status, second = self.post(daemon, "/shapes?label=3")
            self.assertEqual(200, status, second)
            self.assertEqual(first["shapes"][0]["id"], second["shapes"][0]["id"])

    def test_the_command_line_reads_them_too(self):
        run = subprocess.run([os.environ["ESKEL"], "skeleton", "--json", "--label", "9", str(self.path)],
                             capture_output=True, text=True, timeout=60)
        self.assertEqual(0, run.returncode, run.stderr)
        self.assertIn(str(int(hook(True).sum())), run.stdout)
        self.path.write_bytes(self.path.read_bytes()[:400])
        run = subprocess.run([os.environ["ESKEL"], "skeleton", str(self.path)], capture_output=True, text=True, timeout=60)
        self.assertIn("dcmdrle could not decode the DICOM file", run.stderr)


if __name__ == "__main__":
    unittest.main()
