"""A really started eskeld on a free port with a database of its own, and ways to talk to it.

ESKELD names the program (set by ctest). Each test that wants a server makes one:

    with Daemon("--queue", "1") as daemon:
        status, headers, body = daemon.get("/healthz")
"""
import contextlib
import http.client
import json
import os
import re
import select
import signal
import socket
import subprocess
import tempfile
import time

ESKELD = os.environ.get("ESKELD", "eskeld")
HOST = b"Host: localhost\r\n"


class Daemon:
    """Options beyond --database and --listen as on the command line. A given database is left in place."""

    def __init__(self, *options, database=None, before_exec=None):
        self.options = options
        self.folder = None if database else tempfile.TemporaryDirectory(prefix="eskel-http-")
        self.database = database or os.path.join(self.folder.name, "shapes.eskel")
        self.before_exec = before_exec
        self.process = None

    def __enter__(self):
        self.log = tempfile.TemporaryFile()
        command = [ESKELD, "--database", self.database, "--listen", "127.0.0.1:0", *self.options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=self.log, preexec_fn=self.before_exec)
        readable, _, _ = select.select([self.process.stdout], [], [], 60)
        self.url = self.process.stdout.readline().decode().strip() if readable else ""
        if not self.url:
            self.kill()
            raise AssertionError("eskeld did not start: " + self.log_text())
        self.port = int(self.url.rsplit(":", 1)[1])
        return self

    def __exit__(self, kind, value, trace):
        if self.process.poll() is None:
            status = self.stop()
            if kind is None:
                assert status == 0, f"exit status {status}: {self.log_text()[-4000:]}"
        self.process.stdout.close()
        self.log.close()
        if self.folder:
            self.folder.cleanup()

    def stop(self, patience=60):
        """SIGTERM; the exit status."""
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(patience)

    def kill(self):
        self.process.kill()
        self.process.wait()

    def log_text(self):
        self.log.seek(0)
        return self.log.read().decode("utf-8", "replace")

    def administer(self, *words):
        """Runs a command on the database: (exit status, standard output, standard error)."""
        return administer(*words, database=self.database)

    def token(self, role, *more):
        status, out, err = self.administer("token", "add", f"{role} of the tests", "--role", role, *more)
        assert status == 0, err
        return out.strip()

    # ---- well-formed requests

    def connect(self, timeout=60):
        return http.client.HTTPConnection("127.0.0.1", self.port, timeout=timeout)

    def request(self, method, path, body=None, headers=None, token=None):
        """(status, headers with lower-case names, body); the body decoded where it is JSON."""
        fields = {"Host": "localhost"} | ({"Authorization": f"Bearer {token}"} if token else {}) | (headers or {})
        with contextlib.closing(self.connect()) as connection:
            connection.request(method, path, body, fields)
            return read_response(connection.getresponse())

    def get(self, path, **more):
        return self.request("GET", path, **more)

    def metric(self, name):
        """The sum over all labels of the samples of that name."""
        text = self.get("/metrics")[2].decode()
        return sum(float(value) for value in re.findall(rf"^{name}(?:{{.*}})? (\S+)$", text, re.MULTILINE))

    # ---- any bytes

    def socket(self, timeout=5):
        return socket.create_connection(("127.0.0.1", self.port), timeout=timeout)

    def exchange(self, data, replies=None, timeout=20):
        """Sends bytes, then reads that many replies, or to the end: (bytes, closed)."""
        with contextlib.closing(self.socket(timeout)) as connection:
            with contextlib.suppress(OSError):  # the server may answer and close before it has read all
                connection.sendall(data)
            return receive(connection, replies)

    def raw(self, data, replies=None):
        """The same: (statuses of the replies, closed)."""
        received, closed = self.exchange(data, replies)
        return split_replies(received), closed


def administer(*words, database):
    result = subprocess.run([ESKELD, *words, "--database", database], capture_output=True, text=True, timeout=60)
    return result.returncode, result.stdout, result.stderr


def read_response(response):
    headers = {name.lower(): value for name, value in response.getheaders()}
    body = response.read()
    if "json" in headers.get("content-type", "") and body:
        body = json.loads(body)
    return response.status, headers, body


def receive(connection, replies=None):
    """All bytes from a socket until that many replies are there or it is closed, and whether it was closed."""
    data = b""
    while replies is None or len(split_replies(data)) < replies:
        try:
            piece = connection.recv(1 << 16)
        except ConnectionResetError:
            piece = b""
        if not piece:
            return data, True
        data += piece
    return data, False


def split_replies(data):
    """The statuses of whole replies one after another, each delimited by its Content-Length."""
    statuses = []
    while b"\r\n\r\n" in data:
        head, _, data = data.partition(b"\r\n\r\n")
        match = re.match(rb"HTTP/1\.1 (\d{3}) ", head)
        assert match, f"no reply begins with {head[:60]!r}"
        length = re.search(rb"(?im)^Content-Length: (\d+)\r?$", head)
        size = int(length[1]) if length else 0
        if len(data) < size:
            break
        statuses.append(int(match[1]))
        data = data[size:]
    return statuses


def wait_until(condition, what, seconds=30):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"waited {seconds} s until {what}"
        time.sleep(0.02)
