"""Bounded queues, slow clients, many clients: what is refused, and that the others do not notice."""
import contextlib
import socket
import threading
import time
import unittest

from daemon import HOST, Daemon, receive, split_replies, wait_until
from volumes import blob, nifti


def begin_upload(daemon, size, path=b"/shapes", sent=b""):
    """An upload that announces size bytes and has sent some: it holds a place in the queue."""
    connection = daemon.socket(60)
    connection.sendall(b"POST " + path + b" HTTP/1.1\r\n" + HOST + b"Content-Length: %d\r\n\r\n" % size + sent)
    return connection


class Queue(unittest.TestCase):
    def test_a_full_queue_is_503_before_the_body(self):
        volume = blob(1)
        with Daemon("--queue", "1") as daemon, begin_upload(daemon, len(volume)) as upload:
            wait_until(lambda: daemon.metric("eskeld_queue_places_taken") == 1, "the upload has the place")
            for _ in range(3):
                status, headers, body = daemon.request("POST", "/recognize", blob(2))
                self.assertEqual((status, headers["retry-after"]), (503, "1"))
                self.assertIn("queue", body["detail"])
            self.assertEqual(daemon.get("/shapes")[0], 200, "what does not compute is served")
            upload.sendall(volume)
            self.assertEqual(split_replies(receive(upload, 1)[0]), [201], "what was accepted is finished")
            self.assertEqual(daemon.request("POST", "/recognize", blob(2))[0], 200)
            self.assertEqual(daemon.metric("eskeld_queue_places_taken"), 0)

    def test_a_lost_or_refused_upload_gives_its_place_back(self):
        with Daemon("--queue", "1") as daemon:
            for sent in (b"", blob(1)[:1000]):
                with begin_upload(daemon, 100000, sent=sent):
                    wait_until(lambda: daemon.metric("eskeld_queue_places_taken") == 1, "the upload has the place")
                wait_until(lambda: daemon.metric("eskeld_queue_places_taken") == 0, "the place of a lost upload is free")
            with begin_upload(daemon, 100000) as upload:
                wait_until(lambda: daemon.metric("eskeld_queue_places_taken") == 1, "the upload has the place")
                upload.sendall(b"not a volume" * 1000)
                wait_until(lambda: daemon.metric("eskeld_queue_places_taken") == 0, "that of a refused one is free")
            self.assertEqual(daemon.request("POST", "/shapes", blob(1))[0], 201)


class Slow(unittest.TestCase):
    """All drips at once, so that the test takes no longer than the longest of them."""

    def drip(self, daemon, name, first, piece, interval):
        with daemon.socket() as connection:
            started = time.monotonic()
            connection.sendall(first)
            connection.settimeout(interval)
            with contextlib.suppress(ConnectionError):
                while time.monotonic() - started < 60:
                    connection.sendall(piece)
                    with contextlib.suppress(TimeoutError):
                        if not connection.recv(1 << 16):
                            break
            self.lasted[name] = time.monotonic() - started

    def test_clients_that_drip_are_cut_off(self):
        post = b"POST /shapes HTTP/1.1\r\n" + HOST
        header = nifti((400, 200, 100), b"")
        clients = {
            "nothing": (b"", b"", 1),
            "head": (b"GET / HTTP/1.1\r\n", b"X: y\r\n", 1),
            "body": (post + b"Content-Length: 8000000\r\n\r\n" + header, b"\0", 1),
            "chunks": (post + b"Transfer-Encoding: chunked\r\n\r\n", b"1\r\n\0\r\n", 1),
            "refused": (post + b"Content-Length: 8000000\r\n\r\nnot a volume", b"x", 1),
            "next head": (b"GET /healthz HTTP/1.1\r\n" + HOST + b"\r\n", b"G", 1),
            "steady": (post + b"Content-Length: 8000352\r\n\r\n" + header, bytes(250000), 0.5),
        }
        with Daemon() as daemon:
            self.lasted = {}
            threads = [threading.Thread(target=self.drip, args=(daemon, name, *how)) for name, how in clients.items()]
            for thread in threads:
                thread.start()
            wait_until(lambda: daemon.metric("eskeld_connections") >= len(clients), "all are connected")
            self.assertEqual(daemon.get("/healthz")[0], 200)
            for thread in threads:
                thread.join()
            self.assertEqual(daemon.metric("eskeld_queue_places_taken"), 0)
        for name in ("nothing", "head", "body", "chunks", "refused"):
            self.assertTrue(9 < self.lasted[name] < 14, self.lasted)
        self.assertTrue(20 < self.lasted["next head"] < 30, self.lasted)
        self.assertGreater(self.lasted["steady"], 14, "a slow but steady upload is left alone")

    def test_five_hundred_dripping_connections_do_not_delay_the_others(self):
        with Daemon() as daemon, contextlib.ExitStack() as stack:
            drips = [stack.enter_context(socket.create_connection(("127.0.0.1", daemon.port))) for _ in range(500)]
            for number, drip in enumerate(drips):
                drip.sendall(b"GET /" if number % 2 else b"POST /shapes HTTP/1.1\r\n" + HOST + b"Content-Length: 9")
            wait_until(lambda: daemon.metric("eskeld_connections") >= 500, "all are connected")
            took = []
            for number in range(200):
                drips[number].sendall(b"x")
                started = time.monotonic()
                self.assertEqual(daemon.get("/shapes")[0], 200)
                took.append(time.monotonic() - started)
            took.sort()
            print(f"\nbeside 500 dripping connections: median {took[100] * 1e3:.1f} ms, worst {took[-1] * 1e3:.1f} ms")
            wait_until(lambda: daemon.metric("eskeld_rejected_total") == 500, "the drips are cut off", 20)
            wait_until(lambda: daemon.metric("eskeld_connections") < 10, "they are gone")

    def test_past_the_connection_limit_others_wait_until_drips_are_cut_off(self):
        with Daemon("--connections", "16") as daemon, contextlib.ExitStack() as stack:
            for _ in range(20):
                stack.enter_context(socket.create_connection(("127.0.0.1", daemon.port))).sendall(b"GET")
            self.assertEqual(daemon.get("/healthz")[0], 200)


if __name__ == "__main__":
    unittest.main()
