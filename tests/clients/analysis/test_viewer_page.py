"""The viewer in a real browser: it draws, it obeys, and it asks nobody else for anything."""

import importlib.util
import os

import numpy as np
import pytest
from playwright.sync_api import Browser, expect

from mocapd_analysis.measures import measure
from tests.clients.analysis.motions import session, times, turning_arm
from tests.outputs.frames import eventually

if importlib.util.find_spec("viser") is None:
    if os.environ.get("MOCAPD_REQUIRE_CLIENTS"):
        pytest.fail("viser is not installed: pip install 'viser>=1.1,<2'")
    pytest.skip("viser is not installed", allow_module_level=True)

from mocapd_analysis.viewer.moment import Moment
from mocapd_analysis.viewer.page import ViewerPage

SOON_MS = 120_000  # of a busy machine without a graphics card
T = times(6.0, 30.0)
A = measure(session(T, turning_arm(T, "left", 1.2 - np.cos(4.0 * T))))
B = measure(session(T, turning_arm(T, "right", 1.2 - np.cos(3.0 * T + 1.0))))


def test_two_sessions_in_the_browser(browser: Browser) -> None:
    viewer = ViewerPage(0, "Motion analysis")
    try:
        viewer.tick(Moment((A, B), "two of them"), 0.5)
        assert viewer.playback.at_s == pytest.approx(0.5)
        assert viewer.playback.end_s == pytest.approx(6.0)
        asked: list[str] = []
        page = browser.new_page(viewport={"width": 900, "height": 500})
        page.set_default_timeout(SOON_MS)
        page.on("request", lambda request: asked.append(request.url))
        page.goto(viewer.url)
        expect(page.get_by_text("two of them")).to_be_visible(timeout=SOON_MS)
        expect(page.locator("canvas").first).to_be_visible(timeout=SOON_MS)
        page.get_by_role("button", name="Pause").dispatch_event("click")
        assert eventually(lambda: not viewer.playback.playing)
        at_s = viewer.playback.at_s
        viewer.tick(Moment((A, B)), 1.0)
        assert viewer.playback.at_s == at_s
        expect(page.get_by_role("button", name="Play")).to_be_visible(timeout=SOON_MS)
        outside = [one for one in asked if not one.startswith(("data:", "blob:", viewer.url))]
        assert outside == []
        page.close()
    finally:
        viewer.stop()


def test_the_page_survives_nobody_and_a_session_that_grows() -> None:
    viewer = ViewerPage(0, "live")
    try:
        viewer.tick(Moment((), "waiting", is_live=True), 0.1)
        viewer.tick(Moment((A,), "live", is_live=True), 0.1)
        assert viewer.playback.at_s == pytest.approx(6.0)  # live shows the newest
        longer_s = times(7.0, 30.0)
        longer = measure(
            session(longer_s, turning_arm(longer_s, "left", 1.2 - np.cos(4 * longer_s)))
        )
        viewer.tick(Moment((longer,), "live", is_live=True), 0.1)
        assert viewer.playback.at_s == pytest.approx(7.0)
    finally:
        viewer.stop()
