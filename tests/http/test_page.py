"""The page: its files and, where chromedriver is installed, what a person sees and does with it."""
import json
import os
import re
import tempfile
import unittest
import urllib.parse

from browser import Browser
from daemon import Daemon
from volumes import blob


class Files(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = cls.enterClassContext(Daemon())
        cls.html = cls.daemon.get("/")[2].decode()

    def test_all_that_the_page_loads_is_served_with_its_type(self):
        types = {"js": "text/javascript", "css": "text/css"}
        pending, seen = set(re.findall(r'(?:src|href)="(/page/[^"]+)"', self.html)), set()
        self.assertGreaterEqual(len(pending), 2)
        while pending:
            path = pending.pop()
            seen.add(path)
            status, headers, body = self.daemon.get(path)
            self.assertEqual(status, 200, path)
            self.assertEqual(headers["content-type"], types[path.rsplit(".", 1)[1]] + "; charset=utf-8")
            pending |= {"/page/" + name for name in re.findall(r'from "\./([^"]+)"', body.decode())} - seen
        self.assertGreaterEqual(len(seen), 8)

    def test_nothing_in_it_needs_a_weaker_policy(self):
        self.assertNotRegex(self.html, r"(?i)<script>|\son\w+=|\sstyle=|javascript:|https?://")

    def test_no_module_makes_markup_from_text(self):
        for name in ("app", "client", "dom", "drawing", "library", "recognition", "shape", "superposition"):
            script = self.daemon.get(f"/page/{name}.js")[2].decode()
            self.assertNotRegex(script, r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\(|localStorage"
                                        r"|sessionStorage|cookie", name)


@unittest.skipUnless(Browser.is_there(), "chromedriver is not installed")
class Seen(unittest.TestCase):
    def setUp(self):
        self.daemon = self.enterContext(Daemon())

    def enroll(self, seed, **parameters):
        path = "/shapes?" + urllib.parse.urlencode(parameters)
        self.assertEqual(self.daemon.request("POST", path, blob(seed))[0], 201)

    def open(self, *size, **more):
        browser = self.enterContext(Browser(*size, **more))
        browser.open(self.daemon.url + "/")
        return browser

    def wait_rows(self, browser, count):
        browser.wait(f"document.querySelectorAll('#library tbody tr').length === {count}")

    def test_the_library_is_listed_filtered_and_paged(self):
        for seed in range(60):
            self.enroll(seed, name=f"bone {seed}", **{"class": "femur" if seed % 3 else "tibia"})
        browser = self.open()
        self.wait_rows(browser, 50)
        browser.click("#more")
        self.wait_rows(browser, 60)
        browser.type("#filter [name=class]", "tibia")
        self.wait_rows(browser, 20)
        self.assertEqual(browser.messages(), [])

    def test_a_file_is_recognized_label_by_label(self):
        for seed in range(4):
            self.enroll(seed, name=f"bone {seed}", side="left", **{"class": "femur"})
        browser = self.open()
        with tempfile.NamedTemporaryFile(suffix=".nii") as file:
            file.write(blob(1, labels=2))
            file.flush()
            browser.type("#file", file.name)
            browser.click("#recognize .main")
            browser.wait("document.querySelectorAll('#answer article').length === 2")
        text = browser.text("#answer")
        for word in ("label 1", "label 2", "femur", "left", "bone 1", "0.0000", "exact search among 4 shapes"):
            self.assertIn(word, text)
        self.assertEqual(len(self.daemon.get("/shapes")[2]["shapes"]), 4, "nothing is stored")
        self.assertEqual(browser.messages(), [])

    def test_a_shape_is_shown_level_by_level_and_recognized(self):
        for seed in range(3):
            self.enroll(seed, name=f"bone {seed}", subject=f"S{seed}", **{"attr.scanner": "CT 5"})
        browser = self.open()
        self.wait_rows(browser, 3)
        browser.click("#library tbody a")
        browser.wait("document.querySelectorAll('#shape svg').length === 3")
        self.assertIn("CT 5", browser.text("#shape"))
        self.assertEqual(browser.run("return document.querySelectorAll('#shape svg ellipse').length"), 30)
        browser.run("const s = document.querySelector('#shape [type=range]'); s.value = 4; s.dispatchEvent(new Event('input'))")
        self.assertEqual(browser.run("return document.querySelectorAll('#shape svg ellipse').length"), 12)
        browser.click("#shape button.main")
        browser.wait("document.querySelectorAll('#shape article tbody tr').length === 2")
        self.assertEqual(browser.messages(), [])

    def test_names_are_text(self):
        hostile = '<img src=x onerror="document.title=1"><script>document.title=2</script>'
        self.enroll(1, name=hostile, subject=hostile, **{"class": hostile, "attr.k": hostile})
        browser = self.open()
        self.wait_rows(browser, 1)
        browser.click("#library tbody a")
        browser.wait("document.querySelectorAll('#shape svg').length === 3")
        self.assertEqual(browser.text("#shape-title"), hostile)
        self.assertEqual(browser.run("return document.title"), "eskel")
        self.assertEqual(browser.run("return document.querySelectorAll('img').length"), 0)

    def test_a_neighbour_is_laid_over_the_shape(self):
        for seed in range(3):
            self.enroll(seed, name=f"bone {seed}")
        browser = self.open()
        with tempfile.NamedTemporaryFile(suffix=".nii") as file:
            file.write(blob(1))
            file.flush()
            browser.type("#file", file.name)
            browser.click("#recognize .main")
            browser.wait("document.querySelectorAll('#answer .drawings svg').length === 3")
        places = """return [...document.querySelectorAll('#answer .drawings svg:first-child ellipse')].map(e =>
            [...e.getAttribute('transform').matchAll(/translate\\((\\S+) (\\S+)\\)/g)][0].slice(1).map(Number))"""
        ellipses = browser.run(places)
        self.assertEqual(len(ellipses), 3 * 20, "ten classes of either in each view")
        for first in range(0, 60, 20):  # the nearest is the shape itself
            view = sorted(ellipses[first:first + 10]), sorted(ellipses[first + 10:first + 20])
            for laid, own in zip(*view):
                self.assertAlmostEqual(laid[0], own[0], 4)
                self.assertAlmostEqual(laid[1], own[1], 4)
        browser.run("const s = document.querySelector('#answer .over select'); s.value = 'bone 2';"
                    "s.dispatchEvent(new Event('change'))")
        self.assertIn("bone 2", browser.text("#answer .keys"))
        self.assertNotEqual(browser.run(places), ellipses)
        self.assertEqual(browser.messages(), [])

    def test_the_token_opens_the_library_and_stays_in_memory(self):
        self.enroll(1, name="bone")
        token = self.daemon.token("read")
        browser = self.open()
        browser.wait("document.querySelector('#status.error')")
        self.assertIn("token", browser.text("#status"))
        self.assertEqual(browser.run("return document.activeElement.id"), "token")
        browser.type("#token", token)
        browser.click("#access button")
        self.wait_rows(browser, 1)
        kept = browser.run("return JSON.stringify([localStorage, sessionStorage, document.cookie, location.href])")
        self.assertNotIn(token, kept)
        self.assertEqual(json.loads(kept)[2], "")

    def test_a_refusal_is_told_in_the_servers_words(self):
        browser = self.open()
        with tempfile.NamedTemporaryFile() as file:
            file.write(b"not a volume" * 100)
            file.flush()
            browser.type("#file", file.name)
            browser.click("#recognize .main")
            browser.wait("document.querySelector('#status.error')")
        self.assertGreater(len(browser.text("#status")), 20)

    def test_nothing_is_wider_than_a_telephone(self):
        for seed in range(3):
            self.enroll(seed, name="a rather long name of a bone " * 3, side="left", **{"class": "femur"})
        browser = self.open(400, 800, dark=True)
        self.wait_rows(browser, 3)
        browser.run("document.querySelector('#library tbody a').click()")
        browser.wait("document.querySelectorAll('#shape svg').length === 3")
        browser.run("document.querySelector('#shape button.main').click()")
        browser.wait("document.querySelectorAll('#shape article').length === 1")
        self.assertLessEqual(browser.run("return document.documentElement.scrollWidth"), 400)
        if folder := os.environ.get("ESKEL_SCREENSHOTS"):
            browser.screenshot(os.path.join(folder, "telephone.png"))


if __name__ == "__main__":
    unittest.main()
