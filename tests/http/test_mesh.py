"""Meshes over HTTP: caching, parts, and what the disk keeps."""
import contextlib
import os
import tempfile
import unittest

from daemon import Daemon
from volumes import blob


class Mesh(unittest.TestCase):
    def setUp(self):
        stack = contextlib.ExitStack()
        self.addCleanup(stack.close)
        self.folder = stack.enter_context(tempfile.TemporaryDirectory())
        self.database = os.path.join(self.folder, "shapes.eskel")

    def files(self):
        folder = self.database + "-meshes"
        return [os.path.join(folder, name) for name in sorted(os.listdir(folder))]

    def test_a_mesh_outlives_a_restart_and_damage_is_made_good(self):
        with Daemon(database=self.database) as daemon:
            url = daemon.request("POST", "/shapes", blob(1))[2]["shapes"][0]["url"] + "/mesh?step=0.7"
            status, headers, mesh = daemon.get(url)
            self.assertEqual((status, headers["content-type"]), (200, "model/gltf-binary"))
            self.assertEqual(headers["content-length"], str(len(mesh)))
            self.assertEqual(headers["accept-ranges"], "bytes")
            self.assertEqual(headers["cache-control"], "private, max-age=31536000, immutable")
            daemon.kill()
        path, = self.files()
        with open(path, "r+b") as file:
            file.seek(1000)
            file.write(b"\xff" * 8)
        with open(path + ".0.part", "wb") as file:
            file.write(b"what a crash left")
        with Daemon(database=self.database) as daemon:
            self.assertEqual(self.files(), [path])
            again = daemon.get(url)
            self.assertEqual((again[0], again[1]["etag"], again[2]), (200, headers["etag"], mesh))
            self.assertEqual(daemon.get(url)[2], mesh)
            self.assertEqual(daemon.get(url, headers={"If-None-Match": headers["etag"]})[0], 304)
            status, part, body = daemon.get(url, headers={"Range": "bytes=16-99", "If-Range": headers["etag"]})
            self.assertEqual((status, part["content-range"], body), (206, f"bytes 16-99/{len(mesh)}", mesh[16:100]))
            status, head, body = daemon.request("HEAD", url)
            self.assertEqual((status, head["content-length"], body), (200, str(len(mesh)), b""))

    def test_meshes_have_only_so_much_room(self):
        with Daemon("--most-meshes", "1M", database=self.database) as daemon:
            url = daemon.request("POST", "/shapes", blob(1))[2]["shapes"][0]["url"]
            sizes = [len(daemon.get(f"{url}/mesh?format=stl&step={0.4 + 0.01 * n}")[2]) for n in range(40)]
            self.assertGreater(sum(sizes), 1 << 20)
            kept = sum(os.path.getsize(path) - 32 for path in self.files())
            self.assertLessEqual(kept, 1 << 20)
            self.assertGreater(kept, 1 << 19)
            self.assertEqual(daemon.request("DELETE", url)[0], 204)
            self.assertEqual(self.files(), [])


if __name__ == "__main__":
    unittest.main()
