"""A small client of Chromium's DevTools, over two pipes: no driver to install, no port to open."""

from __future__ import annotations

import base64
import contextlib
import itertools
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
#: Seconds to wait for an answer; the machine may be busy.
PATIENCE = 120.0


def executable():
    """Path of the browser, None where there is none."""
    return next(filter(None, map(shutil.which, NAMES)), None)


class Browser:
    """A browser without a window, and one page in it.

    All requests but those of ``file:``, ``data:`` and ``blob:`` are refused and kept in
    ``requests``; what the console says of errors and warnings, in ``complaints``.
    """

    def __init__(self, *, webgl=True, width=1280, height=800, touch=False):
        self._numbers = itertools.count(1)
        self._buffer, self._events = b"", []
        self.requests, self.complaints = [], []
        self._profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_browser, self._to = os.pipe()
        self._from, from_browser = os.pipe()
        # Three dimensions by the processor, the page itself without them: that starts much faster.
        gl = [
            "--disable-gpu-compositing", "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist",
        ]  # fmt: skip
        arguments = [
            executable(), "--headless=new", "--no-sandbox", "--remote-debugging-pipe",
            "--no-first-run", "--disable-extensions", "--disable-dev-shm-usage",
            f"--user-data-dir={self._profile.name}",
            *(gl if webgl else ["--disable-gpu", "--disable-3d-apis"]),
        ]  # fmt: skip

        def pipes():  # the browser reads from 3 and writes to 4
            os.dup2(os.dup(to_browser), 13)
            os.dup2(os.dup(from_browser), 14)
            os.dup2(13, 3)
            os.dup2(14, 4)

        self._process = subprocess.Popen(
            arguments, preexec_fn=pipes, close_fds=False,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(to_browser)
        os.close(from_browser)
        target = self._ask("Target.createTarget", {"url": "about:blank"}, None)["targetId"]
        attached = {"targetId": target, "flatten": True}
        self._session = self._ask("Target.attachToTarget", attached, None)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self._ask(f"{domain}.enable")
        self._ask("Fetch.enable", {"patterns": [{"urlPattern": "*"}]})
        self.resize(width, height, touch=touch)

    def __enter__(self):
        return self

    def __exit__(self, *error):
        with contextlib.suppress(OSError):
            self._ask("Browser.close", session=None)
        try:
            self._process.wait(10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        os.close(self._to)
        os.close(self._from)
        self._profile.cleanup()

    def resize(self, width, height, *, touch=False):
        """Another size of the page, in its pixels."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": touch}
        self._ask("Emulation.setDeviceMetricsOverride", size)
        self._ask("Emulation.setTouchEmulationEnabled", {"enabled": touch})

    def open(self, path, ready="document.readyState === 'complete'"):
        """Open a file and wait until an expression is true; returns the seconds that took."""
        begun = time.monotonic()
        self._ask("Page.navigate", {"url": Path(path).resolve().as_uri()})
        self.wait(ready)
        return time.monotonic() - begun

    def wait(self, expression, seconds=PATIENCE):
        """Wait until an expression is true."""
        end = time.monotonic() + seconds
        while not self.run(f"Boolean({expression})"):
            if time.monotonic() > end:
                raise TimeoutError(f"{expression}: {self.complaints}")
            time.sleep(0.02)

    def run(self, expression):
        """Value of an expression in the page; promises are awaited."""
        asked = {"expression": expression, "awaitPromise": True, "returnByValue": True}
        answer = self._ask("Runtime.evaluate", asked)
        if "exceptionDetails" in answer:
            raise RuntimeError(json.dumps(answer["exceptionDetails"])[:2000])
        return answer["result"].get("value")

    def screenshot(self, path=None):
        """The page as it is seen, PNG."""
        picture = base64.b64decode(self._ask("Page.captureScreenshot")["data"])
        if path is not None:
            Path(path).write_bytes(picture)
        return picture

    def print_to_pdf(self, path=None):
        """The page as it is printed on A4."""
        options = {"printBackground": True, "preferCSSPageSize": True}
        pdf = base64.b64decode(self._ask("Page.printToPDF", options)["data"])
        if path is not None:
            Path(path).write_bytes(pdf)
        return pdf

    def click(self, x, y):
        """A click of the mouse."""
        self.mouse("mousePressed", x, y, buttons=1)
        self.mouse("mouseReleased", x, y)

    def mouse(self, kind, x, y, buttons=0):
        """One event of the mouse."""
        button = "none" if kind == "mouseMoved" and not buttons else "left"
        event = {"type": kind, "x": x, "y": y, "button": button, "buttons": buttons}
        self._ask("Input.dispatchMouseEvent", {**event, "clickCount": 1})

    def key(self, key):
        """Press and release a key, by its DOM name."""
        text = {"text": key} if len(key) == 1 else {}
        for kind in ("keyDown", "keyUp"):
            extra = text if kind == "keyDown" else {}
            self._ask("Input.dispatchKeyEvent", {"type": kind, "key": key, **extra})

    def _ask(self, method, params=None, session=...):
        number = next(self._numbers)
        message = {"id": number, "method": method, "params": params or {}}
        session = self._session if session is ... else session
        if session is not None:
            message["sessionId"] = session
        os.write(self._to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._read()
            if answer.get("id") == number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            if "method" in answer:
                self._note(answer)

    def _read(self):
        while b"\0" not in self._buffer:
            if not select.select([self._from], [], [], PATIENCE)[0]:
                raise TimeoutError("the browser does not answer")
            part = os.read(self._from, 1 << 20)
            if not part:
                raise OSError("the browser has ended")
            self._buffer += part
        message, _, self._buffer = self._buffer.partition(b"\0")
        return json.loads(message)

    def _note(self, event):
        """Keep what is told without having been asked for."""
        method, params = event["method"], event.get("params", {})
        if method == "Fetch.requestPaused":
            url, allowed = params["request"]["url"], ("file:", "data:", "blob:")
            answer = {"requestId": params["requestId"]}
            if url.startswith(allowed):
                self._send("Fetch.continueRequest", answer)
            else:
                self.requests.append(url)
                self._send("Fetch.failRequest", {**answer, "errorReason": "BlockedByClient"})
        elif method == "Network.requestWillBeSent":
            url = params["request"]["url"]
            if not url.startswith(("file:", "data:", "blob:", "about:")):
                self.requests.append(url)
        elif method == "Runtime.exceptionThrown":
            self.complaints.append(json.dumps(params["exceptionDetails"])[:2000])
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning"):
            self.complaints.append(json.dumps(params["args"])[:2000])
        elif method == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
            if params["entry"]["source"] == "rendering":
                return  # of a graphics card that is none: what it takes long for
            self.complaints.append(json.dumps(params["entry"])[:2000])

    def _send(self, method, params):
        """Ask without waiting for the answer, which is dropped as it comes."""
        message = {"id": next(self._numbers), "method": method, "params": params}
        os.write(self._to, json.dumps({**message, "sessionId": self._session}).encode() + b"\0")
