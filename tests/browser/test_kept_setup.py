"""A setup whose process is killed: the next one offers it, and goes on when asked to, by somebody who has no shirt.

That it may be begun anew instead, and how lenses and room are measured, test_setup.py shows.

It is not marked as long: begun beside test_setup.py it would compile and draw the same, and wait for its films.
"""

import stat
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
from playwright.sync_api import Browser, Page, expect

from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.sim.scenario import load_scenario
from mocapd.sim.world import rig_of
from mocapd.types import Camera
from mocapd.wizard.draft import ExtrinsicsQuality
from mocapd.wizard.setup_keeper import FILE_NAME, read_draft, write_draft
from mocapd.wizard.step_names import StepName
from tests.browser.conftest import DRAWN_SLOWLY, Served, problems_of
from tests.browser.test_setup import SCENARIO, STEP_MS, done, shown


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


def lens_of(camera: Camera) -> Intrinsics:
    """As eight views of a board would have told it."""
    known = np.ones(len(camera.dist), bool)
    return Intrinsics(
        camera.size_px, camera.K, camera.dist, known, 0.25, 0.3, tuple(range(8)), (), 0.001
    )


def measure_lenses_and_room(kept: Path) -> None:
    """Into an unfinished setup of the demo: the true ones."""
    unfinished, rig = read_draft(kept), rig_of(load_scenario(SCENARIO))
    draft = replace(
        unfinished.draft,
        board_views={},
        intrinsics={camera.name: lens_of(camera) for camera in rig.cameras},
        rig=rig,
        extrinsics_quality=ExtrinsicsQuality("board", 0.3, dict.fromkeys(rig.names, 0.3), 0.5),
        floor_known=True,
    )
    known = unfinished.done | {StepName.LENS, StepName.ROOM}
    write_draft(kept, replace(unfinished, draft=draft, done=known))


def begun_and_killed(page: Page, state_dir: Path, env: dict[str, str]) -> Path:
    """The file that is left of a setup in which the stature was told."""
    served = Served(state_dir, env)
    kept = state_dir / FILE_NAME
    try:
        page.goto(served.url)
        expect(page.locator("#step-state")).to_have_text("Done", timeout=STEP_MS)
        expect(page.locator("#kept-setup")).to_be_hidden()
        page.click("#next")
        shown(page, "lens")
        form_asks_for_enough_squares(page)
        form_knows_boards_of_two_sides(page)
        body_step(page)
        page.fill("#stature-cm", "181")
        page.keyboard.press("Enter")
        expect(page.locator("#lengths")).to_be_visible(timeout=STEP_MS)
        for _ in range(100):
            if kept.exists() and read_draft(kept).draft.stature_m == 1.81:
                break
            page.wait_for_timeout(50)
    finally:
        served.process.kill()
        served.process.wait()
    return kept


def lead_past_the_shirt(page: Page) -> None:
    """From the step Cameras to what is saved."""
    page.click('[data-action="go-cameras"]')
    shown(page, "cameras")
    expect(page.locator('[data-action="go-colour"]')).to_be_visible(timeout=STEP_MS)
    page.get_by_label("I have no shirt").check()
    expect(page.locator('[data-action="go-colour"]')).to_have_count(0, timeout=STEP_MS)
    expect(page.locator("#no-shirt-note")).to_contain_text("Two cameras or more")
    done(page)
    body_step(page)
    page.click("#back")
    shown(page, "room")  # whose next step is Body
    body_step(page)
    expect(page.locator("#stature-cm")).to_have_value("181", timeout=STEP_MS)
    done(page)
    expect(page.locator("#sentence")).to_contain_text("with the shirt")
    page.click("#next")
    shown(page, "check")
    expect(page.locator("#sentence")).to_contain_text("Step out", timeout=STEP_MS)
    done(page)
    page.click("#save")
    page.locator("#saved-to").get_by_text("calibration.toml").wait_for(timeout=STEP_MS)


def test_a_setup_is_gone_on_with_after_a_kill_and_without_a_shirt(
    browser: Browser, tmp_path: Path, user_env: dict[str, str]
) -> None:
    page = browser.new_page(viewport={"width": 1100, "height": 800})
    page.add_init_script(DRAWN_SLOWLY)
    heard = problems_of(page)
    state_dir = tmp_path / "state"
    kept = begun_and_killed(page, state_dir, user_env)
    assert stat.S_IMODE(kept.stat().st_mode) == 0o600
    measure_lenses_and_room(kept)
    page.goto("about:blank")
    heard.clear()  # that the service has gone
    second = Served(state_dir, user_env)
    try:
        page.goto(second.url)
        expect(page.locator("#kept-setup")).to_contain_text("A setup from", timeout=STEP_MS)
        expect(page.locator("#kept-setup")).to_contain_text("Body")
        expect(page.locator("#next")).to_be_disabled()
        page.click("#resume")
        shown(page, "colour")  # the first step that was not done
        body_step(page)
        expect(page.locator("#stature-cm")).to_have_value("181", timeout=STEP_MS)
        lead_past_the_shirt(page)
        assert not heard
    finally:
        page.close()
        code = second.stop()
    assert code == 0, "".join(second.log)
    saved = tomllib.loads((state_dir / "calibration.toml").read_text(encoding="utf-8"))
    assert saved["wearer"]["has_shirt"] is False
    assert saved["wearer"]["stature_m"] == 1.81
    assert "colour" not in saved["camera"][0]
