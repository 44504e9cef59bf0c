"""A headless Chromium that is driven through its DevTools protocol, with real input events."""

import base64
import json
import shutil
import subprocess
import time
import urllib.request
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from websockets.sync.client import connect

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
PATIENCE = 90.0
"""How long it may take to start or to answer [s]."""
OPTIONS = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader",
    "--disable-dev-shm-usage", "--disable-extensions", "--disable-background-networking",
    "--no-first-run", "--mute-audio", "--hide-scrollbars", "--remote-debugging-port=0",
    "--window-size=1180,720",
)  # fmt: skip


def executable() -> str | None:
    """Where Chromium is, if it is installed."""
    return next(filter(None, map(shutil.which, NAMES)), None)


class Chromium:
    """One page."""

    def __init__(self, folder: Path, url: str) -> None:
        command = [str(executable()), *OPTIONS, f"--user-data-dir={folder}", "about:blank"]
        self._process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        self._left_open = ExitStack()
        try:
            port = self._port(folder / "DevToolsActivePort")
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/json", timeout=PATIENCE) as page:
                pages = json.load(page)
            where = next(p["webSocketDebuggerUrl"] for p in pages if p["type"] == "page")
            open_socket = connect(where, max_size=None, open_timeout=PATIENCE)
            self._socket = self._left_open.enter_context(open_socket)
            self._number = 0
            self("Page.navigate", url=url)
        except BaseException:
            self.close()
            raise

    def __call__(self, method: str, **options: Any) -> dict[str, Any]:
        """Send one command; its result."""
        self._number += 1
        self._socket.send(json.dumps({"id": self._number, "method": method, "params": options}))
        while True:
            answer = json.loads(self._socket.recv(timeout=PATIENCE))
            if answer.get("id") == self._number:
                assert "error" not in answer, answer
                return answer["result"]

    def value(self, expression: str) -> Any:
        """What JavaScript makes of an expression."""
        found = self("Runtime.evaluate", expression=expression, returnByValue=True)
        return found["result"].get("value")

    def wait(self, expression: str) -> Any:
        """The same, once it is true."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            value = self.value(expression)
            if value:
                return value
            time.sleep(0.05)
        raise AssertionError(f"{expression} did not come true in {PATIENCE} s")

    def key(self, kind: str, code: str) -> None:
        """Press or release a key: kind "keyDown" or "keyUp"."""
        self("Input.dispatchKeyEvent", type=kind, code=code, key=code)

    def mouse(self, kind: str, x: float, y: float) -> None:
        """Press, move or release the left button."""
        self(
            "Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1
        )

    def middle(self, selector: str) -> tuple[float, float]:
        """The middle of an element."""
        box = f"document.querySelector({selector!r}).getBoundingClientRect()"
        x, y = self.value(f"(b => [b.x + b.width / 2, b.y + b.height / 2])({box})")
        return x, y

    def picture(self) -> bytes:
        """The page as PNG."""
        return base64.b64decode(self("Page.captureScreenshot", format="png")["data"])

    def close(self) -> None:
        """End it."""
        self._left_open.close()
        self._process.terminate()
        try:
            self._process.wait(10.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait(10.0)

    @staticmethod
    def _port(file: Path) -> int:
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            if file.exists() and file.read_text().count("\n"):
                return int(file.read_text().split("\n")[0])
            time.sleep(0.1)
        raise AssertionError("Chromium does not start")
