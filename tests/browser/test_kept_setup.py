"""A setup whose process is killed: the next one offers it, and goes on when asked to.

That it may be begun anew instead, test_setup.py shows.
"""

import stat
from pathlib import Path

from playwright.sync_api import Browser, Page, expect

from mocapd.wizard.draft_file import FILE_NAME
from tests.browser.conftest import Served, problems_of

STEP_MS = 600_000


def body_step(page: Page) -> None:
    """Shown by its name in the list of steps."""
    page.click('[data-action="go-body"]')
    page.locator('[data-step="body"] #part > .part-body').wait_for(timeout=STEP_MS)


def form_asks_for_enough_squares(page: Page) -> None:
    """Of each kind of board, in the step Lens."""
    page.click("#board summary")
    for kind, fewest in (("chessboard", "4"), ("charuco", "3")):
        page.select_option("#board-kind", kind)
        for side in ("columns", "rows"):
            expect(page.locator(f"#board-{side}")).to_have_attribute("min", fewest)
            expect(page.locator(f"#board-{side}")).to_have_attribute("max", "100")


def form_knows_boards_of_two_sides(page: Page) -> None:
    """A plain chessboard looks the same from both and is not asked about."""
    page.select_option("#board-kind", "chessboard")
    expect(page.locator("#board-two-sided")).to_be_hidden()
    page.select_option("#board-kind", "charuco")
    page.check("#board-two-sided")
    page.click("#set-board")
    expect(page.locator("#board summary")).to_contain_text(", on both sides")
    expect(page.locator("#board-two-sided")).to_be_checked()


def test_a_setup_is_gone_on_with_after_a_kill(
    browser: Browser, tmp_path: Path, user_env: dict[str, str]
) -> None:
    page = browser.new_page()
    heard = problems_of(page)
    state_dir = tmp_path / "state"
    first = Served(state_dir, user_env)
    try:
        page.goto(first.url)
        expect(page.locator("#step-state")).to_have_text("Done", timeout=STEP_MS)
        expect(page.locator("#kept-setup")).to_be_hidden()
        body_step(page)
        page.fill("#stature-cm", "181")
        page.keyboard.press("Enter")
        expect(page.locator("#lengths")).to_be_visible(timeout=STEP_MS)
        kept = state_dir / FILE_NAME
        for _ in range(100):
            if kept.exists():
                break
            page.wait_for_timeout(50)
    finally:
        first.process.kill()
        first.process.wait()
    assert stat.S_IMODE(kept.stat().st_mode) == 0o600
    page.goto("about:blank")
    heard.clear()  # that the service has gone
    second = Served(state_dir, user_env)
    try:
        page.goto(second.url)
        expect(page.locator("#kept-setup")).to_contain_text("A setup from", timeout=STEP_MS)
        expect(page.locator("#kept-setup")).to_contain_text("Body")
        expect(page.locator("#next")).to_be_disabled()
        page.click("#resume")
        # the first step that was not done
        page.locator('[data-step="lens"] #part > .part-lens').wait_for(timeout=STEP_MS)
        form_asks_for_enough_squares(page)
        form_knows_boards_of_two_sides(page)
        body_step(page)
        expect(page.locator("#stature-cm")).to_have_value("181", timeout=STEP_MS)
        assert not heard
    finally:
        code = second.stop()
        page.close()
    assert code == 0, "".join(second.log)
