"""A real browser, and `mocapd calibrate` to open in it."""

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, ConsoleMessage, Page, sync_playwright

from mocapd.config.web_params import Params
from mocapd.web.server import WebServer
from tests.conftest import environment
from tests.web.tiny_host import TinyHost

_NAMES = ("chromium", "chromium-browser", "google-chrome")
FOR_THE_DOCS = "MOCAPD_SCREENSHOTS" in os.environ  # pictures show what users see, and take time
PATIENCE_MS = 240_000  # of a step in a page: this machine may be busy
# Pictures are asked for as fast as the browser draws: two a second take less than the fifteen that the page may ask for.
DRAWN_SLOWLY = (
    "window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 500)"
)
PAGE_URL = re.compile(r"http://127\.0\.0\.1:\d+/\?token=\S+")


@pytest.fixture(scope="module")  # its event loop must be gone before other tests run theirs
def browser() -> Iterator[Browser]:
    """Debian's Chromium; skips where there is none, unless MOCAPD_REQUIRE_BROWSER is set (.ci/run)."""
    path = next((found for name in _NAMES if (found := shutil.which(name))), None)
    if path is None:
        if os.environ.get("MOCAPD_REQUIRE_BROWSER"):
            pytest.fail("no browser: apt install chromium")
        pytest.skip("no Chromium on this machine")
    root = hasattr(os, "geteuid") and os.geteuid() == 0
    with sync_playwright() as driver:
        browser = driver.chromium.launch(
            executable_path=path, args=["--no-sandbox"] if root else []
        )
        monkeypatched = pytest.MonkeyPatch()
        for name in ("new_page", "new_context"):
            monkeypatched.setattr(browser, name, _patient(getattr(browser, name)))
        yield browser
        browser.close()


def _patient(make: Callable[..., Any]) -> Callable[..., Any]:
    """`make` a page or a context whose steps may take as long as a busy machine needs."""

    def made(*args: Any, **kwargs: Any) -> Any:
        one = make(*args, **kwargs)
        one.set_default_timeout(PATIENCE_MS)
        return one

    return made


class Served:
    """`mocapd calibrate --demo` in a process of its own, up to the URL that it prints."""

    def __init__(self, state_dir: Path, env: dict[str, str], *options: str) -> None:
        self.state_dir = state_dir
        command = [sys.executable, "-m", "mocapd.cli.main", "calibrate", "--demo", "--no-browser"]
        command += ["--state-dir", str(state_dir), *options]
        self.process = subprocess.Popen(
            command, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        self.log: list[str] = []
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.log.append(line)
            found = PAGE_URL.search(line)
            if found:
                self.url = found.group()
                return
        pytest.fail(f"no URL was printed:\n{''.join(self.log)}")

    def stop(self) -> int:
        """As systemd ends it; its exit code. Prints its log, which a test that fails shows."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        assert self.process.stdout is not None
        self.log.extend(self.process.stdout)
        self.process.wait(timeout=120)
        print("".join(self.log))
        return self.process.returncode


@pytest.fixture(scope="module")
def user_env(tmp_path_factory: pytest.TempPathFactory, cache_home: Path) -> dict[str, str]:
    """`clean_env` for a whole file."""
    return environment(tmp_path_factory.mktemp("user"), cache_home)


@pytest.fixture(scope="session")
def pictures(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where screenshots are kept: MOCAPD_SCREENSHOTS, for the docs, else a folder that is forgotten."""
    given = os.environ.get("MOCAPD_SCREENSHOTS")
    folder = Path(given) if given else tmp_path_factory.mktemp("screenshots")
    folder.mkdir(parents=True, exist_ok=True)
    return folder


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> TinyHost:
    """Of a whole file."""
    return TinyHost(tmp_path_factory.mktemp("state"))


@pytest.fixture(scope="module")
def server(host: TinyHost) -> Iterator[WebServer]:
    """The page of `host`."""
    died: list[BaseException] = []
    with WebServer(host, Params(), died.append) as one:
        yield one
    host.stop()
    assert died == []


def problems_of(page: Page) -> list[str]:
    """What the browser itself complains of, as it comes: errors of scripts, refusals by the CSP; not of a picture that a step
    has replaced before a busy browser asked for it."""
    heard: list[str] = []
    page.on("pageerror", lambda error: heard.append(str(error)))

    def hear(message: ConsoleMessage) -> None:
        is_old_picture = "404" in message.text and "/picture/" in message.location["url"]
        if message.type == "error" and not is_old_picture:
            heard.append(message.text)

    page.on("console", hear)
    return heard
