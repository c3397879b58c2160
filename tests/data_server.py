"""A server of public data on this machine: answers by path and query, and what it was asked for."""

import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from sgp4.api import Satrec
from sgp4.exporter import export_omm

MODIFIED = "Sat, 28 Nov 2026 08:00:00 GMT"


class DataServer:
    """Answers: status and bytes by path with query; requests: paths and headers; sent: what came."""

    def __init__(self, address):
        self.address, self.answers, self.requests, self.sent = address, {}, [], []

    def sets(self, query, text):
        """Answer a query of element sets."""
        self.answers[f"/NORAD/elements/gp.php?{query}&FORMAT=CSV"] = (200, text.encode())

    def asked(self):
        """Paths of all requests so far."""
        return [path for path, _ in self.requests]


@contextmanager
def serving(monkeypatch, folder):
    """Yield a server that `opml fetch` asks, its folder of data another one."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            known.requests.append((self.path, dict(self.headers)))
            status, body = known.answers.get(self.path, (404, b"no such file here"))
            if status == 200 and self.headers.get("If-Modified-Since") == MODIFIED:
                status, body = 304, b""
            self.send_response(status)
            if status == 200:
                self.send_header("Last-Modified", MODIFIED)
            self.end_headers()
            self.wfile.write(body)

        def do_POST(self):
            known.sent.append(self.rfile.read(int(self.headers["Content-Length"])).decode())
            self.do_GET()

        def log_message(self, *_):
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        known = DataServer(f"http://127.0.0.1:{server.server_address[1]}")
        threading.Thread(target=server.serve_forever, args=[0.01], daemon=True).start()
        monkeypatch.setenv("OPML_CELESTRAK", known.address)
        monkeypatch.setenv("OPML_SPACETRACK", f"{known.address}/")
        monkeypatch.setenv("OPML_IERS", f"{known.address}/finals2000A.all")
        monkeypatch.setenv("OPML_DATA", str(folder))
        try:
            yield known
        finally:
            server.shutdown()


def as_omms(lines, name="TEST"):
    """Lines of TLEs as the fields of OMMs."""
    return [_omm(*pair, name) for pair in zip(lines[::2], lines[1::2], strict=True)]


def as_csv(lines, name="TEST"):
    """Lines of TLEs as CelesTrak's CSV."""
    rows = as_omms(lines, name)
    keys = [
        key
        for key in rows[0]
        if key not in ("CENTER_NAME", "REF_FRAME", "TIME_SYSTEM", "MEAN_ELEMENT_THEORY")
    ]
    return "\n".join([",".join(keys), *(",".join(str(row[key]) for key in keys) for row in rows)]) + "\n"


def _omm(first, second, name):
    satellite = Satrec.twoline2rv(first, second)
    satellite.intldesg = "98067A"
    return export_omm(satellite, name)
