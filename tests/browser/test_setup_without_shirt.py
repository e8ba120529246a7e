"""The setup of somebody who has no shirt, in a real browser, on simulated webcams.

It is not marked as long: begun beside `test_setup.py` it would compile and draw the same, and wait for its films.
"""

import tomllib
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, expect

from tests.browser.conftest import Served, problems_of
from tests.browser.test_setup import STATURE_CM, STEP_MS, done, shown


@pytest.fixture
def served(tmp_path_factory: pytest.TempPathFactory, user_env: dict[str, str]) -> Iterator[Served]:
    served = Served(tmp_path_factory.mktemp("state"), user_env)
    yield served
    served.stop()


def test_whoever_has_no_shirt_is_led_past_it_and_is_tracked(
    served: Served, browser: Browser
) -> None:
    page = browser.new_page(viewport={"width": 1100, "height": 800})
    heard = problems_of(page)
    page.goto(served.url)
    shown(page, "cameras")
    expect(page.locator('[data-action="go-colour"]')).to_be_visible(timeout=STEP_MS)
    page.get_by_label("I have no shirt").check()
    expect(page.locator('[data-action="go-colour"]')).to_have_count(0, timeout=STEP_MS)
    expect(page.locator("#no-shirt-note")).to_contain_text("Two cameras or more")
    for step in ("cameras", "lens", "room"):
        shown(page, step)
        done(page)
        page.click("#next")
    shown(page, "body")
    page.fill("#stature-cm", str(STATURE_CM))
    page.keyboard.press("Enter")
    done(page)
    expect(page.locator("#sentence")).to_contain_text("with the shirt")
    page.click("#next")
    shown(page, "check")
    expect(page.locator("#sentence")).to_contain_text("Step out", timeout=STEP_MS)
    done(page)
    page.click("#save")
    page.locator("#saved-to").get_by_text("calibration.toml").wait_for(timeout=STEP_MS)
    page.close()
    code = served.stop()
    assert code == 0, "".join(served.log)
    saved = tomllib.loads((served.state_dir / "calibration.toml").read_text(encoding="utf-8"))
    assert saved["wearer"]["has_shirt"] is False
    assert "colour" not in saved["camera"][0]
    assert not heard
