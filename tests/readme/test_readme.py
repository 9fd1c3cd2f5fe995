"""Runs the README's quick start and its tour as pasted, and compares what they print with what the README shows.

A fenced `sh` block is run by sh in the checkout; the fenced `text` block after it, if there is one, is what it prints.
Numbers and ids may differ from run to run, the rest may not. `test_readme.py --update` writes the answers anew.
"""
import pathlib
import re
import subprocess
import sys
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]
README = TOP / "README.md"
QUICK_START = "sh deploy/quickstart.sh"
RUN_BY_OTHERS = {"sh tests/run.sh"}
DOCUMENTED_URL = "http://127.0.0.1:8467"
BLOCK = re.compile(r"```sh\n(?P<command>.*?)\n```\n(?:\n```text\n(?P<answer>.*?)\n?```\n)?", re.S)


def run(command):
    done = subprocess.run(["sh", "-c", command], cwd=TOP, capture_output=True, text=True, timeout=1500,
                          stdin=subprocess.DEVNULL)
    return done.returncode, done.stdout, done.stderr


def without_numbers(text):
    text = re.sub(r"[0-9a-f]{32,64}", "<id>", text)
    text = re.sub(r"-?\d+(\.\d+)?(e-?\d+)?", "<n>", text)
    return [re.sub(r" {2,}", " ", line).rstrip() for line in text.splitlines()]


def quick_start():
    """Its output from the first answer on (before that, the compiler speaks) and the server's URL."""
    status, out, err = run(QUICK_START)
    if status != 0:
        raise AssertionError(f"{QUICK_START}: exit status {status}\n{out[-4000:]}\n{err[-4000:]}")
    url = (TOP / "build/quickstart/url").read_text().strip()
    answer = out[out.index("Storing the brain regions"):].replace(str(TOP), "eskel")
    return answer.replace(url, DOCUMENTED_URL), url


def tour(text):
    """(command, documented answer) of every block that a reader pastes."""
    for block in BLOCK.finditer(text):
        if block["command"] not in RUN_BY_OTHERS | {QUICK_START}:
            yield block["command"], block["answer"]


def stop_server():
    run("kill $(cat build/quickstart/eskeld.pid)")


class Readme(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        (TOP / "build/quickstart/shapes.db").unlink(missing_ok=True)
        cls.quick_start_answer, cls.url = quick_start()
        cls.addClassCleanup(stop_server)

    def test_the_quick_start_prints_what_the_readme_shows(self):
        if not (TOP / "../shared/data/manifest.csv").exists():
            self.skipTest("no bones in ../shared/data: the quick start prints less without them")
        documented = next(b["answer"] for b in BLOCK.finditer(README.read_text()) if b["command"] == QUICK_START)
        self.assertEqual(without_numbers(documented), without_numbers(self.quick_start_answer))

    def test_the_tour_prints_what_the_readme_shows(self):
        blocks = list(tour(README.read_text()))
        self.assertGreater(len(blocks), 8)
        for command, documented in blocks:
            with self.subTest(command=command):
                status, out, err = run(command.replace(DOCUMENTED_URL, self.url))
                self.assertEqual((status, err), (0, ""), out)
                if documented is not None:
                    self.assertEqual(without_numbers(documented), without_numbers(out.replace(self.url, DOCUMENTED_URL)))


def update():
    (TOP / "build/quickstart/shapes.db").unlink(missing_ok=True)
    answer, url = quick_start()
    text = README.read_text()

    def renew(block):
        command = block["command"]
        if block["answer"] is None:
            if command not in RUN_BY_OTHERS:
                run(command.replace(DOCUMENTED_URL, url))
            return block[0]
        new = answer if command == QUICK_START else run(command.replace(DOCUMENTED_URL, url))[1].replace(url, DOCUMENTED_URL)
        return f"```sh\n{command}\n```\n\n```text\n{new.rstrip()}\n```\n"

    README.write_text(BLOCK.sub(renew, text))
    stop_server()


if __name__ == "__main__":
    if sys.argv[1:] == ["--update"]:
        update()
    else:
        unittest.main()
