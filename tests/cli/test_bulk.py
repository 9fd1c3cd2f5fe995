"""eskel enroll with folders, export and import."""
import csv
import itertools
import json
import os
import re
import signal
import subprocess
import threading
import time
import unittest
import urllib.parse
import urllib.request
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import numpy

from support import ESKEL, ESKELD, NOWHERE, Folder, ball, eskel, hook, side_by_side, write_nifti

try:
    import nibabel
except ImportError:
    nibabel = None

DATA = os.path.join(os.path.dirname(__file__), "../../../shared/data")
ATLAS = "/usr/share/mricron/templates/aal.nii.gz"


class Server:
    """An eskeld with a database of its own."""

    def __init__(self, database, listen="127.0.0.1:0"):
        self.database = database
        self.log = open(database + ".log", "a")
        self.process = subprocess.Popen([ESKELD, "--database", database, "--listen", listen], stdout=subprocess.PIPE,
                                        stderr=self.log, text=True)
        self.url = self.process.stdout.readline().strip()
        if not self.url:
            raise AssertionError("eskeld did not start: " + open(database + ".log").read())

    def stop(self):
        self.process.terminate()
        self.wait()

    def kill(self):
        self.process.kill()
        self.wait()

    def wait(self):
        self.process.wait(60)
        self.process.stdout.close()
        self.log.close()

    def eskel(self, *arguments):
        return eskel(*arguments, "--quiet", environment={"ESKEL_SERVER": self.url})

    def get(self, path):
        with urllib.request.urlopen(self.url + path) as answer:
            return answer.read()

    def patch(self, identity, words):
        request = urllib.request.Request(f"{self.url}/shapes/{identity}", json.dumps(words).encode(), method="PATCH",
                                         headers={"Content-Type": "application/merge-patch+json"})
        urllib.request.urlopen(request).close()

    def shapes(self):
        """All shapes by id, as answered."""
        found, cursor = {}, ""
        while cursor is not None:
            page = json.loads(self.get("/shapes?limit=1000" + cursor))
            found.update((shape["id"], shape) for shape in page["shapes"])
            cursor = page["next"] and "&cursor=" + page["next"]
        return found

    def distances(self):
        table = json.loads(self.get("/distances?columns=all"))
        return {(a, b): d for a, row in zip(table["ids"], table["distances"])
                for b, d in zip(table["columns"]["ids"], row)}


