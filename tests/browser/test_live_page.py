"""The live view as a control room, in a real browser on a host without daemon."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, ViewportSize, expect

from mocapd.calibrate.bump.bump_watch import Mounting
from mocapd.clock import monotonic_ns
from mocapd.pipeline.slowness import Slowness
from mocapd.web.server import WebServer
from tests.browser.conftest import FOR_THE_DOCS, problems_of
from tests.clients.canned_daemon import canned_sample
from tests.web.tiny_host import TinyHost

WAIT_MS = 120_000
SIZES: dict[str, ViewportSize] = {
    "desk": {"width": 1280, "height": 657},
    "phone": {"width": 390, "height": 844},
}


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
    page.wait_for_timeout(800 if FOR_THE_DOCS else 100)
    for name, size in SIZES.items():
        page.set_viewport_size(size)
        page.wait_for_timeout(700 if FOR_THE_DOCS else 100)
        expect(page.locator("#to-setup")).to_be_in_viewport(ratio=1)
        if FOR_THE_DOCS:
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
        assert page.locator("#live").inner_text().count("close other programs") == 1
        page.screenshot(path=pictures / "live-slow.png")
    finally:
        host.slowness = None


def test_what_a_first_start_still_prepares_is_said_until_it_is_done(
    page: Page, host: TinyHost
) -> None:
    line = page.locator("#preparing")
    expect(line).to_be_hidden()
    host.preparing = "once on this machine: compiling 34 %; about 20 s left"
    try:
        expect(line).to_contain_text("compiling 34 %; about 20 s left", timeout=WAIT_MS)
    finally:
        host.preparing = ""
    expect(line).to_be_hidden(timeout=WAIT_MS)


def test_record_and_stop_and_what_was_recorded(page: Page, host: TinyHost, pictures: Path) -> None:
    show_pictures(host)
    page.click("#record")
    expect(page.locator("#recording-now")).to_contain_text("Recording 0:0", timeout=WAIT_MS)
    begin_ns = monotonic_ns()
    for i in range(30):
        host.bodies.put(canned_sample(host.skeleton, begin_ns + i * 33_000_000))
    page.click("#record")
    row = page.locator("#recordings .recording").first
    expect(row).to_contain_text("MB", timeout=WAIT_MS)
    row.get_by_placeholder("Name").fill("Penalty practice")
    row.get_by_placeholder("Notes").fill("second try, left hand")
    row.get_by_placeholder("Notes").press("Enter")
    with page.expect_download() as download:
        row.get_by_role("link", name="Download").click()
    assert download.value.suggested_filename.endswith(".mcap")
    with page.expect_download(timeout=WAIT_MS) as exported:
        row.get_by_role("combobox").select_option("csv")
    assert exported.value.suggested_filename == "Penalty-practice.csv"
    page.reload()
    expect(page.get_by_placeholder("Name")).to_have_value("Penalty practice", timeout=WAIT_MS)
    page.locator("#recordings").scroll_into_view_if_needed()
    page.screenshot(path=pictures / "live-recordings.png")


def test_recenter_mirror_and_full_screen(page: Page, host: TinyHost, pictures: Path) -> None:
    show_pictures(host)
    page.click("#recenter")
    page.wait_for_timeout(300)
    assert host.recentered == 1
    page.click("#mirror")
    expect(page.locator("#mirror")).to_have_attribute("aria-pressed", "true")
    turned = page.locator("#live camera-picture canvas").first
    assert turned.evaluate("canvas => getComputedStyle(canvas).transform").startswith("matrix(-1")
    page.click("#full-screen")
    page.wait_for_timeout(500)
    assert page.evaluate("document.fullscreenElement?.className") == "stage"
    show_pictures(host)
    figure = page.locator(".figure-3d canvas").bounding_box()
    assert figure is not None
    assert figure["height"] > 600, "it fills the screen's 657 px"
    for shown in page.locator("#live camera-picture").all():
        expect(shown).to_be_in_viewport(ratio=1)
    page.wait_for_timeout(400 if FOR_THE_DOCS else 50)
    page.screenshot(path=pictures / "live-full-screen.png")
    page.keyboard.press("Escape")


def test_a_camera_that_was_moved_is_said_with_the_way_to_mend_it(
    page: Page, host: TinyHost, pictures: Path
) -> None:
    expect(page.locator("#camera-moved")).to_be_hidden()
    host.mountings["cam0"] = Mounting.BUMPED
    try:
        expect(page.locator("#camera-moved")).to_contain_text("cam0 was moved", timeout=WAIT_MS)
        page.screenshot(path=pictures / "live-moved.png")
        page.click("#room-anew")
        page.wait_for_url("**/#setup", timeout=WAIT_MS)
        assert host.begun == 1
    finally:
        host.mountings.clear()
        host.stop()
        host.wizard = None


def test_it_is_dark_where_the_system_wants_it(
    browser: Browser, server: WebServer, host: TinyHost, pictures: Path
) -> None:
    size: ViewportSize = {"width": 1280, "height": 657}
    with browser.new_context(viewport=size, color_scheme="dark") as context:
        page = context.new_page()
        page.goto(f"{server.url}#live")
        expect(page.locator("#tracking")).to_have_text("Tracking", timeout=WAIT_MS)
        show_pictures(host)
        page.wait_for_timeout(700)
        page.screenshot(path=pictures / "live-dark.png")
        background = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert max(map(int, background.strip("rgb()").split(","))) < 60
