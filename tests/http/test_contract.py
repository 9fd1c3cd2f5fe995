"""/openapi.json is true: what it documents is there, what it does not is not."""
import unittest

from daemon import Daemon, wait_until
from volumes import blob

METHODS = {"GET", "POST", "PUT", "PATCH", "DELETE"}


class Contract(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = cls.enterClassContext(Daemon())
        cls.paths = cls.daemon.get("/openapi.json")[2]["paths"]

    def requests(self):
        """Each path with an id that there is, and the methods that are documented for it."""
        for template, item in self.paths.items():
            if template.startswith("/jobs"):
                identity = self.daemon.request("POST", "/distances")[2]["id"]
            else:
                fitted = template.endswith("/reconstruction")
                path, body = ("/shapes?levels=2", blob(2)) if fitted else ("/shapes", blob(1))
                identity = self.daemon.request("POST", path, body)[2]["shapes"][0]["id"]
            if template.endswith("/reconstruction"):
                job = self.daemon.request("POST", template.replace("{id}", identity))[2]["url"]
                wait_until(lambda: self.daemon.get(job)[2]["state"] == "done", "a surface is fitted")
            yield template.replace("{id}", identity), METHODS & {name.upper() for name in item}

    def test_there_is_a_contract(self):
        self.assertGreaterEqual(len(self.paths), 9)

    def test_documented_methods_are_served(self):
        for path, methods in self.requests():
            for method in sorted(methods, key="GET PATCH POST PUT DELETE".index):
                status, headers, _ = self.daemon.request(method, path)
                self.assertNotIn(status, (404, 405, 500, 501), (method, path))
                if status >= 400:
                    self.assertEqual(headers["content-type"], "application/problem+json", (method, path))

    def test_undocumented_methods_are_405_and_name_the_documented_ones(self):
        for path, methods in self.requests():
            for method in METHODS - methods:
                status, headers, _ = self.daemon.request(method, path)
                self.assertEqual(status, 405, (method, path))
                allowed = set(headers["allow"].split(", "))
                self.assertEqual(allowed - {"HEAD", "OPTIONS"}, methods, (method, path))

    def test_options_name_the_documented_methods(self):
        for path, methods in self.requests():
            status, headers, _ = self.daemon.request("OPTIONS", path)
            self.assertEqual(status, 204, path)
            self.assertEqual(set(headers["allow"].split(", ")) - {"HEAD", "OPTIONS"}, methods, path)

    def test_other_paths_are_404(self):
        for path in ("/shape", "/shapes/x/y", "/recognise", "/openapi.yaml", "/favicon.ico"):
            self.assertEqual(self.daemon.get(path)[0], 404, path)


if __name__ == "__main__":
    unittest.main()
