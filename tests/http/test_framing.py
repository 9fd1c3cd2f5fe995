"""What libmicrohttpd lets through and eskeld must not: one test for each way to write a request wrongly."""
import unittest

from daemon import HOST, Daemon
from volumes import blob, nifti

GET = b"GET /healthz HTTP/1.1\r\n"
POST = b"POST /recognize HTTP/1.1\r\n" + HOST
NEXT = GET + HOST + b"\r\n"


def upload(body, method=b"POST", path=b"/recognize", more=b""):
    return method + b" " + path + b" HTTP/1.1\r\n" + HOST + more + b"Content-Length: %d\r\n\r\n" % len(body) + body


def chunked(body, size=1000):
    pieces = [body[at:at + size] for at in range(0, len(body), size)]
    return b"".join(b"%x\r\n%s\r\n" % (len(piece), piece) for piece in pieces) + b"0\r\n\r\n"


class Framing(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = cls.enterClassContext(Daemon("--most-body", "10M"))

    def refused(self, data, *statuses):
        """The request gets that one reply and the connection is closed: what follows is not read as a request."""
        self.assertEqual(self.daemon.raw(data + NEXT), (list(statuses), True), data[:80])

    def refused_by_libmicrohttpd(self, data, status):
        """It sends the head of such a reply twice (0.9.75)."""
        received, closed = self.daemon.exchange(data + NEXT)
        self.assertTrue(received.startswith(b"HTTP/1.1 %d " % status), received[:80])
        self.assertNotIn(b" 200 ", received)
        self.assertTrue(closed)

    def answered(self, data, *statuses):
        """The requests get these replies, and the connection then serves another one."""
        expected = [*statuses, 200]
        self.assertEqual(self.daemon.raw(data + NEXT, len(expected)), (expected, False), data[:80])

    def test_two_content_lengths_are_refused(self):
        self.refused(POST + b"Content-Length: 5\r\nContent-Length: 5\r\n\r\nhello", 400)
        self.refused(POST + b"Content-Length: 5\r\ncontent-length: 50\r\n\r\nhello", 400)

    def test_two_hosts_are_refused(self):
        self.refused(GET + HOST + HOST + b"\r\n", 400)

    def test_a_length_beside_an_encoding_is_refused(self):
        self.refused(POST + b"Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400)
        self.refused(POST + b"Transfer-Encoding: chunked\r\nContent-Length: 5\r\n\r\n0\r\n\r\n", 400)

    def test_an_encoding_other_than_chunked_is_refused(self):
        for encoding in (b"gzip", b"gzip, chunked", b"chunked, identity", b"xchunked", b"identity", b""):
            self.refused(POST + b"Transfer-Encoding: " + encoding + b"\r\n\r\n0\r\n\r\n", 501)
        self.refused(POST + b"Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400)
        self.refused(b"POST /recognize HTTP/1.0\r\n" + HOST + b"Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400)

    def test_header_names_that_are_no_tokens_are_refused(self):
        self.refused(POST + b"Content-Length : 5\r\n\r\nhello", 400)
        self.refused(POST + b"Content-Length\t: 5\r\n\r\nhello", 400)
        self.refused(POST + b"X: a\r\n Content-Length: 5\r\n\r\nhello", 400)

    def test_a_malformed_content_length_is_refused(self):
        for length in (b"+5", b"-1", b"0x5", b"5, 5", b"5 5"):
            self.refused_by_libmicrohttpd(POST + b"Content-Length: " + length + b"\r\n\r\nhello", 400)
        for length in (b"18446744073709551615", b"9223372036854775808", b"99999999999999999999999"):
            self.refused_by_libmicrohttpd(POST + b"Content-Length: " + length + b"\r\n\r\nhello", 413)

    def test_malformed_chunks_are_refused(self):
        for size in (b"-5", b"0x5", b"5 5", b"", b"g"):
            self.refused(POST + b"Transfer-Encoding: chunked\r\n\r\n" + size + b"\r\nhello\r\n0\r\n\r\n", 400)

    def test_hostile_targets_are_refused(self):
        targets = (b"/healthz%00", b"/healthz%00b", b"/a%0d%0aX:y", b"/%zz", b"/%", b"/%4", b"/?a=%00", b"/a\tb",
                   b"/\x01", b"/%7f", b"/%c0%af", b"*", b"http://localhost/healthz")
        for target in targets:
            self.refused(b"GET " + target + b" HTTP/1.1\r\n" + HOST + b"\r\n", 400)

    def test_paths_are_routed_exactly(self):
        for path in (b"/healthz/", b"//healthz", b"/./healthz", b"/shapes/../healthz", b"/HEALTHZ", b"/healthz%2f",
                     b"/shapes/%2e%2e", b"/app.js", b"/page/../page/app.js", b"/../../etc/passwd"):
            self.answered(b"GET " + path + b" HTTP/1.1\r\n" + HOST + b"\r\n", 404)

    def test_other_methods_are_405_and_name_those_allowed(self):
        for method in ("TRACE", "CONNECT", "FOO", "PUT", "GETGETGET", "get"):
            for path in ("/", "/healthz", "/metrics", "/shapes"):
                status, headers, _ = self.daemon.request(method, path)
                self.assertEqual(status, 405, (method, path))
                self.assertIn("GET", headers["allow"])
                self.assertIn("OPTIONS", headers["allow"])

    def test_other_versions_are_refused(self):
        self.refused(b"GET /healthz HTTP/2.0\r\n" + HOST + b"\r\n", 505)
        self.refused_by_libmicrohttpd(b"GET /healthz HTTP/1.1\r\n\r\n", 400)

    def test_heads_past_the_limits_are_refused(self):
        self.refused(b"GET /" + b"a" * 200000 + b" HTTP/1.1\r\n" + HOST + b"\r\n", 414)
        self.refused(GET + HOST + b"X: " + b"a" * 200000 + b"\r\n\r\n", 431)
        self.refused(GET + HOST + b"X: y\r\n" * 200 + b"\r\n", 431)
        self.refused(b"GET /?" + b"&".join([b"a"] * 5000) + b" HTTP/1.1\r\n" + HOST + b"\r\n", 400)

    def test_pipelined_requests_are_answered_in_order(self):
        volume = blob(1)
        self.answered(NEXT + upload(volume) + b"GET /none HTTP/1.1\r\n" + HOST + b"\r\n" , 200, 200, 404)

    def test_a_chunked_volume_is_read(self):
        volume = blob(1)
        for size in (1, 7, 100000):
            self.answered(POST + b"Transfer-Encoding: chunked\r\n\r\n" + chunked(volume, size), 200)

    def test_trailers_change_nothing(self):
        body = chunked(blob(1))[:-2] + b"Content-Length: 9\r\nHost: evil\r\nAuthorization: Bearer x\r\n\r\n"
        self.answered(POST + b"Transfer-Encoding: chunked\r\n\r\n" + body, 200)

    def test_a_body_on_get_is_read_past(self):
        self.answered(upload(b"GET /none HTTP/1.1\r\n\r\n", b"GET", b"/healthz"), 200)

    def test_a_refusal_in_mid_body_arrives_and_leaves_the_connection_usable(self):
        self.answered(upload(b"not a volume" * 100000), 415)
        self.answered(POST + b"Transfer-Encoding: chunked\r\n\r\n" + chunked(b"not a volume" * 10000), 415)

    def test_a_refusal_by_the_head_arrives_and_leaves_the_connection_usable(self):
        self.answered(upload(b"x" * 1000000, path=b"/none"), 404)
        self.answered(upload(b"x" * 1000000, path=b"/recognize?limit=zero"), 400)
        self.answered(upload(b"x" * 1000000, b"PUT", b"/shapes"), 405)

    def test_a_declared_body_over_the_limit_is_refused_at_once(self):
        self.refused(POST + b"Content-Length: 100000000\r\n\r\n" + b"x" * 1000, 413)

    def test_a_chunked_body_over_the_limit_is_refused(self):
        volume = nifti((256, 256, 256), bytes(256**3))
        self.answered(POST + b"Transfer-Encoding: chunked\r\n\r\n" + chunked(volume, 1 << 16), 413)

    def test_expect_continue_is_answered_before_the_body(self):
        volume = blob(1)
        head = POST + b"Expect: 100-continue\r\nContent-Length: "
        self.answered(head + b"%d\r\n\r\n" % len(volume) + volume, 100, 200)
        self.refused(head + b"100000000\r\n\r\n", 413)
        self.refused(head.replace(b"/recognize", b"/none") + b"5\r\n\r\n", 404)

    def test_http_1_0_is_served_and_closed(self):
        self.assertEqual(self.daemon.raw(b"GET /healthz HTTP/1.0\r\n" + HOST + b"\r\n"), ([200], True))

    def test_head_has_the_headers_of_get_and_no_body(self):
        for path in ("/", "/healthz", "/shapes", "/none"):
            got, head = self.daemon.get(path), self.daemon.request("HEAD", path)
            self.assertEqual((got[0], got[1]["content-length"], got[1]["content-type"]),
                             (head[0], head[1]["content-length"], head[1]["content-type"]))
            self.assertFalse(head[2])


if __name__ == "__main__":
    unittest.main()
