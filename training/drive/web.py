"""A page on the loopback interface, served by the standard library.

`/` is the page, `/about` what does not change, `/frames` a stream of server-sent events with what
does, and what the page wants is posted to `/wishes`.  There is no password: whoever reaches the
port drives.  So that no other page of the same browser does, a request must name this server as
its host, and a post must come from this page.
"""

import json
import socket
import threading
import time
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from typing import Any
from urllib.parse import urlsplit

from ...models.errors import OptionError

LOOPBACK = ("127.0.0.1", "localhost", "::1")
FILES = {
    "/": ("page.html", "text/html"),
    "/page.css": ("page.css", "text/css"),
    "/view.js": ("view.js", "text/javascript"),
    "/panel.js": ("panel.js", "text/javascript"),
}
"""What is served as it is."""
LARGEST = 10_000
"""Bytes of what is posted."""
PATIENCE = 1.0
"""How long a page may wait for a frame before it is asked whether it is still there [s]."""


class Server(ThreadingHTTPServer):
    """Serves the page and hands over what it posts.

    Parameters
    ----------
    host, port
        Where to listen; port 0 is any that is free.
    about
        What does not change.
    hear
        Is given what a page posts, and raises an `OptionError` of what it cannot use.

    Raises
    ------
    OptionError
        The port is in use, or the address is not this machine's.
    """

    daemon_threads = True
    allow_reuse_address = True

    def __init__(
        self, host: str, port: int, about: dict[str, Any], hear: Callable[[dict[str, Any]], None]
    ) -> None:
        self.about, self.hear, self.host = json.dumps(about).encode(), hear, host
        self._frame, self._number = b"", 0
        self._news = threading.Condition()
        self.pages = 0
        """Number of pages that are open."""
        self.last_seen = time.monotonic()
        """When a page was last there [s]."""
        self.closing = False
        self.address_family = socket.AF_INET6 if ":" in host else socket.AF_INET
        try:
            super().__init__((host, port), Handler)
        except OSError as error:
            busy = f"port {port} of {host} is in use; take another --port, or 0 for any free one"
            wrong = f"--host is {host}, which is no address of this machine; take 127.0.0.1"
            refused = f"port {port} may not be taken: {error.strerror}; take one above 1023"
            text = {98: busy, 48: busy, 10048: busy, 13: refused}.get(error.errno or 0, wrong)
            raise OptionError(text) from None
        except OverflowError:
            raise OptionError(f"--port is {port}, it must be from 0 to 65535") from None

    @property
    def url(self) -> str:
        """Where the page is."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{self.server_address[1]}/"

    def show(self, frame: dict[str, Any]) -> None:
        """Send a frame to all pages."""
        text = json.dumps(frame).encode()
        with self._news:
            self._frame, self._number = text, self._number + 1
            self._news.notify_all()

    def next_frame(self, after: int) -> tuple[int, bytes]:
        """The newest frame and its number, once there is one after a number; or the same again."""
        with self._news:
            self._news.wait_for(lambda: self._number > after or self.closing, PATIENCE)
            return self._number, self._frame

    def count(self, change: int) -> None:
        """A page comes or goes."""
        with self._news:
            self.pages += change
            self.last_seen = time.monotonic()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A page that goes away in the middle of an answer is no error."""


class Handler(BaseHTTPRequestHandler):
    """Answers one page."""

    server: Server
    protocol_version = "HTTP/1.1"

    def do_GET(self) -> None:
        """Give what stands there."""
        path = urlsplit(self.path).path
        if not self._is_for_us():
            self._answer(403, b"wrong host", "text/plain")
        elif path in FILES:
            name, kind = FILES[path]
            self._answer(200, files(__package__).joinpath(name).read_bytes(), kind)
        elif path == "/about":
            self._answer(200, self.server.about, "application/json")
        elif path == "/frames":
            self._stream()
        else:
            self._answer(404, b"nothing here", "text/plain")

    def do_POST(self) -> None:
        """Take what the page wants."""
        length = self.headers.get("Content-Length", "")
        size = int(length) if length.isdigit() else LARGEST + 1
        if not self._is_for_us() or not self._is_from_us() or size > LARGEST:
            self.close_connection = True
            self._answer(403, b"not from this page", "text/plain")
            return
        try:
            wanted = json.loads(self.rfile.read(size))
            if urlsplit(self.path).path != "/wishes" or not isinstance(wanted, dict):
                raise OptionError("post a JSON object to /wishes")
            self.server.hear(wanted)
        except (OptionError, ValueError, RecursionError) as error:
            self._answer(400, str(error).encode(), "text/plain")
            return
        self._answer(200, b"{}", "application/json")

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing."""

    def _is_for_us(self) -> bool:
        """Whether the address that was typed is ours, not one that another site points here."""
        if self.server.host not in LOOPBACK:
            return True
        host = urlsplit(f"//{self.headers.get('Host', '')}").hostname
        return host in LOOPBACK

    def _is_from_us(self) -> bool:
        """Whether a post comes from our page or from no page, and not from another one."""
        origin = self.headers.get("Origin")
        return origin is None or urlsplit(origin).netloc == self.headers.get("Host")

    def _stream(self) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "text/event-stream")
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.close_connection = True
        self.server.count(1)
        number = 0
        try:
            while not self.server.closing:
                newest, frame = self.server.next_frame(number)
                fresh = newest > number
                self.wfile.write(b"data: " + frame + b"\n\n" if fresh else b": still here\n\n")
                number = newest
        except OSError:  # the page is gone
            pass
        finally:
            self.server.count(-1)

    def _answer(self, status: int, body: bytes, kind: str) -> None:
        self.send_response(status)
        self.send_header("Content-Type", f"{kind}; charset=utf-8")
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(body)
