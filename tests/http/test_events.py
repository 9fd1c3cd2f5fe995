"""Server-sent events of jobs: what is told, to how many, and what becomes of the streams."""
import contextlib
import json
import re
import signal
import time
import unittest

from daemon import HOST, Daemon, receive, split_replies, wait_until
from volumes import blob

MOST = 64  # streams


class Events(unittest.TestCase):
    def setUp(self):
        stack = contextlib.ExitStack()
        self.addCleanup(stack.close)
        self.daemon = stack.enter_context(Daemon("--workers", "1"))
        self.ids = [self.daemon.request("POST", "/shapes", blob(seed))[2]["shapes"][0]["id"] for seed in range(3)]

    def begin(self, count):
        """A job that takes about a second for 1000."""
        ids = ",".join(self.ids[n % 3] for n in range(count))
        return self.daemon.request("POST", f"/distances?format=npy&id={ids}&columns.id={ids}")[2]["url"]

    def watch(self, url, *fields):
        connection = self.daemon.socket(60)
        head = b"GET " + url.encode() + b"/events HTTP/1.1\r\n" + HOST + b"".join(f + b"\r\n" for f in fields) + b"\r\n"
        connection.sendall(head)
        return connection

    def read_until(self, connection, end=b"0\r\n\r\n"):
        """All that comes until these bytes, by default until the stream's orderly end."""
        data = b""
        while end not in data:
            piece = connection.recv(1 << 16)
            self.assertTrue(piece, f"closed after {data!r}")
            data += piece
        return data

    def parse(self, data):
        """(event, data, id) of each event of a chunked reply."""
        head, _, body = data.partition(b"\r\n\r\n")
        self.assertIn(b"Content-Type: text/event-stream\r\n", head)
        text = b"".join(re.findall(rb"(?s)[0-9A-F]+\r\n(.*?)\r\n", body)).decode()
        events = []
        for block in text.split("\n\n"):
            fields = dict(line.split(": ", 1) for line in block.splitlines() if not line.startswith(":"))
            if fields:
                events.append((fields["event"], json.loads(fields["data"]), fields.get("id")))
        return events

    def end_all(self, urls):
        for url in urls:
            self.assertEqual(self.daemon.request("DELETE", url)[0], 204)

    def test_a_job_is_told_from_its_state_to_its_end_and_the_connection_stays(self):
        url = self.begin(1200)
        with contextlib.closing(self.watch(url)) as connection:
            events = self.parse(self.read_until(connection))
            connection.sendall(b"GET /healthz HTTP/1.1\r\n" + HOST + b"\r\n")
            self.assertEqual(split_replies(receive(connection, 1)[0]), [200])
        names = [event for event, _, _ in events]
        self.assertEqual((names[0], names[-1]), ("state", "state"))
        self.assertIn("progress", names)
        states = [job["state"] for event, job, _ in events if event == "state"]
        self.assertEqual(states, sorted(states, key=["queued", "running", "done"].index))
        progress = [job["progress"] for _, job, _ in events]
        self.assertEqual(progress, sorted(progress))
        self.assertEqual([name for _, _, name in events], [None] * (len(events) - 1) + ["end"])
        self.assertEqual(events[-1][1], self.daemon.get(url)[2])

    def test_who_has_seen_the_end_need_not_come_back_and_other_ids_change_nothing(self):
        url = self.begin(3)
        wait_until(lambda: self.daemon.get(url)[2]["state"] == "done", "it is done")
        self.assertEqual(self.daemon.get(url + "/events", headers={"Last-Event-ID": "end"})[0], 204)
        for field in (b"Last-Event-ID: 17", b"Last-Event-ID: \xff" + b"x" * 4000):
            with contextlib.closing(self.watch(url, field)) as connection:
                events = self.parse(self.read_until(connection))
            self.assertEqual([(event, job["state"], name) for event, job, name in events], [("state", "done", "end")])

    def test_a_deleted_job_is_gone_and_an_unknown_one_404(self):
        url = self.begin(1800)
        with contextlib.closing(self.watch(url)) as connection:
            self.read_until(connection, b"\n\n")
            self.end_all([url])
            self.assertIn(b"event: gone\n", self.read_until(connection))
        self.assertEqual(self.daemon.get(url + "/events")[0], 404)

    def test_a_quiet_stream_is_kept_alive(self):
        """Longer than the 15 s after which libmicrohttpd takes a connection for idle."""
        urls = [self.begin(1800) for _ in range(14)]
        with contextlib.closing(self.watch(urls[-1])) as connection:
            self.read_until(connection, b'"state":"queued"')
            for _ in range(4):
                started = time.monotonic()
                if b"event" in self.read_until(connection, b"\n\n"):
                    self.skipTest("this machine does it all in a few seconds")
                self.assertLess(time.monotonic() - started, 8)
            self.end_all(urls)
            self.assertIn(b"event: gone\n", self.read_until(connection))

    def test_streams_take_no_worker_and_there_are_only_so_many(self):
        urls = [self.begin(1800) for _ in range(10)]
        with contextlib.ExitStack() as stack:
            connections = [stack.enter_context(contextlib.closing(self.watch(urls[-1]))) for _ in range(MOST)]
            for connection in connections:
                self.read_until(connection, b"event: state\n")
            self.assertEqual(self.daemon.metric("eskeld_queue_places_taken"), 0)
            self.assertEqual(self.daemon.get(f"/recognize?shape={self.ids[0]}")[0], 200, "the one worker is free")
            status, headers, body = self.daemon.get(urls[-1] + "/events")
            self.assertEqual((status, headers["retry-after"]), (503, "1"))
            self.assertIn("64 streams of events are open", body["detail"])
            connections[0].close()
            wait_until(lambda: self.daemon.request("HEAD", urls[-1] + "/events")[0] == 200, "a lost one is missed", 40)
            self.end_all(urls)
            for connection in connections[1:]:
                self.read_until(connection)
        self.assertEqual(self.daemon.request("HEAD", "/healthz")[0], 200)

    def test_a_stop_ends_the_streams_and_waits_for_none(self):
        urls = [self.begin(1800) for _ in range(10)]
        with contextlib.closing(self.watch(urls[-1])) as connection:
            self.read_until(connection, b"event: state\n")
            self.daemon.process.send_signal(signal.SIGTERM)
            started = time.monotonic()
            self.read_until(connection)
            self.assertLess(time.monotonic() - started, 5)
        self.assertEqual(self.daemon.process.wait(30), 0)
        self.assertIn("all requests were answered", self.daemon.log_text())


if __name__ == "__main__":
    unittest.main()
