"""A headless Chromium through WebDriver, with nothing but HTTP and JSON. ESKEL_CHROMEDRIVER names another driver."""
import base64
import json
import os
import shutil
import subprocess
import time
import urllib.error
import urllib.request

DRIVER = os.environ.get("ESKEL_CHROMEDRIVER", "chromedriver")
ELEMENT = "element-6066-11e4-a52e-4f735466cecf"  # the key of an element reference, from the standard


class WebDriverError(Exception):
    pass


class Browser:
    def __init__(self, width=1200, height=900, dark=False):
        flags = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", f"--window-size={width},{height}"]
        if dark:
            flags.append("--blink-settings=preferredColorScheme=0")
        self.options = {"args": flags}
        self.mobile = {"deviceMetrics": {"width": width, "height": height, "pixelRatio": 1}} if width < 500 else None

    @staticmethod
    def is_there():
        return shutil.which(DRIVER) is not None

    def __enter__(self):
        self.start_driver()
        if self.mobile:
            self.options["mobileEmulation"] = self.mobile
        wanted = {"goog:chromeOptions": self.options, "goog:loggingPrefs": {"browser": "ALL"}}
        made = self.call("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})
        self.session = "/session/" + made["sessionId"]
        return self

    def start_driver(self):
        """The port that it chooses may be taken a moment later, then it ends: once more."""
        for _ in range(3):
            self.process = subprocess.Popen([DRIVER, "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            for line in self.process.stdout:
                if "started successfully on port" in line:
                    self.root = f"http://127.0.0.1:{line.strip().rstrip('.').rsplit(' ', 1)[1]}"
                    return
            self.process.stdout.close()
            self.process.wait()
        raise WebDriverError("chromedriver does not start")

    def __exit__(self, *_):
        try:
            self.call("DELETE", self.session)
        finally:
            self.process.terminate()
            self.process.wait()
            self.process.stdout.close()

    def call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.root + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=60) as response:
                return json.load(response)["value"]
        except urllib.error.HTTPError as error:
            raise WebDriverError(json.load(error)["value"]["message"]) from None

    def open(self, url):
        self.call("POST", self.session + "/url", {"url": url})

    def find(self, css):
        return self.call("POST", self.session + "/element", {"using": "css selector", "value": css})[ELEMENT]

    def type(self, css, text):
        self.call("POST", f"{self.session}/element/{self.find(css)}/value", {"text": text})

    def click(self, css):
        self.call("POST", f"{self.session}/element/{self.find(css)}/click", {})

    def run(self, script, *arguments):
        return self.call("POST", self.session + "/execute/sync", {"script": script, "args": list(arguments)})

    def text(self, css):
        return self.run("return document.querySelector(arguments[0])?.innerText ?? ''", css)

    def wait(self, script, seconds=20):
        """Until the expression is truthy; its value."""
        end = time.monotonic() + seconds
        while not (value := self.run("return " + script)):
            if time.monotonic() > end:
                raise AssertionError(f"waited for {script}; the page says: {self.text('body')[:2000]}")
            time.sleep(0.05)
        return value

    def messages(self):
        """What the console got: errors of scripts, of the network, and of the content security policy."""
        return [entry["message"] for entry in self.call("POST", self.session + "/se/log", {"type": "browser"})
                if entry["level"] == "SEVERE"]

    def screenshot(self, path):
        with open(path, "wb") as file:
            file.write(base64.b64decode(self.call("GET", self.session + "/screenshot")))
