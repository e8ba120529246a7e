"""The live view of a running daemon in a real browser, and who is let in."""

import re
import signal
import subprocess
import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import ClassVar
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.conftest import FOR_THE_DOCS, PAGE_URL, problems_of
from tests.cli.mocapd_process import mocapd, start
from tests.outputs.frames import free_port

WAIT_MS = 600_000


@pytest.fixture(scope="module")
def runtime_dir(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("runtime")


@pytest.fixture(scope="module")
def url(user_env: dict[str, str], runtime_dir: Path, simulated: str) -> Iterator[str]:
    """Of a daemon on simulated webcams, told by the `mocapd calibrate` that attaches to it."""
    # what is seen and tracked matters to the docs' picture only
    words = ("demo",) if FOR_THE_DOCS else ("run", "--capture", simulated, "--tracker", "canned")
    env = user_env | {"XDG_RUNTIME_DIR": str(runtime_dir)}
    outputs = ("--set", f"zenoh.port={free_port()}", "--set", "osc.enabled=false")
    process = start(env, *words, *outputs)
    try:
        wait_for_page(process)
        told = mocapd(env, "calibrate", "--no-browser")
        found = PAGE_URL.search(told.out)
        assert found, told.out + told.err
        yield found.group().partition("#")[0]
    finally:
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=120)


def wait_for_page(process: "subprocess.Popen[str]") -> None:
    """Until its log says that there is a page."""
    log = []
    assert process.stderr is not None
    for line in process.stderr:
        log.append(line)
        if "opens the page" in line:
            threading.Thread(target=process.stderr.read, daemon=True).start()
            return
    pytest.fail("the daemon ended:\n" + "".join(log))


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """A window of its own, with no cookie."""
    with browser.new_context(viewport={"width": 1100, "height": 800}) as context:
        yield context.new_page()


def test_the_live_view_shows_cameras_body_rate_and_listeners(
    page: Page, url: str, pictures: Path
) -> None:
    heard = problems_of(page)
    page.goto(f"{url}#live")
    expect(page.locator("#tracking")).to_have_text("Tracking", timeout=WAIT_MS)
    expect(page.locator("#live camera-picture")).to_have_count(2)
    expect(page.locator("#live-cameras")).to_contain_text("live")
    expect(page.locator("#live-outputs")).to_contain_text("zenoh")
    if FOR_THE_DOCS:  # as it is for most of its life: all is prepared, and the plots have a minute
        expect(page.locator("#preparing")).to_be_hidden(timeout=300_000)
    page.wait_for_timeout(65_000 if FOR_THE_DOCS else 500)
    page.screenshot(path=pictures / "live.jpg", full_page=True, quality=80)
    assert heard == []
    assert "token" not in page.url, "a token in the address bar ends up in screenshots"
    turned_by_the_keyboard(page)
    nothing_is_cut_off(page)


def turned_by_the_keyboard(page: Page) -> None:
    """The figure of the live view."""
    figure = page.locator(".figure-3d canvas")
    figure.focus()
    before = figure.screenshot()
    for _ in range(6):
        page.keyboard.press("ArrowLeft")
    page.wait_for_timeout(500)
    assert figure.screenshot() != before


def nothing_is_cut_off(page: Page) -> None:
    """At the width of a phone."""
    page.set_viewport_size({"width": 360, "height": 740})
    page.wait_for_timeout(200)
    assert page.evaluate("document.documentElement.scrollWidth") <= 360


def test_the_file_leads_the_browser_to_the_setup(page: Page, url: str, runtime_dir: Path) -> None:
    heard = problems_of(page)
    (file,) = runtime_dir.glob("mocapd/page-*.html")
    page.goto(file.as_uri())
    page.locator("#setup h1").first.wait_for(timeout=WAIT_MS)
    expect(page.locator("#connection")).to_have_text("Connected", timeout=WAIT_MS)
    assert page.url.startswith(url.partition("?")[0])
    assert page.url.endswith("#setup")
    assert "token" not in page.url
    assert page.evaluate("document.referrer") == ""
    page.reload()  # by its cookie
    expect(page.locator("#connection")).to_have_text("Connected", timeout=WAIT_MS)
    assert heard == []
    nothing_is_cut_off(page)


