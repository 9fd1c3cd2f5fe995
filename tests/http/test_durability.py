"""Stopping, killing and running out of disk: what was acknowledged is there, what was not is not half there."""
import os
import signal
import subprocess
import tempfile
import threading
import time
import unittest

from daemon import HOST, Daemon, administer, receive, split_replies, wait_until
from volumes import blob


NEXT = b"GET /healthz HTTP/1.1\r\n" + HOST + b"\r\n"


class Files(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())
        self.database = os.path.join(self.folder, "shapes.eskel")

    def contents(self, daemon):
        return {path: daemon.get(path)[2]
                for shape in daemon.get("/shapes?limit=1000")[2]["shapes"]
                for path in (shape["url"], shape["url"] + "/skeleton", shape["url"] + "/signature")}


class Stop(Files):
    def begin_upload(self, daemon, volume):
        connection = daemon.socket(60)
        connection.sendall(b"POST /shapes HTTP/1.1\r\n" + HOST + b"Content-Length: %d\r\n\r\n" % len(volume) + volume[:500])
        wait_until(lambda: daemon.metric("eskeld_queue_places_taken") == 1, "the upload has begun")
        return connection

    def test_what_is_under_way_at_sigterm_is_finished(self):
        volume = blob(1)
        for number in (signal.SIGTERM, signal.SIGINT):
            with Daemon(database=self.database) as daemon, self.begin_upload(daemon, volume) as upload, daemon.socket() as other:
                other.sendall(NEXT)
                receive(other, 1)
                daemon.process.send_signal(number)
                wait_until(lambda: "event=draining" in daemon.log_text(), "it drains")
                self.assertRaises(ConnectionRefusedError, daemon.socket)
                other.sendall(NEXT)
                received, closed = receive(other)
                self.assertEqual((split_replies(received), closed), ([503], True), "what comes later is refused")
                upload.sendall(volume[500:])
                received, closed = receive(upload)
                self.assertIn(split_replies(received), ([201], [200]))
                self.assertTrue(closed)
                self.assertEqual(daemon.process.wait(30), 0)
                self.assertIn("all requests were answered", daemon.log_text())
        with Daemon(database=self.database) as daemon:
            self.assertEqual(len(daemon.get("/shapes")[2]["shapes"]), 1)

    def test_draining_is_bounded_by_its_time(self):
        with Daemon("--drain", "1", database=self.database) as daemon, self.begin_upload(daemon, blob(1)):
            started = time.monotonic()
            self.assertEqual(daemon.stop(), 0)
            self.assertTrue(0.9 < time.monotonic() - started < 8)
            self.assertIn("1 requests were abandoned", daemon.log_text())

    def test_a_second_signal_ends_draining(self):
        with Daemon(database=self.database) as daemon, self.begin_upload(daemon, blob(1)):
            daemon.process.send_signal(signal.SIGTERM)
            wait_until(lambda: "event=draining" in daemon.log_text(), "it drains")
            self.assertEqual(daemon.stop(patience=8), 0)

    def test_an_idle_connection_does_not_hold_it_up(self):
        with Daemon(database=self.database) as daemon, daemon.socket() as idle:
            idle.sendall(NEXT)
            receive(idle, 1)
            self.assertEqual(daemon.stop(patience=8), 0)

    def test_a_second_server_on_the_same_database_is_refused(self):
        with Daemon(database=self.database):
            status, _, err = administer("--listen", "127.0.0.1:0", database=self.database)
            self.assertEqual(status, 1)
            self.assertIn("another server", err)

    def test_an_address_in_use_is_said(self):
        with Daemon(database=self.database) as daemon:
            other = os.path.join(self.folder, "other.eskel")
            status, _, err = administer("--listen", f"127.0.0.1:{daemon.port}", database=other)
            self.assertEqual(status, 1)
            self.assertIn("in use", err)
            self.assertFalse(os.path.exists(other), "nothing was made")

    def test_a_foreign_file_is_refused_and_left_alone(self):
        with open(self.database, "wb") as file:
            file.write(b"not a database, but somebody's work\n" * 100)
        status, _, err = administer("--listen", "127.0.0.1:0", database=self.database)
        self.assertEqual(status, 1)
        self.assertIn("database", err)
        with open(self.database, "rb") as file:
            self.assertEqual(file.read(), b"not a database, but somebody's work\n" * 100)


