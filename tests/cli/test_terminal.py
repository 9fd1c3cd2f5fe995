"""What eskel shows where a person watches, and what it does not show elsewhere."""
import os
import pty
import re
import select
import subprocess
import threading
import time
import unittest
from http.server import BaseHTTPRequestHandler, HTTPServer

from support import ESKEL, Folder, Served, ball, eskel, hook, side_by_side, write_nifti


def on_terminal(*arguments, environment=None):
    """Runs eskel on a pseudo-terminal; its exit code and all that it wrote."""
    ours, theirs = pty.openpty()
    run = subprocess.Popen([ESKEL, *arguments], stdin=theirs, stdout=theirs, stderr=theirs,
                           env={**os.environ, "LC_ALL": "C.UTF-8", "TERM": "xterm", **(environment or {})})
    os.close(theirs)
    written, deadline = b"", time.monotonic() + 60
    while time.monotonic() < deadline:
        if not select.select([ours], [], [], 1)[0]:
            continue
        try:
            written += os.read(ours, 65536)
        except OSError:  # the other side is closed
            break
    os.close(ours)
    return run.wait(10), written.decode()


class SlowServer(BaseHTTPRequestHandler):
    """Takes a volume, thinks if it is called slow, and answers as eskeld would."""

    protocol_version = "HTTP/1.1"
    streams = 0

    def do_POST(self):
        self.rfile.read(int(self.headers["Content-Length"]))
        time.sleep(2.5 if "name=slow" in self.path else 0)
        body = b'{"shapes":[{"id":"1"}]}'
        self.send_response(201)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_GET(self):
        """A matrix, a row every moment; the events of a job; or the job."""
        if self.path.startswith("/jobs"):
            self.answer_job()
            return
        self.send_response(200)
        self.send_header("Eskel-Rows", "40")
        self.send_header("Connection", "close")
        self.end_headers()
        self.close_connection = True
        for row in ["id,name"] + 40 * ["row"]:
            self.wfile.write(f"{row}\r\n".encode())
            time.sleep(0.05)

    def answer_job(self):
        """Events in pieces of 7 bytes, in two streams: the first breaks off before the job ends."""
        jobs = [f'{{"id":"ab","state":"running","progress":{n / 20},"seconds":{n}}}' for n in range(20)]
        done = '{"id":"ab","state":"done","progress":1.0,"seconds":20}'
        self.send_response(200)
        self.send_header("Connection", "close")
        self.end_headers()
        self.close_connection = True
        if not self.path.endswith("/events"):
            self.wfile.write(done.encode())
            return
        SlowServer.streams += 1
        told = jobs[:10] if SlowServer.streams == 1 else jobs[10:] + [done]
        for job in told:
            event = f"event: progress\ndata: {job}\n\n".encode()
            for start in range(0, len(event), 7):
                self.wfile.write(event[start:start + 7])
            time.sleep(0.05)

    def log_message(self, *arguments):
        pass


