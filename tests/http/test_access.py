"""Who is let in, and what is said about them: Host, other sites, tokens, roles, rates, headers, the log."""
import http.client
import os
import re
import shutil
import ssl
import subprocess
import tempfile
import time
import unittest

from daemon import HOST, Daemon, administer, wait_until
from volumes import blob


class OpenServer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = cls.enterClassContext(Daemon("--host", "bones.example"))

    def test_hosts_that_are_not_ours_are_refused(self):
        for host in ("evil.example", "localhost.evil.example", "127.0.0.2", "", "localhost@evil.example"):
            self.assertEqual(self.daemon.get("/healthz", headers={"Host": host})[0], 421, host)
        for host in ("localhost", "LocalHost:1", "127.0.0.1:9", "[::1]", f"127.0.0.1:{self.daemon.port}", "bones.example"):
            self.assertEqual(self.daemon.get("/healthz", headers={"Host": host})[0], 200, host)

    def test_a_page_of_another_site_changes_nothing(self):
        foreign = ({"Sec-Fetch-Site": "cross-site"}, {"Sec-Fetch-Site": "same-site"}, {"Origin": "http://evil.example"},
                   {"Origin": "null"})
        for headers in foreign:
            headers = headers | {"Content-Type": "text/plain"}
            self.assertEqual(self.daemon.request("POST", "/shapes", blob(1), headers)[0], 403, headers)
            self.assertEqual(self.daemon.request("DELETE", "/shapes/" + "0" * 32, headers=headers)[0], 403, headers)
        self.assertEqual(self.daemon.get("/shapes")[2]["shapes"], [])
        ours = {"Sec-Fetch-Site": "same-origin", "Origin": f"http://localhost:{self.daemon.port}"}
        self.assertEqual(self.daemon.request("POST", "/recognize", blob(1), ours)[0], 200)

    def test_form_posts_of_other_programs_are_served(self):
        headers = {"Content-Type": "application/x-www-form-urlencoded"}  # what curl --data-binary says
        self.assertEqual(self.daemon.request("POST", "/recognize", blob(1), headers)[0], 200)

    def test_no_origin_is_allowed_to_read_answers(self):
        headers = {"Origin": "http://evil.example"}
        for path in ("/", "/shapes", "/none"):
            self.assertNotIn("access-control-allow-origin", self.daemon.get(path, headers=headers)[1])

    def test_every_answer_has_the_safety_headers(self):
        answers = [self.daemon.get(path) for path in ("/", "/page/app.js", "/healthz", "/metrics", "/openapi.json", "/none")]
        answers += [self.daemon.request("POST", "/shapes", b"junk"), self.daemon.request("FOO", "/"),
                    self.daemon.get("/%zz"), self.daemon.get("/healthz", headers={"Host": "evil.example"}),
                    self.daemon.get("/shapes", token="wrong")]
        for status, headers, _ in answers:
            self.assertEqual(headers["x-content-type-options"], "nosniff", status)
            self.assertEqual(headers["referrer-policy"], "no-referrer", status)
            self.assertIn("default-src 'none'", headers["content-security-policy"])
            self.assertIn("no-", headers["cache-control"])
            if status >= 400:
                self.assertEqual(headers["content-type"], "application/problem+json")

    def test_a_problem_names_its_status_and_the_reason(self):
        for status, _, body in (self.daemon.get("/%zz"), self.daemon.get("/none"), self.daemon.get("/shapes", token="x")):
            self.assertEqual(body["status"], status)
            self.assertGreater(len(body["detail"]), 10)