@pytest.mark.parametrize("token", ["?token=wrong", ""])
def test_a_wrong_token_is_refused(page: Page, url: str, token: str) -> None:
    answer = page.goto(url.partition("?")[0] + token)
    assert answer is not None
    assert answer.status in (401, 403)
    assert "mocapd calibrate" in page.inner_text("body"), "it says where the right one is"
    assert page.locator("camera-picture").count() == 0


class Foreign(SimpleHTTPRequestHandler):
    """`cookies`: what it was sent, of each page."""

    cookies: ClassVar[list[str | None]] = []

    def do_GET(self) -> None:
        if self.path == "/":
            self.cookies.append(self.headers["Cookie"])
        super().do_GET()


def test_a_foreign_page_gets_nothing_even_with_the_cookie(
    page: Page, url: str, tmp_path: Path
) -> None:
    page.goto(url)
    page.locator("h1").first.wait_for(timeout=WAIT_MS)
    (tmp_path / "index.html").write_text("<!doctype html><title>foreign</title>", encoding="utf-8")
    handler = partial(Foreign, directory=str(tmp_path))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as foreign:
        threading.Thread(target=foreign.serve_forever, daemon=True).start()
        page.goto(f"http://127.0.0.1:{foreign.server_port}/")
        assert Foreign.cookies == [None], "cookies are for all ports of this machine"
        host = urlsplit(url).netloc
        for path in ("/ws", "/pictures", "/live"):
            opened = page.evaluate(
                """([host, path]) => new Promise((told) => {
                    const socket = new WebSocket(`ws://${host}${path}`);
                    socket.onopen = () => told(true);
                    socket.onerror = () => told(false);
                })""",
                [host, path],
            )
            assert opened is False, path
        read = page.evaluate(
            """(host) => fetch(`http://${host}/status`, { credentials: "include" })
                .then(() => true, () => false)""",
            host,
        )
        assert read is False
        foreign.shutdown()


def test_a_second_browser_looks_on_until_it_takes_over(
    page: Page, browser: Browser, url: str
) -> None:
    page.goto(f"{url}#setup")
    page.locator("#step-title").wait_for(timeout=WAIT_MS)
    with browser.new_context() as context:
        second = context.new_page()
        second.goto(f"{url}#setup")
        expect(second.locator("#notice")).to_contain_text("Another window", timeout=WAIT_MS)
        expect(second.locator("#again")).to_be_disabled()
        second.click("#take-over")
        expect(second.locator("#again")).to_be_enabled(timeout=WAIT_MS)
        expect(page.locator("#notice")).to_contain_text("Another window", timeout=WAIT_MS)
        assert re.fullmatch(r"\S+", second.locator("#step-title").inner_text())


def test_a_connection_that_is_never_answered_is_tried_again(page: Page, url: str) -> None:
    page.add_init_script(
        """const Real = window.WebSocket;
        let tried = 0;
        window.WebSocket = class extends EventTarget {
          static OPEN = Real.OPEN;
          constructor(url) {
            super();
            if (String(url).endsWith("/ws") && tried++ === 0) this.readyState = Real.CONNECTING;
            else return new Real(url);
          }
          close() { this.dispatchEvent(new CloseEvent("close")); }
        };"""
    )
    page.clock.install()
    page.goto(f"{url}#setup")
    expect(page.locator("#connection")).to_have_text("Connecting", timeout=WAIT_MS)
    page.clock.fast_forward(11_000)
    expect(page.locator("#connection")).not_to_have_text("Connecting", timeout=WAIT_MS)
    page.clock.fast_forward(1_000)
    page.locator("#step-title").wait_for(timeout=WAIT_MS)
