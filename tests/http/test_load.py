"""Many clients at once: nothing is lost, nothing is mixed up, and a restart answers the same."""
import concurrent.futures
import os
import tempfile
import threading
import unittest

from daemon import Daemon, wait_until
from volumes import blob

CLIENTS = 100


def comparable(body):
    """A recognition without what may differ from time to time."""
    for result in body["results"]:
        del result["search"]["milliseconds"]
    return body


def at_once(work, items):
    """Runs work(item) for all items, all beginning at the same moment."""
    barrier = threading.Barrier(len(items))

    def begin(item):
        barrier.wait()
        return work(item)

    with concurrent.futures.ThreadPoolExecutor(len(items)) as pool:
        return list(pool.map(begin, items))


class Load(unittest.TestCase):
    def test_a_hundred_clients_at_once(self):
        with tempfile.TemporaryDirectory() as folder:
            database = os.path.join(folder, "shapes.eskel")
            volumes = [blob(seed, compressed=seed % 2 == 0) for seed in range(CLIENTS)]
            with Daemon(database=database) as daemon:
                enrolled = at_once(lambda n: daemon.request("POST", f"/shapes?name=n{n}", volumes[n]), range(CLIENTS))
                self.assertEqual({status for status, _, _ in enrolled}, {201})
                ids = [body["shapes"][0]["id"] for _, _, body in enrolled]
                self.assertEqual(len(set(ids)), CLIENTS)
                for number, (_, _, body) in enumerate(enrolled):
                    self.assertEqual(body["shapes"][0]["name"], f"n{number}")
                before = at_once(lambda n: self.recognize(daemon, n, volumes, ids), range(CLIENTS))
            with Daemon(database=database) as daemon:
                self.assertEqual(daemon.metric("eskeld_shapes"), CLIENTS)
                self.assertEqual(at_once(lambda n: self.recognize(daemon, n, volumes, ids), range(CLIENTS)), before)

    def recognize(self, daemon, number, volumes, ids):
        """Two thirds by volume, which finds itself, a third by id, which does not."""
        if number % 3:
            status, _, body = daemon.request("POST", "/recognize?mode=exact", volumes[number])
            self.assertEqual(body["results"][0]["neighbours"][0]["id"], ids[number])
        else:
            status, _, body = daemon.get(f"/recognize?mode=exact&shape={ids[number]}")
            self.assertNotEqual(body["results"][0]["neighbours"][0]["id"], ids[number])
        self.assertEqual(status, 200)
        return comparable(body)

    def test_the_same_volume_from_many_clients_is_one_shape(self):
        volume = blob(7)
        with Daemon() as daemon:
            answers = at_once(lambda _: daemon.request("POST", "/shapes", volume), range(30))
            self.assertEqual(sorted(status for status, _, _ in answers), [200] * 29 + [201])
            self.assertEqual(len({body["shapes"][0]["id"] for _, _, body in answers}), 1)
            self.assertEqual(daemon.metric("eskeld_shapes"), 1)

    def test_reading_writing_and_deleting_at_once_leaves_what_was_left(self):
        with Daemon() as daemon:
            keep = [daemon.request("POST", "/shapes", blob(seed))[1]["location"] for seed in range(5)]

            def work(number):
                if number % 2:
                    self.assertEqual(daemon.get(f"/recognize?shape={keep[number % 5].rsplit('/', 1)[1]}")[0], 200)
                else:
                    made = daemon.request("POST", "/shapes", blob(100 + number))
                    self.assertEqual(made[0], 201)
                    self.assertEqual(daemon.request("DELETE", made[1]["location"])[0], 204)

            at_once(work, range(40))
            self.assertEqual({shape["url"] for shape in daemon.get("/shapes")[2]["shapes"]}, set(keep))
            self.assertEqual(daemon.metric("eskeld_shapes"), 5)

    def test_metrics_count_every_request(self):
        with Daemon() as daemon:
            at_once(lambda n: [daemon.get("/healthz") for _ in range(5)], range(20))
            wait_until(lambda: daemon.metric("eskeld_http_requests_total") >= 100, "the last reply is counted")
            text = daemon.get("/metrics")[2].decode()
            self.assertIn('eskeld_http_requests_total{route="/healthz",method="GET",status="2xx"} 100\n', text)
            self.assertIn('eskeld_http_request_duration_seconds_count{route="/healthz"} 100\n', text)
            self.assertIn('eskeld_http_request_duration_seconds_bucket{route="/healthz",le="+Inf"} 100\n', text)


if __name__ == "__main__":
    unittest.main()
