"""The whole setup in a real browser, by mouse and keyboard, on simulated webcams.

How long it takes is printed: `python -m pytest -s tests/browser -k whole`.
"""

import json
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

import cv2
import msgspec
import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

from mocapd.evaluate.score import JOINT_SETS
from mocapd.session.setup_demo import Demo
from mocapd.sim.film import load_film
from mocapd.sim.scenario import load_scenario
from mocapd.types import Bytes
from mocapd.wizard.draft import Draft, DraftCamera
from mocapd.wizard.setup_keeper import FILE_NAME, UnfinishedSetup, write_draft
from mocapd.wizard.step_names import StepName
from tests.browser.conftest import DRAWN_SLOWLY, FOR_THE_DOCS, Served, problems_of
from tests.conftest import ROOT
from tests.sim.kept_capture import kept_capture

pytestmark = pytest.mark.long

SCENARIO = ROOT / "calib" / "scenarios" / "first_setup.toml"
STATURE_CM = 172
STEP_MS = 600_000  # a busy machine compiles; the time of the whole is printed
"""How long a step may take before the test gives up [ms]."""


@dataclass
class Setup:
    """What one way through all steps left behind. seconds: by step; heard: what the browser said;
    forgotten: whether the setup of before was, when a new one was begun."""

    saved: Path
    seconds: dict[str, float] = field(default_factory=dict)
    heard: list[str] = field(default_factory=list)
    log: str = ""
    forgotten: bool = False


def shown(page: Page, step: str) -> None:
    """Wait until this step is shown."""
    page.locator(f'[data-step="{step}"] #part > .part-{step}').wait_for(timeout=STEP_MS)


def done(page: Page) -> None:
    """Wait until the step says that it is done."""
    expect(page.locator("#step-state")).to_have_text("Done", timeout=STEP_MS)


def draw(page: Page, camera: str, strokes: Bytes) -> None:
    """With the mouse: one line along each colour's largest stroke, its colour chosen by key."""
    canvas = page.locator(f"#canvas-{camera}")
    for _ in range(3):
        page.keyboard.press("[")  # a thin brush: the cuffs are small
    height, width = strokes.shape
    for colour in range(1, 11):
        count, parts, stats, _ = cv2.connectedComponentsWithStats(
            (strokes == colour).astype(np.uint8)
        )
        if count < 2:
            continue
        y, x = np.nonzero(parts == 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA])))
        page.keyboard.press(str(colour % 10))
        canvas.scroll_into_view_if_needed()
        box = canvas.bounding_box()
        assert box is not None
        line = [(x[i], y[i]) for i in np.argsort(x)[np.linspace(0, len(x) - 1, 5).astype(int)]]
        at = [(box["x"] + u * box["width"] / width, box["y"] + v * box["height"] / height)
              for u, v in line]  # fmt: skip
        page.mouse.move(*at[0])
        page.mouse.down()
        for point in at[1:]:
            page.mouse.move(*point)
        page.mouse.up()


def truth_strokes(camera: str, cache_home: Path) -> Bytes:
    """Where a careful user would draw, from the simulator's labels: of the film that the setup shows."""
    film = load_film(load_scenario(SCENARIO), cache_home / "mocapd")
    return film.setup.scribbles[camera].labels


def rms_after_turning_cm(capture: Path, track: Path) -> float:
    """RMS [cm] of the upper joints, after the turn and shift that fit all frames best (Kabsch)."""
    with np.load(capture / "truth.npz") as truth, np.load(track) as found:
        names = [str(name) for name in truth["names"]], [str(name) for name in found["joint_names"]]
        a, b = (
            data["joints"][:, [own.index(joint) for joint in JOINT_SETS["upper"]]]
            for data, own in zip((truth, found), names, strict=True)
        )
        rows = np.abs(truth["times"][:, None] - found["times"]).argmin(axis=0)
    settled = np.isfinite(b).all(axis=(1, 2))
    settled[: len(b) // 3] = False  # the tracker learns the wearer meanwhile
    assert settled.sum() > len(b) // 2
    p, q = b[settled].reshape(-1, 3), a[rows[settled]].reshape(-1, 3)
    p, q = p - p.mean(axis=0), q - q.mean(axis=0)
    U, _, Vt = np.linalg.svd(p.T @ q)
    R = U @ np.diag([1.0, 1.0, np.sign(np.linalg.det(U @ Vt))]) @ Vt
    return 100.0 * float(np.sqrt(np.mean(np.sum((p @ R - q) ** 2, axis=1))))


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory, user_env: dict[str, str]) -> Iterator[Served]:
    """The setup on simulated webcams, in a process of its own; another one before it was not finished."""
    state_dir = tmp_path_factory.mktemp("state")
    cameras = tuple(
        DraftCamera(one.name, Demo.source_of(one.name), one.size_px)
        for one in load_scenario(SCENARIO).cameras
    )
    draft = Draft(cameras=cameras, stature_m=1.81)
    unfinished = UnfinishedSetup(datetime.now(UTC), frozenset({StepName.BODY}), draft)
    write_draft(state_dir / FILE_NAME, unfinished)
    served = Served(state_dir, user_env)
    yield served
    served.stop()


@pytest.fixture(scope="module")
def page(browser: Browser, pictures: Path) -> Iterator[Page]:
    """A window; what it shows when something fails is kept."""
    page = browser.new_page(viewport={"width": 1100, "height": 800})
    if not FOR_THE_DOCS:
        page.add_init_script(DRAWN_SLOWLY)
    yield page
    if not page.is_closed():
        page.screenshot(path=pictures / "last.jpg", quality=80)
        page.close()


