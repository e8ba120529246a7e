"""The pictures of the analyst in the docs: `python -m tests.clients.analysis.make_pictures FOLDER`.

Two simulated sessions side by side in the viewer, and the report of one, in Debian's Chromium.
"""

import shutil
import sys
import tempfile
import threading
from pathlib import Path

from playwright.sync_api import Browser, sync_playwright

from mocapd_analysis.measures import Measures, measure
from mocapd_analysis.report import report_html
from mocapd_analysis.viewer.moment import Moment
from mocapd_analysis.viewer.page import ViewerPage, run
from tests.clients.analysis.simulated import simulated_session

SIZE = {"width": 1280, "height": 760}
# WebGL without a graphics card
GL = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def main(folder: Path) -> None:
    """Write both pictures."""
    folder.mkdir(parents=True, exist_ok=True)
    sessions = tuple(measure(simulated_session(name, 24.0)) for name in ("living_room", "gym_mono"))
    chromium = shutil.which("chromium")
    assert chromium is not None, "apt install chromium"
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium, args=GL)
        try:
            _report(browser, sessions[0], folder / "report.png")
            _viewer(browser, sessions, folder / "viewer.png")
        finally:
            browser.close()


def _report(browser: Browser, found: Measures, path: Path) -> None:
    with tempfile.TemporaryDirectory() as scratch:
        html = Path(scratch) / "report.html"
        html.write_text(report_html([found]))
        page = browser.new_page(viewport={"width": 1000, "height": 1500})
        page.goto(html.as_uri())
        page.screenshot(path=path)
        page.close()


def _viewer(browser: Browser, sessions: tuple[Measures, ...], path: Path) -> None:
    viewer = ViewerPage(0, "Motion analysis")
    over = threading.Event()
    moment = Moment(sessions)
    thread = threading.Thread(target=run, args=(viewer, lambda: moment, over.is_set))
    thread.start()
    try:
        page = browser.new_page(viewport=SIZE)  # type: ignore[arg-type]
        page.goto(viewer.url)
        page.get_by_text("Frame", exact=True).wait_for(timeout=120_000)
        swing = sessions[0].best_swing
        viewer.playback.playing = False
        viewer.playback.seek(swing.at_s if swing is not None else 5.0)
        page.wait_for_timeout(8_000)
        # a machine without a graphics card is told so, over the picture
        for close in page.locator(".mantine-Notification-closeButton").all():
            close.click()
        page.wait_for_timeout(2_000)
        page.screenshot(path=path, timeout=120_000)
        page.close()
    finally:
        over.set()
        thread.join()
        viewer.stop()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