class Restart(Files):
    def test_a_restart_keeps_everything(self):
        with Daemon(database=self.database) as daemon:
            for seed in range(8):
                self.assertEqual(daemon.request("POST", f"/shapes?name=n{seed}&attr.k=v", blob(seed))[0], 201)
            shapes = daemon.get("/shapes")[2]["shapes"]
            self.assertEqual(daemon.request("DELETE", shapes[0]["url"])[0], 204)
            self.assertEqual(daemon.request("PATCH", shapes[1]["url"], b'{"side":"left"}',
                                            {"Content-Type": "application/merge-patch+json"})[0], 200)
            before = self.contents(daemon)
        with Daemon(database=self.database) as daemon:
            self.assertEqual(self.contents(daemon), before)
            self.assertEqual(len(before), 7 * 3)
            self.assertEqual(daemon.metric("eskeld_shapes"), 7)
        status, out, _ = administer("audit", "verify", database=self.database)
        self.assertEqual((status, out.split()[0]), (0, "10"))

    def test_what_was_acknowledged_survives_kill_9(self):
        acknowledged = {}
        for round_number in range(5):
            with Daemon(database=self.database) as daemon:
                self.assertEqual({url: daemon.get(url)[2]["sha256"] for url in acknowledged}, acknowledged)
                self.assertLessEqual(daemon.metric("eskeld_shapes"), len(acknowledged) + 8, "at most those cut off came")
                threads = [threading.Thread(target=self.enroll_until_killed, args=(daemon, round_number, thread, acknowledged))
                           for thread in range(4)]
                for thread in threads:
                    thread.start()
                wanted = len(acknowledged) + 6
                wait_until(lambda: len(acknowledged) >= wanted, "some are enrolled")
                daemon.kill()
                for thread in threads:
                    thread.join()
        with Daemon(database=self.database) as daemon:
            self.assertEqual({url: daemon.get(url)[2]["sha256"] for url in acknowledged}, acknowledged)
            for url in acknowledged:
                self.assertEqual(daemon.get(url + "/skeleton")[0], 200)
        self.assertEqual(administer("audit", "verify", database=self.database)[0], 0)

    def enroll_until_killed(self, daemon, round_number, thread, acknowledged):
        for number in range(1000):
            try:
                status, _, body = daemon.request("POST", "/shapes", blob(f"{round_number} {thread} {number}"))
            except OSError:
                return
            except Exception as error:  # http.client: a reply that was cut off
                if daemon.process.poll() is None:
                    raise error
                return
            if status == 201:
                acknowledged[body["shapes"][0]["url"]] = body["shapes"][0]["sha256"]


class DiskFull(Files):
    """On a tmpfs of 80 MB, of which the store keeps 64 MB free. Needs the right to mount."""

    def setUp(self):
        super().setUp()
        made = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=80m", "tmpfs", self.folder], capture_output=True)
        if made.returncode != 0:
            self.skipTest("a tmpfs cannot be mounted here")
        self.addCleanup(subprocess.run, ["umount", "-l", self.folder], check=True)

    def test_a_full_disk_is_507_until_there_is_room(self):
        with Daemon(database=self.database) as daemon:
            stored = daemon.request("POST", "/shapes", blob(1))
            self.assertEqual(stored[0], 201)
            filler = os.path.join(self.folder, "filler")
            with open(filler, "wb") as file:
                file.write(bytes(40 << 20))
            status, _, body = daemon.request("POST", "/shapes", blob(2))
            self.assertEqual(status, 507)
            self.assertIn("bytes free", body["detail"])
            self.assertEqual(daemon.request("POST", "/recognize", blob(2))[0], 200, "reading goes on")
            self.assertEqual(daemon.request("DELETE", stored[1]["location"])[0], 204, "and deleting")
            os.remove(filler)
            self.assertEqual(daemon.request("POST", "/shapes", blob(2))[0], 201)


if __name__ == "__main__":
    unittest.main()