@pytest.fixture(scope="module")
def setup(served: Served, page: Page, pictures: Path, cache_home: Path) -> Setup:
    """One way through the whole setup; for the docs, screenshots of each step as it is done."""
    by_hand = truth_strokes("cam1", cache_home)
    out = Setup(served.state_dir / "calibration.toml", heard=problems_of(page))
    began = time.monotonic()

    def shoot(name: str) -> None:
        if not FOR_THE_DOCS:  # a browser without a graphics card takes a second for each
            return
        # else what stays in sight lies over the middle of the picture
        page.evaluate("scrollTo(0, 0)")
        page.wait_for_timeout(300)
        page.screenshot(path=pictures / f"setup_{name}.jpg", full_page=True, quality=80)

    def finished(step: str) -> None:
        nonlocal began
        now = time.monotonic()
        out.seconds[step], began = now - began, now

    page.goto(served.url)
    expect(page.locator("#kept-setup")).to_contain_text("A setup from", timeout=STEP_MS)
    page.locator("#begin-anew").click(timeout=STEP_MS)
    expect(page.locator("#kept-setup")).to_be_hidden(timeout=STEP_MS)
    out.forgotten = not (served.state_dir / FILE_NAME).exists()
    shown(page, "cameras")
    done(page)
    finished("cameras")
    shoot("cameras")
    page.click("#next")

    shown(page, "lens")
    if FOR_THE_DOCS:  # a picture of the step while views are collected
        page.wait_for_timeout(6000)
    shoot("lens")
    done(page)
    finished("lens")
    page.locator("#next").focus()
    page.keyboard.press("Enter")

    shown(page, "room")
    done(page)
    finished("room")
    shoot("room")
    page.keyboard.press("Tab")  # from the heading, where the focus went
    page.click("#next")

    shown(page, "colour")
    page.click("#freeze")
    done(page)
    page.click('[data-action="clear-cam1"]')
    expect(page.locator("#sentence")).to_contain_text("not for cam1", timeout=STEP_MS)
    draw(page, "cam1", by_hand)
    expect(page.locator("#sentence")).not_to_contain_text("cam1", timeout=STEP_MS)
    done(page)
    for one in page.locator("button.colour").all():
        assert one.evaluate("one => one.scrollWidth <= one.clientWidth"), "its key fits into it"
    finished("colour")
    shoot("colour")
    page.check("#as-seen")
    page.wait_for_timeout(700)
    shoot("colour_seen")
    page.click("#next")

    shown(page, "body")
    page.fill("#stature-cm", str(STATURE_CM))
    page.keyboard.press("Enter")
    page.click("#measure")
    done(page)
    finished("body")
    shoot("body")
    page.click("#next")

    shown(page, "check")
    done(page)
    shoot("check")
    page.click("#save")
    page.locator("#saved-to").get_by_text("calibration.toml").wait_for(timeout=STEP_MS)
    finished("check")
    page.close()
    code = served.stop()
    out.log = "".join(served.log)
    assert code == 0, out.log
    return out


def test_the_whole_setup_is_done_and_saved(setup: Setup) -> None:
    print(
        f"\nthe whole setup: {sum(setup.seconds.values()):.0f} s ("
        + ", ".join(f"{step} {s:.0f}" for step, s in setup.seconds.items())
        + ")"
    )
    saved = tomllib.loads(setup.saved.read_text(encoding="utf-8"))
    assert [camera["id"] for camera in saved["camera"]] == ["cam0", "cam1"]
    assert saved["wearer"]["stature_m"] == pytest.approx(STATURE_CM / 100)
    assert str(setup.saved) in setup.log, "it says on the terminal what was written"


def test_begun_anew_the_setup_of_before_is_forgotten(setup: Setup) -> None:
    assert setup.forgotten


def test_the_browser_had_nothing_to_complain_of(setup: Setup) -> None:
    assert setup.heard == []


def test_lenses_and_room_are_the_true_ones(setup: Setup) -> None:
    saved = tomllib.loads(setup.saved.read_text(encoding="utf-8"))
    centres, true_centres = [], []
    for camera, spec in zip(saved["camera"], load_scenario(SCENARIO).cameras, strict=True):
        assert spec.focal_px is not None
        focal = np.array([camera["K"][0][0], camera["K"][1][1]])
        assert np.abs(focal / spec.focal_px - 1.0).max() <= 0.005
        centres.append(-np.array(camera["R"]).T @ camera["t_m"])
        true_centres.append(np.array(spec.position_m))
    # which way the floor's board points is the user's choice: only its origin and up are compared
    heights = np.array(centres)[:, 1] - np.array(true_centres)[:, 1]
    assert np.abs(heights).max() <= 0.01
    apart = np.linalg.norm(centres[0] - centres[1])
    assert apart == pytest.approx(np.linalg.norm(true_centres[0] - true_centres[1]), abs=0.01)


def test_a_recording_is_tracked_with_the_saved_file(
    setup: Setup, tmp_path: Path, user_env: dict[str, str], cache_home: Path
) -> None:
    """As well as with the true rig, but for the direction in which the board lay."""
    scenario = load_scenario(SCENARIO)
    late = msgspec.structs.replace(scenario, scribble_s=0.0, fps_hz=15.0)
    capture = kept_capture(late, 2.0, cache_home)
    errors = {}
    for name, options in (("true", []), ("saved", ["--calibration", str(setup.saved)])):
        track = tmp_path / f"{name}.npz"
        words = ["track", str(capture), "--tracker", "shirt", "--out", str(track), *options]
        command = [sys.executable, "-m", "mocapd.cli.main", *words]
        subprocess.run(command, env=user_env, check=True, capture_output=True)
        errors[name] = rms_after_turning_cm(capture, track)
    print("\n" + json.dumps(errors))
    assert errors["saved"] <= max(1.3 * errors["true"], errors["true"] + 0.5)
