"""Programs in the place of dcmdrle that do what an attacker would make it do."""
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time
import unittest

from segmentation import *

SLOW = "slow" in sys.argv[1:]
PLAIN = numpy.diag([-1.0, -1.0, 1.0, 1.0])
MASK = numpy.ones((5, 4, 3), bool)
ANSWER = (5 * 4 * 3, 60.0)


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        os.chmod(self.folder.name, 0o755)  # the tool is another user where the tests are root
        self.path = pathlib.Path(self.folder.name) / "segmentation.dcm"
        save(build(frames_of(MASK, PLAIN, 1), [segment(1, "s")], PLAIN), self.path)
        self.plain = subprocess.run(["dcmdrle", "-F", "-", "-"], input=self.path.read_bytes(), capture_output=True,
                                    check=True).stdout

    def tool(self, script):
        path = pathlib.Path(self.folder.name) / "tool"
        path.write_text(f"#!/usr/bin/python3 -IS\nimport os, sys\nGOOD = bytes.fromhex({self.plain.hex()!r})\n"
                        f"write = lambda data: os.write(1, data)\n{script}")
        path.chmod(0o755)
        return path

    def read(self, script):
        return Reading(self.path, self.tool(script))


class Quick(Case):
    def test_a_program_that_answers_well_is_believed(self):
        reading = self.read("assert len(sys.stdin.buffer.read()) > 1000\nwrite(GOOD)")
        self.assertEqual(ANSWER, reading.labels[1][:2])

    def test_what_a_filter_does_not_need_is_taken_from_it(self):
        reading = self.read(f"""
done = []
def attempt(what, *arguments):
    try:
        done.append((what.__name__, arguments, what(*arguments)))
    except (OSError, ImportError, ValueError):
        pass
import ctypes, resource, socket
attempt(os.fork)
attempt(os.posix_spawn, "/usr/bin/true", ["true"], {{}})
for family in (socket.AF_INET, socket.AF_INET6, socket.AF_UNIX, socket.AF_NETLINK):
    attempt(socket.socket, family)
attempt(socket.socketpair)
attempt(os.kill, {os.getpid()}, 0)
attempt(os.kill, os.getppid(), 0)
for path in ("/etc/passwd", "/proc/self/environ", "/proc/1/status", "/dev/zero", {str(self.path)!r}):
    attempt(open, path)
for path in ("/etc", "/tmp", "/"):
    attempt(os.listdir, path)
for path in ("/tmp/written", "/dev/shm/written", {self.folder.name + "/written"!r}):
    attempt(open, path, "w")
    attempt(os.mkdir, path)
    attempt(os.symlink, "/", path)
attempt(os.unlink, {str(self.path)!r})
attempt(os.setuid, 0)
attempt(resource.setrlimit, resource.RLIMIT_AS, (resource.RLIM_INFINITY,) * 2)
library = ctypes.CDLL(None, use_errno=True)
for call in (101, 310, 321, 323, 425, 165, 272, 155): # ptrace, process_vm_readv, bpf, userfaultfd, io_uring, mount, unshare, pivot_root
    if library.syscall(call, 0, 0, 0, 0, 0, 0) != -1 or ctypes.get_errno() != 38:
        done.append(call)
for descriptor in range(3, 64):
    attempt(os.fstat, descriptor)
if dict(os.environ).keys() - {{"LC_CTYPE"}}:
    done.append(dict(os.environ))
if os.getuid() == 0 or os.getcwd() != "/":
    done.append(os.getuid())
write(repr(done).encode() if done else GOOD)
""")
        self.assertEqual(ANSWER, reading.labels.get(1, (reading.refusal,))[:2])

    def test_memory_has_an_end(self):
        before = time.monotonic()
        reading = self.read("x = [bytearray(1 << 26) for _ in range(1000)]\nwrite(GOOD)")
        self.assertIn("needs more than 2 GiB of memory", reading.refusal)
        self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, 5 << 19)  # KiB
        self.assertLess(time.monotonic() - before, 50)

    def test_without_descriptors_it_is_refused_at_once(self):
        before = time.monotonic()
        for most in (6, 7):  # three, the file, its copy without a name and one end of the pipe, or both
            few = lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
            self.assertEqual(f"{self.folder.name}/tool could not be started: Too many open files",
                             Reading(self.path, self.tool("write(GOOD)"), preexec_fn=few).refusal)
        self.assertLess(time.monotonic() - before, 50)

    def test_garbage_is_refused(self):
        for script, sentence in (
                ("pass", "no pixel data"),
                ("write(os.urandom(100000))", "."),
                ("write(b'hello')", "breaks off"),
                ("write(GOOD[:-5])", "breaks off"),
                ("write(GOOD[:305])", "breaks off"),
                ("write(GOOD)\nsys.exit(1)", None),  # all was there
                ("write(GOOD[:305])\nsys.exit(1)", "could not decode"),
                ("write(GOOD[:305])\nimport signal\nsignal.alarm(1)", "breaks off"),
                ("write(b'\\x08\\0\\x16\\0UI\\xff\\xff')\nwrite(b'1' * 70000)", "has 65535 bytes, expected at most 4096"),
                ("write(b'\\x62\\0\\x02\\0SQ\\0\\0\\xff\\xff\\xff\\xff')", "(0062,0002) has no length"),
                ("write(b'\\x62\\0\\x02\\0SQ\\0\\0\\0\\0\\0\\x10')", "has more than 268435456 bytes before its pixel data"),
                ("write(b'\\xe0\\x7f\\x10\\0OW\\0\\0\\xff\\xff\\xff\\xff')", "its pixels are compressed"),
                ("write(b'\\x62\\0\\x02\\0SQ\\0\\0\\x08\\0\\0\\0' + b'\\xfe\\xff\\0\\xe0\\xff\\0\\0\\0' * 2)",
                 "longer than the sequence"),
                ("write(b'\\x62\\0\\x02\\0SQ\\0\\0\\x08\\0\\0\\0' + b'\\x62\\0\\x02\\0US\\x02\\0\\x02\\0')", "expected an item"),
                ("item = lambda depth: b'' if depth == 0 else (lambda inner: b'\\x62\\0\\x02\\0SQ\\0\\0' + "
                 "(len(inner) + 8).to_bytes(4, 'little') + b'\\xfe\\xff\\0\\xe0' + len(inner).to_bytes(4, 'little') + inner)"
                 "(item(depth - 1))\nwrite(item(40))", "nested more than 16 deep")):
            reading = self.read(script)
            with self.subTest(script=script):
                self.assertEqual(sentence is None, reading.refusal is None)
                if sentence:
                    self.assertRegex(reading.refusal, sentence.replace("(", "\\(").replace(")", "\\)"))

    def test_endless_heads_are_cut_off(self):
        for element in (b"\x08\0\x20\0UN\0\0\xff\xff\xff\x7f", b"\x08\0\x20\0DA\0\0", b"\x08\0\x16\0UI\x1c\0"
                        b"1.2.840.10008.5.1.4.1.1.66.4"):
            reading = self.read(f"data = {element!r} * 5000\nwhile True:\n    write(data)")
            self.assertRegex(reading.refusal, "has more than 268435456 bytes before its pixel data|took longer than 60 s")

    def test_a_program_that_is_missing_or_no_program(self):
        self.assertEqual("DICOM is decoded by /nowhere/dcmdrle, which is not there: install the Debian package dcmtk",
                         Reading(self.path, "/nowhere/dcmdrle").refusal)
        path = pathlib.Path(self.folder.name) / "tool"
        path.write_text("no program")
        path.chmod(0o755)
        self.assertIn("could not decode the DICOM file", Reading(self.path, path).refusal)


@unittest.skipUnless(SLOW, "these wait for a minute")
class Slow(Case):
    def test_time_has_an_end(self):
        for script in ("import time\ntime.sleep(1000)", "import os, time\nos.close(1)\ntime.sleep(1000)",
                       "while True: pass"):
            before = time.monotonic()
            self.assertRegex(self.read(script).refusal, "/tool took longer than 60 s to decode the DICOM file")
            self.assertLess(time.monotonic() - before, 90)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *(["Slow"] if SLOW else ["Quick"])])