class Tree(Folder):
    """A folder of folders of volumes, and servers that are stopped afterwards."""

    def setUp(self):
        self.top = self.path(self.id().rsplit(".", 1)[1])
        os.mkdir(self.top)

    def server(self, name="shapes.db", **more):
        server = Server(os.path.join(self.top, name), **more)
        self.addCleanup(lambda: server.process.poll() is None and server.stop())
        return server

    def put(self, name, labels, **more):
        path = os.path.join(self.top, "data", name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        write_nifti(path, labels, **more)
        return path

    def put_text(self, name, text):
        path = os.path.join(self.top, "data", name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8", newline="") as file:
            file.write(text)
        return path

    @property
    def data(self):
        return os.path.join(self.top, "data")


def read_csv(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


class Enroll(Tree):
    def counts(self, run):
        return [list(map(int, re.findall(r"\d+", line))) for line in run.stdout.splitlines()
                if re.match("(files|shapes) ", line)]

    def test_a_folder_is_walked_in_the_order_of_names(self):
        server = self.server()
        for number, name in enumerate(("b/2.nii.gz", "b/1.nii", "a.nii", "c/d/e.nii.gz", "plain")):
            self.put(name, side_by_side(ball(5 + number)))
        self.put("hidden/.git/6.nii", side_by_side(ball(11)))
        self.put(".nii/7.nii", side_by_side(ball(12)))
        self.put_text("README", "of the volumes")
        self.put_text("table.csv", "label,name\n1,ball\n")
        outside = os.path.join(self.top, "outside.nii")
        write_nifti(outside, side_by_side(ball(13)))
        os.symlink(outside, os.path.join(self.data, "link.nii"))
        os.symlink(self.top, os.path.join(self.data, "top"))
        os.symlink("a.nii", os.path.join(self.data, "z.nii"))
        run = server.eskel("enroll", self.data, "--parallel", 1, "--json", "--class", "ball")
        self.assertEqual(run.returncode, 0, run.stderr)
        radii = [round((json.loads(line)["shapes"][0]["voxels"] * 3 / 4 / numpy.pi) ** (1 / 3)) for line in run.stdout.splitlines()]
        self.assertEqual(radii, [7, 6, 5, 8, 9, 7])
        self.assertIn("files   6: 5 added, 1 there already, 0 refused\nshapes  6: 5 added, 1 there already\n", run.stderr)
        self.assertEqual({shape["class"] for shape in server.shapes().values()}, {"ball"})
        again = server.eskel("enroll", self.data, os.path.join(self.data, "a.nii"))
        self.assertEqual((again.returncode, again.stderr), (0, ""))
        self.assertEqual(self.counts(again), [[7, 0, 7, 0], [7, 0, 7]])

    def test_what_is_refused_is_told_and_written(self):
        server = self.server()
        self.put("good.nii.gz", side_by_side(ball(6), ball(8)))
        self.put_text("bad.nii", "no volume")
        self.put_text("deep/bad.nrrd", "NRRD0004\n")
        os.symlink("nowhere", os.path.join(self.data, "gone.nii"))
        with open(self.put("cut.nii.gz", side_by_side(ball(9))), "r+b") as file:
            file.truncate(200)
        refused = os.path.join(self.top, "refused.csv")
        run = server.eskel("enroll", self.data, "--refused", refused)
        self.assertEqual((run.returncode, run.stderr), (1, ""))
        self.assertEqual(self.counts(run), [[4, 1, 0, 3], [2, 2, 0]])
        self.assertRegex(run.stdout, rf"(?m)^refused  {self.data}/bad\.nii +the file begins with 6e 6f 20 76, expected")
        self.assertRegex(run.stdout, rf"(?m)^refused  {self.data}/cut\.nii\.gz +the gzip data breaks off$")
        rows = read_csv(refused)
        self.assertEqual([os.path.relpath(row["path"], self.data) for row in rows], ["bad.nii", "cut.nii.gz", "deep/bad.nrrd"])
        self.assertEqual([row["reason"] for row in rows][1], "the gzip data breaks off")

    def test_a_manifest_says_what_files_and_labels_are(self):
        server = self.server()
        self.put("a/two.nii.gz", side_by_side(hook(), ball(6), ball(7)))
        self.put("one.nii", side_by_side(ball(9)))
        self.put("not listed.nii", side_by_side(ball(10)))
        self.put_text("manifest.csv", "\ufeffpath,label,name,class,side,subject,age,sex,attr.a key,levels\r\n"
                      'a/two.nii.gz,1,"hook, the ""first""",hook,L,S1,30.5,F,"x,y",4\r\n'
                      "\r\n"
                      "a/two.nii.gz,2,,ball,none,S1,30.5,F,\"x,y\",4\r\n"
                      "a/two.nii.gz,3,ball_right,,,S2,,,,\r\n"
                      "one.nii,,whole,,R,S3,,male,,\r\n")
        run = server.eskel("enroll", self.data)
        self.assertEqual((run.returncode, run.stderr), (0, ""), run.stdout)
        self.assertEqual(self.counts(run), [[3, 3, 0, 0], [4, 4, 0]])
        found = {(shape["subject"], shape["label"]): shape for shape in server.shapes().values()}
        told = {key: [shape[word] for word in ("name", "class", "side", "age", "sex", "levels", "attributes")]
                for key, shape in found.items()}
        self.assertEqual(told, {
            ("S1", 1): ['hook, the "first"', "hook", "left", 30.5, "female", 4, {"a key": "x,y"}],
            ("S1", 2): [None, "ball", "none", 30.5, "female", 4, {"a key": "x,y"}],
            ("S2", 3): ["ball_right", "ball", "right", None, None, 16, {}],
            ("S3", 1): ["whole", "whole", "right", None, "male", 16, {}],
        })

    def test_a_manifest_may_lie_elsewhere_and_options_fill_what_it_leaves(self):
        server = self.server()
        self.put("one.nii", side_by_side(ball(9)))
        self.put_text("manifest.csv", "file,class\none.nii,nonsense\n")  # not one of ours
        table = os.path.join(self.top, "elsewhere.csv")
        with open(table, "w", encoding="utf-8") as file:
            file.write("path,class\none.nii,ball\n")
        run = server.eskel("enroll", self.data, "--manifest", table, "--subject", "S1")
        self.assertEqual(run.returncode, 0, run.stderr)
        (shape,) = server.shapes().values()
        self.assertEqual((shape["class"], shape["subject"]), ("ball", "S1"))
        run = server.eskel("enroll", self.data, "--manifest", table, "--class", "cube")
        self.assert_run(run, 2, "--class is given, and " + table + " has a column class")

    def test_a_wrong_manifest_is_refused_before_anything_is_sent(self):
        self.put("one.nii", side_by_side(ball(5)))
        for text, said in (
            ("label,name\n1,a\n", "line 1: there is no column called path"),
            ("path,colour\none.nii,red\n", 'line 1, column 2: there is no column "colour", expected path, label, name'),
            ("path,attr.\none.nii,red\n", 'there is no column "attr."'),
            ("path,path\na,b\n", "line 1, column 2: path is a column already"),
            ("path\n/etc/passwd\n", 'line 2, column 1 (path): "/etc/passwd" is not a path below the folder'),
            ("path\na/../../b.nii\n", "is not a path below the folder"),
            ("path\n..\n", "is not a path below the folder"),
            ("path,label\none.nii,0\n", 'line 2, column 2 (label): "0" is not a whole number other than 0'),
            ("path,label\none.nii,1\n\none.nii,1\n", "line 4: one.nii stands in line 2 already"),
            ("path,label\none.nii,2\none.nii,\n", "line 3: one.nii stands in line 2 already"),
            ("path,label\none.nii,-2\none.nii,\none.nii,5\n", "stands in line"),
            ("path,name\none.nii\n", "line 2, column 1: 1 fields, expected 2 as in the header"),
            ('path\n"one.nii\n', "line 2, column 1: a quote is not closed"),
        ):
            with self.subTest(text):
                table = self.put_text("../table.csv", text)
                self.assert_run(eskel("enroll", self.data, "--manifest", table, "--server", NOWHERE), 2, said)

    def test_wrong_usage_is_told_in_one_line(self):
        volume = self.put("one.nii", side_by_side(ball(5)))
        empty = os.path.join(self.top, "empty")
        os.mkdir(empty)
        for arguments, said in (
            (["enroll", empty], "there is no volume in it"),
            (["enroll", volume, "--manifest", "x.csv"], "--manifest needs one folder"),
            (["enroll", self.data, "--manifest", "/nonexistent.csv"], "/nonexistent.csv: No such file"),
            (["enroll", self.data, "--labels", "x.csv"], "--labels is for single files"),
            (["enroll", self.data, "--parallel", "0"], "--parallel is 0, expected 1 to 64"),
            (["enroll", self.data, "--parallel", "2x"], "--parallel is 2x, expected 1 to 64"),
            (["import", self.data], "shapes.csv: No such file"),
            (["export", empty, "--format", "mha"], "--format is mha, expected nifti or nrrd"),
        ):
            with self.subTest(arguments):
                self.assert_run(eskel(*arguments, "--server", NOWHERE), 2, said)

    def test_nobody_there_is_told_once_and_the_rest_is_left(self):
        for radius in range(5, 15):
            self.put(f"{radius}.nii", side_by_side(ball(radius)))
        run = eskel("enroll", self.data, "--server", NOWHERE)
        self.assert_run(run, 3, NOWHERE + " does not answer")
        self.assertIn("0 refused, 10 left\n", run.stdout)
        self.assertIn("broken off; the same command goes on where this ended\n", run.stdout)

    @staticmethod
    def kill_after(server, shapes):
        while json.loads(server.get("/readyz"))["shapes"] < shapes:
            time.sleep(0.005)
        server.kill()

    def test_a_server_that_is_killed_leaves_nothing_behind_that_a_second_run_misses(self):
        rng = numpy.random.default_rng(3)
        for number in range(40):
            labels = side_by_side(*(ball(int(radius)) for radius in rng.integers(5, 16, 3)))
            labels[number % 9, 1, 1] = 9  # no two files are alike
            self.put(f"{number // 10}/{number}.nii.gz", labels, spacing=1 + number / 64)
        server = self.server()
        killer = threading.Thread(target=self.kill_after, args=(server, 40))
        killer.start()
        run = server.eskel("enroll", self.data)
        killer.join()
        self.assertEqual(run.returncode, 3, run.stdout)
        done = self.counts(run)[0][1]
        server = self.server()
        run = server.eskel("enroll", self.data)
        self.assertEqual(run.returncode, 0, run.stderr)
        files, shapes = self.counts(run)
        self.assertEqual((files[0], files[1] + files[2], shapes[0]), (40, 40, 160))
        self.assertGreaterEqual(files[2], done)  # what was answered was on disk
        self.assertEqual(len({id(s) for s in server.shapes().values()}), len(server.shapes()))
        self.assertEqual(self.counts(server.eskel("enroll", self.data))[1], [160, 0, 160])


class Busy(BaseHTTPRequestHandler):
    """Refuses each file twice, then takes it, slowly if it is called so; counts how many are under way."""

    protocol_version = "HTTP/1.1"
    lock = threading.Lock()

    def do_POST(self):
        server = self.server
        body = self.rfile.read(int(self.headers["Content-Length"]))
        with self.lock:
            server.under_way += 1
            server.most = max(server.most, server.under_way)
            server.tries[body] = server.tries.get(body, 0) + 1
            refuse = server.tries[body] <= server.refusals
        time.sleep(server.seconds)
        with self.lock:
            server.under_way -= 1
        self.send_response((429, 503)[server.tries[body] % 2] if refuse else 201)
        answer = b'{"detail":"busy"}' if refuse else b'{"shapes":[{"id":"1"}]}'
        self.send_header("Retry-After" if refuse else "Eskel-Added", "1")
        self.send_header("Content-Length", str(len(answer)))
        self.end_headers()
        self.wfile.write(answer)

    def log_message(self, *arguments):
        pass


class Patience(Tree):
    def busy(self, refusals, seconds):
        server = ThreadingHTTPServer(("127.0.0.1", 0), Busy)
        server.refusals, server.seconds = refusals, seconds
        server.under_way, server.most, server.tries = 0, 0, {}
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        return server, f"http://127.0.0.1:{server.server_port}"

    def test_a_busy_server_is_waited_for(self):
        for radius in range(5, 9):
            self.put(f"{radius}.nii", side_by_side(ball(radius)))
        server, url = self.busy(2, 0)
        begin = time.monotonic()
        run = eskel("enroll", self.data, "--quiet", "--server", url)
        self.assertEqual((run.returncode, run.stderr), (0, ""), run.stdout)
        self.assertGreater(time.monotonic() - begin, 1.9)
        self.assertEqual(sorted(server.tries.values()), [3] * 4)
        self.assertIn("files   4: 4 added", run.stdout)

    def test_as_many_are_under_way_as_asked_for(self):
        for radius in range(5, 17):
            self.put(f"{radius}.nii", side_by_side(ball(radius)))
        for parallel in (1, 3):
            server, url = self.busy(0, 0.1)
            run = eskel("enroll", self.data, "--quiet", "--server", url, "--parallel", parallel)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertEqual(server.most, parallel)

    def test_an_interrupt_lets_what_is_under_way_finish(self):
        for radius in range(5, 17):
            self.put(f"{radius}.nii", side_by_side(ball(radius)))
        server, url = self.busy(0, 0.5)
        run = subprocess.Popen([ESKEL, "enroll", self.data, "--quiet", "--server", url, "--parallel", "2"], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + 30
        while len(server.tries) < 3 and time.monotonic() < deadline:
            time.sleep(0.02)
        run.send_signal(signal.SIGINT)
        out, err = run.communicate(timeout=30)
        self.assertEqual((run.returncode, err), (1, ""), out)
        done = len(server.tries)
        self.assertLess(done, 12)
        self.assertIn(f"files   12: {done} added, 0 there already, 0 refused, {12 - done} left\n", out)
        self.assertIn("interrupted; the same command goes on where this ended\n", out)


def places(path, label):
    """Where the voxels of a label are in a file, and the file's affine, as nibabel reads it."""
    image = nibabel.load(path)
    return numpy.argwhere(numpy.asarray(image.dataobj) == label), image.affine


def strays(exported, path, label):
    """How far, in voxels, the exported ones are at most from those of the file; None where they are not the same ones."""
    (ours, our_affine), (theirs, affine) = places(exported, label), places(path, label)
    there = numpy.linalg.solve(affine, our_affine @ numpy.c_[ours, numpy.ones(len(ours))].T)[:3].T
    nearest = numpy.rint(there).astype(int)
    same = set(map(tuple, nearest)) == set(map(tuple, theirs)) and len(ours) == len(theirs)
    return numpy.abs(there - nearest).max() if same else None


SAID = ("id", "name", "class", "side", "subject", "age", "sex", "attributes", "label", "voxels", "volume_mm3", "centre_mm",
        "levels", "sha256")


class Copy(Tree):
    """Exports of one server imported into another."""

    def assert_same_library(self, a, b):
        first, second = a.shapes(), b.shapes()
        self.assertEqual({i: [s[word] for word in SAID] for i, s in first.items()},
                         {i: [s[word] for word in SAID] for i, s in second.items()})
        for identity in itertools.islice(first, 40):
            self.assertEqual(a.get(f"/shapes/{identity}/skeleton"), b.get(f"/shapes/{identity}/skeleton"))
        self.assertEqual(a.distances(), b.distances())

    def copy(self, source, *options, name="copy"):
        """A new server with all that is in the source; the folder that it came through."""
        folder, target = os.path.join(self.top, name), self.server(name + ".db")
        run = source.eskel("export", folder, *options)
        self.assertEqual((run.returncode, run.stderr), (0, ""), run.stdout)
        run = target.eskel("import", folder)
        self.assertEqual((run.returncode, run.stderr), (0, ""), run.stdout)
        self.assert_same_library(source, target)
        return folder, target

    def test_words_come_back_as_they_were(self):
        source = self.server()
        words = [
            {"name": "left caudate", "class": None, "side": None},
            {"name": None, "class": "femur", "side": "left", "age": 0.00001},
            {"attributes": {"a,b": 'c"d', "ключ": "значение", "=x": "=1+1", "space key": " "}, "age": 59.123456789},
            {"name": "Größe, ⅓", "subject": "O'Brien; \"x\"", "sex": "male", "side": "none", "attributes": {"a.b": "e=f&g"}},
            {},
        ]
        for number, said in enumerate(words):
            path = self.put(f"{number}.nii", side_by_side(ball(5 + number)) * (1, 300, -7, 255, 32767)[number])
            run = source.eskel("enroll", path, "--name", "Caudate_L", "--levels", 3 + number, "--json")
            source.patch(json.loads(run.stdout)["shapes"][0]["id"], said)
        folder, target = self.copy(source)
        rows = read_csv(os.path.join(folder, "shapes.csv"))
        self.assertEqual(list(rows[0])[:4], ["path", "weights", "id", "label"])
        self.assertEqual(sorted(c for c in rows[0] if c.startswith("attr.")),
                         ["attr.=x", "attr.a,b", "attr.a.b", "attr.space key", "attr.ключ"])
        again = target.eskel("import", folder)
        self.assertIn("files   5: 0 added, 5 there already, 0 refused\n", again.stdout)
        self.copy(source, "--format", "nrrd", name="nrrd")
        self.assertEqual({name[-5:] for name in os.listdir(os.path.join(self.top, "nrrd/clouds"))}, {".nrrd"})

    @unittest.skipUnless(nibabel, "there is no nibabel")
    def test_any_geometry_comes_back_and_is_where_it_was(self):
        source = self.server()
        rng = numpy.random.default_rng(11)
        files = {}
        for number in range(24):
            affine = numpy.eye(4)
            affine[:3, :3] = (numpy.linalg.qr(rng.normal(size=(3, 3)))[0] @ numpy.diag(rng.uniform(0.3, 3, 3))
                              + (number % 3) * rng.uniform(-0.2, 0.2, (3, 3)))  # of either hand; two in three sheared
            affine[:3, 3] = rng.uniform(-300, 300, 3) if number % 4 else rng.uniform(-50000, 50000, 3)
            path = os.path.join(self.top, f"{number}.nii.gz")
            labels = numpy.zeros((42, 34, 50), numpy.uint8)
            labels[2:38, 3:31, 3:47][hook()] = 1 + number
            nibabel.save(nibabel.Nifti2Image(labels, affine), path)
            run = source.eskel("enroll", path, "--json", "--subject", number)
            self.assertEqual(run.returncode, 0, run.stderr)
            files[json.loads(run.stdout)["shapes"][0]["id"]] = path
        folder, _ = self.copy(source)
        self.assertEqual(len(files), 24)
        for identity, path in files.items():
            exported = os.path.join(folder, "clouds", identity + ".nii.gz")
            image = nibabel.load(exported)
            self.assertEqual(image.header["sform_code"], 1)
            label = image.dataobj[:].max()
            stray = strays(exported, path, label)
            self.assertIsNotNone(stray, path)
            self.assertLess(stray, 0.01)  # an offset is rounded to a thousandth of the largest spacing
        self.copy(source, "--format", "nrrd", name="nrrd")

    @unittest.skipUnless(nibabel and os.path.isfile(ATLAS), "there is no nibabel or no " + ATLAS)
    def test_an_atlas_comes_back(self):
        source = self.server()
        self.assertEqual(source.eskel("enroll", ATLAS, "--subject", "AAL").returncode, 0)
        folder, _ = self.copy(source)
        rows = read_csv(os.path.join(folder, "shapes.csv"))
        self.assertEqual(len(rows), 116)
        for row in rows[::29]:
            self.assertLess(strays(os.path.join(folder, row["path"]), ATLAS, int(row["label"])), 1e-3)
        signatures = read_csv(os.path.join(folder, "signatures.csv"))
        self.assertEqual(len(signatures), 116 * 136)
        first = json.loads(source.get(f"/shapes/{rows[0]['id']}/signature?level=16"))["rows"]
        told = [[float(row[c]) for c in list(row)[3:]] for row in signatures
                if row["id"] == rows[0]["id"] and row["level"] == "16"]
        numpy.testing.assert_array_equal(numpy.float32(first), numpy.float32(told))

    @unittest.skipUnless(nibabel and os.path.isdir(DATA), "there is no nibabel or no " + DATA)
    def test_bones_come_back(self):
        source = self.server()
        table = os.path.join(self.top, "bones.csv")
        with open(table, "w", encoding="utf-8", newline="") as file:
            rows = read_csv(os.path.join(DATA, "manifest.csv"))
            writer = csv.writer(file)
            writer.writerow(("path", "subject", "sex", "age", "class", "side", "attr.source"))
            writer.writerows((r["file"], r["subject"], r["sex"], r["age"], r["class"], r["side"], r["source"]) for r in rows)
        run = source.eskel("enroll", DATA, "--manifest", table)
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertIn(f"files   {len(rows)}: {len(rows)} added, 0 there already, 0 refused\n", run.stdout)
        self.assertEqual(source.eskel("enroll", os.path.join(DATA, "io_variants")).returncode, 0)
        folder, _ = self.copy(source)
        for row in read_csv(os.path.join(folder, "shapes.csv"))[::10]:
            image = nibabel.load(os.path.join(folder, row["path"]))
            self.assertEqual(numpy.count_nonzero(image.dataobj), int(row["voxels"]))
        for row in rows[::10]:
            (shape,) = [s for s in read_csv(os.path.join(folder, "shapes.csv")) if int(s["voxels"]) == int(row["voxels"])
                        and [s[c] for c in ("class", "side", "subject")] == [row[c] for c in ("class", "side", "subject")]]
            self.assertLess(strays(os.path.join(folder, shape["path"]), os.path.join(DATA, row["file"]), 1), 0.01)

    @unittest.skipUnless(nibabel, "there is no nibabel")
    def test_weights_come_back(self):
        source, rng = self.server(), numpy.random.default_rng(5)
        for number, kind in enumerate((numpy.uint8, numpy.float32, numpy.int16)):
            weights = numpy.where(hook(), rng.integers(1, 256, hook().shape), 0)
            weights = (weights / 255 if kind == numpy.float32 else weights).astype(kind)
            path = self.path(f"weights{number}.nii.gz")
            nibabel.save(nibabel.Nifti1Image(weights, numpy.diag([1 + number, 1, 1, 1])), path)
            self.assertEqual(source.eskel("enroll", path, "--weights").returncode, 0)
        source.eskel("enroll", self.put("plain.nii", side_by_side(hook())))
        folder, _ = self.copy(source)
        rows = read_csv(os.path.join(folder, "shapes.csv"))
        self.assertEqual(sorted(row["weights"] for row in rows), ["", "true", "true", "true"])
        self.assertEqual(source.eskel("export", folder).stdout, "shapes  4: 0 files written, 4 there already\n")
        self.assertEqual(read_csv(os.path.join(folder, "shapes.csv")), rows)
        self.copy(source, "--format", "nrrd", name="nrrd")

    def test_filters_choose_what_is_exported(self):
        source = self.server()
        for radius, name in ((5, "a"), (6, "b"), (7, "a")):
            source.eskel("enroll", self.put(f"{radius}.nii", side_by_side(ball(radius))), "--class", name)
        folder = os.path.join(self.top, "some")
        run = source.eskel("export", folder, "--class", "a")
        self.assertEqual(run.stdout, "shapes  2: 2 files written, 0 there already\n")
        self.assertEqual([row["class"] for row in read_csv(os.path.join(folder, "shapes.csv"))], ["a", "a"])
        self.assertEqual(source.eskel("export", folder, "--class", "none").stdout, "shapes  0: 0 files written, 0 there already\n")
        self.assertEqual(read_csv(os.path.join(folder, "shapes.csv")), [])

    def test_a_broken_off_export_goes_on(self):
        source = self.server()
        for radius in range(5, 15):
            source.eskel("enroll", self.put(f"{radius}.nii", side_by_side(ball(radius))))
        folder = os.path.join(self.top, "out")
        source.eskel("export", folder)
        clouds = os.path.join(folder, "clouds")
        before = {name: os.stat(os.path.join(clouds, name)).st_mtime_ns for name in os.listdir(clouds)}
        lost = sorted(before)[:3]
        for name in lost:
            os.rename(os.path.join(clouds, name), os.path.join(clouds, name.split(".")[0] + ".part"))
        os.remove(os.path.join(folder, "shapes.csv"))
        self.assertEqual(source.eskel("export", folder).stdout, "shapes  10: 3 files written, 7 there already\n")
        after = {name: os.stat(os.path.join(clouds, name)).st_mtime_ns for name in os.listdir(clouds)}
        self.assertEqual({name for name in before if before[name] != after[name]} - set(lost), set())
        self.assertEqual(sorted(after), sorted(before))
        self.assertEqual(len(read_csv(os.path.join(folder, "shapes.csv"))), 10)
        source.kill()
        self.assert_run(source.eskel("export", folder), 3, "does not answer")
        self.assertEqual(len(read_csv(os.path.join(folder, "shapes.csv"))), 10)

    def test_an_import_says_what_is_not_as_it_was(self):
        source, target = self.server(), self.server("other.db")
        for radius in (5, 6, 7):
            source.eskel("enroll", self.put(f"{radius}.nii", side_by_side(ball(radius))), "--class", "ball", "--subject", radius)
        target.eskel("enroll", os.path.join(self.data, "5.nii"), "--class", "bead", "--subject", "5")
        folder = os.path.join(self.top, "out")
        source.eskel("export", folder)
        rows = read_csv(os.path.join(folder, "shapes.csv"))
        for row in rows:
            if row["subject"] == "6":  # another file in its place
                os.replace(os.path.join(folder, [r for r in rows if r["subject"] == "5"][0]["path"]), os.path.join(folder, row["path"]))
        run = target.eskel("import", folder)
        self.assertEqual(run.returncode, 1, run.stdout)
        self.assertRegex(run.stdout, r'(?m)^refused .*the server\'s shape has id "[0-9a-f]{32}", the table says "[0-9a-f]{32}"$')
        self.assertRegex(run.stdout, r"(?m)^refused .*No such file or directory$")
        self.assertIn("files   3: 1 added, 0 there already, 2 refused\n", run.stdout)
        source.eskel("export", folder)
        run = target.eskel("import", folder)
        self.assertIn('the server\'s shape has class "bead", the table says "ball"', run.stdout)
        self.assertEqual({shape["class"] for shape in target.shapes().values()}, {"ball", "bead"})


if __name__ == "__main__":
    unittest.main()
