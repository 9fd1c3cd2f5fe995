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


class Jobs(Files):
    """Three shapes, each named so often that their matrix takes seconds."""

    def enroll(self, daemon):
        self.ids = [daemon.request("POST", "/shapes", blob(seed))[2]["shapes"][0]["id"] for seed in range(3)]

    def path(self, count):
        ids = ",".join(self.ids[n % 3] for n in range(count))
        return f"/distances?format=npy&id={ids}&columns.id={ids}"

    def begin(self, daemon, count):
        status, headers, job = daemon.request("POST", self.path(count))
        self.assertEqual((status, headers["location"]), (202, job["url"]))
        return job["url"]

    def wait_for(self, daemon, url, state):
        wait_until(lambda: daemon.get(url)[2]["state"] == state, f"the job is {state}", seconds=120)

    def assert_result(self, daemon, url, count):
        self.wait_for(daemon, url, "done")
        self.assertEqual(daemon.get(url + "/result")[2], daemon.get(self.path(count))[2])

    def results(self):
        return sorted(os.listdir(self.database + "-jobs"))

    def test_what_was_accepted_is_done_after_kill_9(self):
        with Daemon(database=self.database) as daemon:
            self.enroll(daemon)
            done, running, queued = self.begin(daemon, 5), self.begin(daemon, 600), self.begin(daemon, 7)
            self.wait_for(daemon, running, "running")
            wait_until(lambda: daemon.get(running)[2]["size"] > 1000, "a part of the result is written")
            daemon.kill()
        self.assertEqual(len(self.results()), 2, "one whole and a part")
        with Daemon(database=self.database) as daemon:
            self.assertEqual([job["url"] for job in daemon.get("/jobs")[2]["jobs"]], [done, running, queued])
            self.assertEqual(daemon.get(done)[2]["state"], "done")
            for url, count in ((done, 5), (queued, 7), (running, 600)):
                self.assert_result(daemon, url, count)
            self.assertEqual(self.results(), sorted(url.rpartition("/")[2] for url in (done, running, queued)))
            for url in (done, running, queued):
                self.assertEqual(daemon.request("DELETE", url)[0], 204)
            self.assertEqual(self.results(), [])

    def test_a_job_that_was_killed_three_times_is_given_up_and_an_orderly_stop_does_not_count(self):
        with Daemon(database=self.database) as daemon:
            self.enroll(daemon)
            url = self.begin(daemon, 800)
        for end in (Daemon.stop, Daemon.kill, Daemon.stop, Daemon.kill, Daemon.kill):
            with Daemon(database=self.database) as daemon:
                wait_until(lambda: daemon.get(url)[2]["size"] > 0, "it has begun, and that is stored")
                end(daemon)
        with Daemon(database=self.database) as daemon:
            self.assertEqual(daemon.get(url)[2]["state"], "failed")
            self.assertIn("the server ended 3 times while it ran", daemon.get(url)[2]["problem"])

    def test_who_may_read_may_have_jobs_and_a_restart_needs_nobodys_token(self):
        with Daemon(database=self.database) as daemon:
            self.enroll(daemon)
            token, other = daemon.token("read"), daemon.token("read")
            status, _, job = daemon.request("POST", self.path(600), token=token)
            self.assertEqual(status, 202)
            self.assertEqual(daemon.request("POST", self.path(3))[0], 401)
            self.assertEqual(daemon.administer("token", "revoke", "1")[0], 0)
            daemon.kill()
        with Daemon(database=self.database) as daemon:
            wait_until(lambda: daemon.get(job["url"], token=other)[2]["state"] == "done", "it is done", seconds=120)
            self.assertEqual(daemon.get(job["url"] + "/result", token=token)[0], 401)
            self.assertEqual(daemon.get(job["url"] + "/result", token=other)[0], 200)


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
            _, _, job = daemon.request("POST", "/distances")
            wait_until(lambda: daemon.get(job["url"])[2]["state"] == "failed", "a job's result has no room")
            self.assertEqual(daemon.get(job["url"] + "/result")[0], 507)
            os.remove(filler)
            self.assertEqual(daemon.request("POST", "/shapes", blob(2))[0], 201)


if __name__ == "__main__":
    unittest.main()