class Tokens(unittest.TestCase):
    def test_from_the_first_token_on_each_request_needs_one(self):
        with Daemon() as daemon:
            self.assertEqual(daemon.get("/shapes")[0], 200)
            token = daemon.token("admin")
            status, headers, _ = daemon.get("/shapes")
            self.assertEqual((status, headers["www-authenticate"]), (401, "Bearer"))
            self.assertEqual(daemon.get("/shapes", token=token)[0], 200)
            self.assertEqual(daemon.get("/metrics")[0], 401)
            self.assertEqual(daemon.get("/metrics", token=token)[0], 200)
            for path in ("/", "/page/app.js", "/healthz", "/readyz", "/openapi.json"):
                self.assertEqual(daemon.get(path)[0], 200, path)

    def test_roles_include_those_below(self):
        with Daemon() as daemon:
            read, write, admin = (daemon.token(role) for role in ("read", "write", "admin"))
            self.assertEqual(daemon.request("POST", "/shapes", blob(1), token=read)[0], 403)
            self.assertEqual(daemon.request("POST", "/recognize", blob(1), token=read)[0], 200)
            self.assertEqual(daemon.request("POST", "/shapes", blob(1), token=write)[0], 201)
            self.assertEqual(daemon.request("POST", "/shapes", blob(2), token=admin)[0], 201)
            for token in (read, write, admin):
                self.assertEqual(len(daemon.get("/shapes", token=token)[2]["shapes"]), 2)

    def test_a_revoked_or_expired_token_is_worthless_at_once(self):
        with Daemon() as daemon:
            first, second = daemon.token("read"), daemon.token("read", "--days", "1")
            self.assertEqual(daemon.get("/shapes", token=second)[0], 200)
            self.assertEqual(daemon.administer("token", "revoke", "2")[0], 0)
            self.assertEqual(daemon.get("/shapes", token=second)[0], 401)
            self.assertEqual(daemon.get("/shapes", token=first)[0], 200)
            self.assertEqual(daemon.administer("token", "revoke", "1")[0], 0)
            self.assertEqual(daemon.get("/shapes")[0], 401, "all tokens are revoked: nobody, not everybody")
            listed = daemon.administer("token", "list")[1]
            self.assertEqual(len(re.findall(r"^ +\d+  read ", listed, re.MULTILINE)), 2)
            self.assertNotIn(first, listed)

    def test_malformed_tokens_are_refused(self):
        with Daemon() as daemon:
            token = daemon.token("admin")
            for value in (token, "Basic " + token, "Bearer", "Bearer ", f"Bearer {token}0", f"Bearer {token[:-1]}",
                          f"Bearer {token} ", f"Bearer  {token}", "Bearer " + "0" * 64, "Bearer ' OR 1=1 --"):
                status, headers, _ = daemon.get("/shapes", headers={"Authorization": value})
                if value.rstrip() != f"Bearer {token}":  # white space at a field's end is not part of it
                    self.assertEqual((status, headers["www-authenticate"]), (401, "Bearer"), value)
            self.assertEqual(daemon.get("/shapes", headers={"Authorization": f"bearer {token}"})[0], 200)

    def test_beyond_loopback_a_server_needs_a_token(self):
        with tempfile.TemporaryDirectory() as folder:
            database = os.path.join(folder, "shapes.eskel")
            status, _, err = administer("--listen", "0.0.0.0:0", database=database)
            self.assertEqual(status, 1)
            self.assertIn("eskeld token add", err)
            self.assertEqual(administer("token", "add", "x", database=database)[0], 0)
            self.assertEqual(administer("token", "revoke", "1", database=database)[0], 0)
            self.assertEqual(administer("--listen", "0.0.0.0:0", database=database)[0], 1, "a revoked token is none")
            self.assertEqual(administer("token", "add", "y", database=database)[0], 0)
            with Daemon("--listen", "0.0.0.0:0", database=database) as daemon:
                self.assertEqual(daemon.get("/healthz")[0], 200)
                self.assertEqual(daemon.get("/shapes")[0], 401)

    def test_the_token_is_printed_alone_and_the_database_is_private(self):
        with tempfile.TemporaryDirectory() as folder:
            database = os.path.join(folder, "shapes.eskel")
            status, out, err = administer("token", "add", "scanner", "--role", "write", database=database)
            self.assertEqual(status, 0)
            self.assertRegex(out, r"^[0-9a-f]{64}\n$")
            self.assertIn("role write", err)
            for name in os.listdir(folder):
                self.assertEqual(os.stat(os.path.join(folder, name)).st_mode & 0o77, 0, name)
                with open(os.path.join(folder, name), "rb") as file:
                    self.assertNotIn(out.strip().encode(), file.read())


