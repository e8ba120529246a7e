"""The live view as a control room, in a real browser on a host without daemon."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, ViewportSize, expect

from mocapd.config.web_params import Params
from mocapd.pipeline.slowness import Slowness
from mocapd.web.server import WebServer
from tests.browser.conftest import problems_of
from tests.web.tiny_host import TinyHost

WAIT_MS = 120_000
SIZES: dict[str, ViewportSize] = {
    "desk": {"width": 1280, "height": 657},
    "phone": {"width": 390, "height": 844},
}


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> TinyHost:
    return TinyHost(tmp_path_factory.mktemp("state"))


@pytest.fixture(scope="module")
def server(host: TinyHost) -> Iterator[WebServer]:
    died: list[BaseException] = []
    with WebServer(host, Params(), died.append) as one:
        yield one
    host.stop()
    assert died == []


@pytest.fixture
def page(browser: Browser, server: WebServer) -> Iterator[Page]:
    with browser.new_context(viewport={"width": 1280, "height": 657}) as context:
        one = context.new_page()
        heard = problems_of(one)
        one.goto(f"{server.url}#live")
        expect(one.locator("#tracking")).to_have_text("Tracking", timeout=WAIT_MS)
        yield one
        assert heard == []


def show_pictures(host: TinyHost) -> None:
    """Of both cameras."""
    for camera in ("cam0", "cam1"):
        host.show(camera, 120)


def test_figure_and_listeners_read_well(page: Page, host: TinyHost, pictures: Path) -> None:
    show_pictures(host)
    expect(page.locator("#live-outputs")).to_contain_text("Not sent", timeout=WAIT_MS)
    expect(page.locator("#live-outputs")).not_to_contain_text("Refused")
    page.wait_for_timeout(800)
    for name, size in SIZES.items():
        page.set_viewport_size(size)
        page.wait_for_timeout(700)
        page.screenshot(path=pictures / f"live-{name}.png")


def test_a_machine_that_is_too_slow_is_said_with_what_helps(
    page: Page, host: TinyHost, pictures: Path
) -> None:
    host.slowness = Slowness(0.95, 1.5, 30.0, 640.0, 0.6)
    try:
        told = page.locator("#tracking")
        expect(told).to_contain_text("Too slow: 95 % of the frame sets", timeout=WAIT_MS)
        expect(told).to_contain_text("other programs use 60 %")
        expect(told).to_contain_text("close other programs")
        expect(told).to_have_class("state failed")
        page.screenshot(path=pictures / "live-slow.png")
    finally:
        host.slowness = None
