"""Matrices that are sent while they are computed: whole, beside others, and only as long as somebody wants them."""
import contextlib
import csv
import io
import struct
import time
import unittest

from daemon import HOST, Daemon, receive, wait_until
from volumes import blob

MANY = 700  # a side: half a million distances, some seconds of a processor


class Streaming(unittest.TestCase):
    def setUp(self):
        stack = contextlib.ExitStack()
        self.addCleanup(stack.close)
        self.daemon = stack.enter_context(Daemon("--workers", "1"))
        self.ids = [self.daemon.request("POST", "/shapes", blob(seed))[2]["shapes"][0]["id"] for seed in range(3)]

    def path(self, count, **more):
        """Ids may be repeated: three shapes are a large matrix. Given as columns, too, no pair is kept."""
        ids = ",".join(self.ids[n % 3] for n in range(count))
        return f"/distances?id={ids}&columns.id={ids}" + "".join(f"&{name}={value}" for name, value in more.items())

    def begin(self, path, version=b"1.1"):
        connection = self.daemon.socket(60)
        connection.sendall(b"GET " + path.encode() + b" HTTP/" + version + b"\r\n" + HOST + b"\r\n")
        return connection

    def places(self):
        return self.daemon.metric("eskeld_queue_places_taken")

    def check_npy(self, body, count):
        self.assertEqual(len(body), 128 + 8 * count * count)
        cells = struct.unpack(f"<{count * count}d", body[128:])
        few = self.daemon.get(self.path(3))[2]["distances"]
        for i in range(count):
            for j in range(0, count, 7):
                self.assertAlmostEqual(cells[i * count + j], few[i % 3][j % 3], delta=1e-12)

    def test_a_streamed_matrix_is_whole_and_the_connection_stays(self):
        count = 200
        with contextlib.closing(self.daemon.connect()) as connection:
            for _ in range(2):
                connection.request("GET", self.path(count, format="npy"))
                response = connection.getresponse()
                self.assertEqual(response.headers["Content-Length"], str(128 + 8 * count * count))
                self.assertEqual((response.headers["Eskel-Rows"], response.headers["Eskel-Columns"]), ("200", "200"))
                self.check_npy(response.read(), count)
                connection.request("GET", self.path(count, format="csv"))
                response = connection.getresponse()
                self.assertEqual(response.headers["Transfer-Encoding"], "chunked")
                rows = list(csv.reader(io.StringIO(response.read().decode())))
                self.assertEqual({len(row) for row in rows}, {count + 2})
                self.assertEqual(len(rows), count + 1)
        wait_until(lambda: self.places() == 0, "the streams have given their places back")
        self.assertIn(f" bytes={128 + 8 * count * count} ", self.daemon.log_text())

    def test_an_old_client_reads_to_the_end(self):
        with contextlib.closing(self.begin(self.path(200, format="npy"), b"1.0")) as connection:
            data, closed = receive(connection)
        self.assertTrue(closed)
        self.check_npy(data.partition(b"\r\n\r\n")[2], 200)

    def test_the_head_alone_computes_nothing(self):
        started = time.monotonic()
        status, headers, body = self.daemon.request("HEAD", self.path(MANY))
        self.assertEqual((status, headers["eskel-rows"], body), (200, str(MANY), b""))
        self.assertLess(time.monotonic() - started, 30)
        wait_until(lambda: self.places() == 0, "its place is free")

    def test_others_are_served_while_a_stream_goes_on(self):
        with contextlib.closing(self.begin(self.path(MANY))) as connection:
            connection.recv(1 << 16)
            for shape in self.ids:
                self.assertEqual(self.daemon.get(f"/recognize?shape={shape}")[0], 200)
            self.assertEqual(self.places(), 1, "the stream is still there")

    def test_a_client_that_goes_away_frees_the_worker(self):
        for read in (0, 1 << 12, 1 << 20):
            with contextlib.closing(self.begin(self.path(MANY))) as connection:
                while read > 0:
                    read -= len(connection.recv(1 << 16))
                wait_until(lambda: self.places() == 1, "the stream has its place")
            wait_until(lambda: self.places() == 0, "the place of a lost stream is free")
        self.assertIn("end=", self.daemon.log_text())


if __name__ == "__main__":
    unittest.main()