class Rates(unittest.TestCase):
    def test_too_many_requests_are_told_to_wait(self):
        with Daemon("--rate", "20") as daemon:
            answers = [daemon.get("/healthz") for _ in range(60)]
            refused = [headers for status, headers, _ in answers if status == 429]
            self.assertGreater(len(refused), 10)
            self.assertEqual(refused[0]["retry-after"], "1")
            time.sleep(1.1)
            self.assertEqual(daemon.get("/healthz")[0], 200)

    def test_tokens_do_not_use_each_others_requests(self):
        with Daemon("--rate", "20") as daemon:
            one, other = daemon.token("read"), daemon.token("read")
            wait_until(lambda: daemon.get("/shapes", token=one)[0] == 429, "one token's requests are used up")
            self.assertEqual(daemon.get("/shapes", token=other)[0], 200)

    def test_a_wrong_token_costs_a_hundred_requests(self):
        with Daemon("--rate", "20") as daemon:
            good = daemon.token("read")
            self.assertEqual(daemon.get("/shapes", token="wrong")[0], 401)
            self.assertEqual(daemon.get("/shapes", token="wrong")[0], 429)
            self.assertEqual(daemon.get("/shapes", token=good)[0], 200)


@unittest.skipUnless(shutil.which("openssl"), "openssl, which makes the certificate, is not installed")
class Tls(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())
        self.certificate, self.key = (os.path.join(self.folder, name) for name in ("certificate.pem", "key.pem"))
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days",
                        "2", "-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost", "-keyout", self.key,
                        "-out", self.certificate], check=True, capture_output=True)

    def test_https_is_served_with_the_certificate(self):
        with Daemon("--tls-certificate", self.certificate, "--tls-key", self.key) as daemon:
            self.assertTrue(daemon.url.startswith("https://"))
            trusting = ssl.create_default_context(cafile=self.certificate)
            connection = http.client.HTTPSConnection("localhost", daemon.port, context=trusting, timeout=20)
            for _ in range(3):
                connection.request("POST", "/recognize", blob(1))
                self.assertEqual(connection.getresponse().read()[:12], b'{"results":[')
            connection.close()
            with daemon.socket() as plain:
                plain.sendall(b"GET /healthz HTTP/1.1\r\n" + HOST + b"\r\n")
                self.assertFalse(plain.recv(1000).startswith(b"HTTP/"))

    def test_a_key_that_is_none_is_said(self):
        database = os.path.join(self.folder, "shapes.eskel")
        for key in (self.certificate, os.path.join(self.folder, "none.pem")):
            status, _, err = administer("--listen", "127.0.0.1:0", "--tls-certificate", self.certificate, "--tls-key", key,
                                        database=database)
            self.assertEqual(status, 1)
            self.assertRegex(err, "key|PEM|none.pem")


class Log(unittest.TestCase):
    def test_a_line_tells_what_was_done_and_nothing_of_the_patient(self):
        with Daemon() as daemon:
            token = daemon.token("write")
            secret = "Erika%20Mustermann"
            query = f"name={secret}&subject={secret}&class=femur&side=left&attr.note={secret}"
            status, headers, _ = daemon.request("POST", "/shapes?" + query, blob(1), token=token)
            self.assertEqual(status, 201)
            daemon.get(f"/shapes?q={secret}", token=token)
            daemon.get(f"/{secret}", token=token)
            daemon.stop()
            log = daemon.log_text()
            identity = headers["location"].rsplit("/", 1)[1]
            self.assertRegex(log, r"time=\S+Z event=request method=POST route=/shapes status=201 received=\d+ bytes=\d+"
                                  rf" ms=\S+ token=1 shape={identity}\n")
            for word in ("Erika", "Mustermann", "femur", token, "note"):
                self.assertNotIn(word, log)

    def test_a_method_cannot_forge_a_line(self):
        with Daemon() as daemon:
            daemon.raw(b"A=\"\x1b\\B /healthz HTTP/1.1\r\n" + HOST + b"\r\n", replies=1)
            daemon.stop()
            self.assertIn(r'method="A=\"\x1b\\B"', daemon.log_text())


if __name__ == "__main__":
    unittest.main()