class Progress(Folder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.volume = cls.path("ball.nii")
        write_nifti(cls.volume, side_by_side(ball(5)))
        server = HTTPServer(("127.0.0.1", 0), SlowServer)
        cls.url = f"http://127.0.0.1:{server.server_port}"
        threading.Thread(target=server.serve_forever, daemon=True).start()
        cls.addClassCleanup(server.server_close)
        cls.addClassCleanup(server.shutdown)

    def test_a_bar_shows_the_file_and_the_time_and_is_wiped_away(self):
        code, written = on_terminal("enroll", self.volume, self.volume, "--name", "slow", "--server", self.url)
        self.assertEqual(code, 0, written)
        drawn = re.findall(r"\r(\[[#.]{20}\] [^\x1b]*)\x1b\[K", written)
        self.assertTrue(any(re.search(r"1 of 2  ball.nii  computing \d s$", bar) for bar in drawn), drawn)
        self.assertTrue(any("] 2 of 2  ball.nii  " in bar for bar in drawn), drawn)
        self.assertEqual(written.count("\r\x1b[K"), 2)
        self.assertRegex(written[written.rindex("\r\x1b[K"):], r"\A\r\x1b\[K(\x1b\[1m)?id")

    def test_rows_are_counted_while_a_matrix_comes(self):
        path = self.path("matrix.csv")
        code, written = on_terminal("distances", "--format", "csv", "--output", path, "--server", self.url)
        self.assertEqual(code, 0, written)
        drawn = re.findall(r"\r\[#*\.*\] 1 of 1  distances  (\d+) of 40 rows, [\d.]+ a second, (\d+) s l[eft]*\x1b\[K", written)
        self.assertGreater(len(drawn), 3, written)
        self.assertEqual(sorted(int(rows) for rows, _ in drawn), [int(rows) for rows, _ in drawn])
        with open(path, "rb") as file:
            self.assertEqual(file.read().count(b"\n"), 41)

    def test_a_job_is_followed_over_streams_that_end(self):
        code, written = on_terminal("job", "ab", "--server", self.url)
        self.assertEqual((code, SlowServer.streams), (0, 2), written)
        drawn = re.findall(r"\r\[#*\.*\] 1 of 1  ab  ([\d.]+) %, \d+ s\x1b\[K", written)
        self.assertGreater(len(drawn), 5, written)
        self.assertEqual(sorted(map(float, drawn)), [float(share) for share in drawn])
        self.assertIn("done", written[written.rindex("\x1b[K"):])

    def test_quiet_shows_no_bar(self):
        code, written = on_terminal("enroll", self.volume, "--server", self.url, "--quiet")
        self.assertEqual(code, 0, written)
        self.assertNotIn("[K", written)

    def test_a_folder_shows_how_many_and_how_long(self):
        folder = self.path("many")
        os.mkdir(folder)
        for number in range(4):
            write_nifti(os.path.join(folder, f"{number}.nii"), side_by_side(ball(5)))
        code, written = on_terminal("enroll", folder, "--class", "x", "--parallel", "4", "--name", "slow", "--server", self.url)
        self.assertEqual(code, 0, written)
        drawn = re.findall(r"\r\[(#*)\.*\] (\d) of 4  files  [\d.]+ a second, (\d+) s left\x1b\[K", written)
        self.assertGreater(len(drawn), 3, written)
        self.assertEqual([len(bar) for bar, _, _ in drawn], [int(done) * 20 // 4 for _, done, _ in drawn])
        self.assertRegex(written[written.rindex("\r\x1b[K"):], r"\A\r\x1b\[Kfiles   4: ")
        self.assertEqual(eskel("enroll", folder, "--server", self.url).stderr, "")

    def test_without_a_terminal_there_is_a_line_a_file(self):
        run = eskel("enroll", self.volume, self.volume, "--server", self.url)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertRegex(run.stderr, rf"\A1 of 2: {self.volume}, \d\.\d s\n2 of 2: {self.volume}, \d\.\d s\n\Z")
        self.assertEqual(eskel("enroll", self.volume, "--server", self.url).stderr, "")

    def test_levels_are_counted_while_a_skeleton_is_computed(self):
        code, written = on_terminal("skeleton", self.volume, "--levels", "40")
        self.assertEqual(code, 0, written)
        self.assertRegex(written, r"\r\[[#.]{20}\] 1 of 1  ball.nii:1  level \d+ of 40\x1b\[K")


class Colour(Served):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.volume = cls.path("hook.nii")
        write_nifti(cls.volume, side_by_side(hook()))
        cls.rows(cls.eskel("enroll", cls.volume, "--class", "hook", "--side", "left", "--name", "hook"))
        cls.wrong = ("recognize", cls.volume, "--name", "hook right")

    def test_a_disagreement_is_red_on_a_terminal(self):
        code, written = on_terminal(*self.wrong, environment={"ESKEL_SERVER": self.url})
        self.assertEqual(code, 0, written)
        self.assertIn("\x1b[31mno\x1b[0m", written)

    def test_no_color_is_respected(self):
        code, written = on_terminal(*self.wrong, "--quiet", environment={"ESKEL_SERVER": self.url, "NO_COLOR": "1"})
        self.assertEqual(code, 0, written)
        self.assertNotIn("\x1b", written)

    def test_a_pipe_gets_no_colour(self):
        self.assertNotIn("\x1b", self.eskel(*self.wrong).stdout)


if __name__ == "__main__":
    unittest.main()
