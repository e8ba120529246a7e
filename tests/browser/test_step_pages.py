"""Every step's page at a desk and on a phone, its sound, and the last page; in a real browser, without cameras."""

import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, ViewportSize, expect

from mocapd.web.server import WebServer
from mocapd.wizard.step import StepState
from mocapd.wizard.step_names import StepName
from tests.browser.conftest import FOR_THE_DOCS, problems_of
from tests.browser.step_views import PAGES, SAVED, ShownWizard, body, check, lens
from tests.web.tiny_host import TinyHost

WAIT_MS = 120_000
SIZES: dict[str, ViewportSize] = {
    "desk": {"width": 1280, "height": 657},
    "phone": {"width": 390, "height": 844},
}
# The buttons that lead on from each page.
ONE_BUTTON = {
    "cameras": "#next",
    "lens": "#finish",
    "room": "#floor",
    "room_done": "#next",
    "colour": "#freeze",
    "body": "#measure",
    "check": "#save",
}
# Counts what is played and said: a headless browser has no loudspeaker.
LISTEN = """() => {
    window.heard = { words: [], tones: 0 };
    window.SpeechSynthesisUtterance = class { constructor(text) { this.text = text; } };
    const voice = { speak: ({ text }) => window.heard.words.push(text), cancel: () => {} };
    Object.defineProperty(window, "speechSynthesis", { value: voice });
    const start = OscillatorNode.prototype.start;
    OscillatorNode.prototype.start = function (at) { window.heard.tones += 1; start.call(this, at); };
}"""

# Eight cameras around a room, each turned to its middle: where the plan writes their names, and where they stand [px].
NAMED = """async () => {
    const { Plan } = await import(new URL("page/room_plan.js", location.href.split("?")[0]).href);
    const cameras = [0, 1, 2, 3, 4, 5, 6, 7].map((index) => {
        const angle = (index * Math.PI) / 4;
        const towards = [Math.cos(angle), 0, Math.sin(angle)];
        const at_m = [-3 * towards[0], 1.5, -3 * towards[2]];
        return { id: `camera ${index}`, at_m, towards, half_angle_rad: 0.55, angle };
    });
    const plan = new Plan();
    document.body.append(plan.root);
    const context = plan.canvas.getContext("2d");
    const texts = {};
    context.fillText = (text, x, y) => { texts[text] = { x, y, width: context.measureText(text).width }; };
    const places = {};
    plan.camera = (_context, { id, at_m }, at) => { places[id] = at(at_m[0], at_m[2]); };
    plan.update({ cameras, boards_m: [] }, {});
    plan.root.remove();
    return cameras.map(({ id, angle }) => ({ name: id, ...texts[id], at: places[id], angle, half: 0.55 }));
}"""


class Shown:
    """A page with a setup that a test leads."""

    def __init__(self, host: TinyHost, page: Page, url: str) -> None:
        self.host, self.page, self.url = host, page, url
        self.wizard = ShownWizard()
        self.problems = problems_of(page)

    def load(self) -> None:
        """With the first step, as somebody who comes to it."""
        self.wizard = ShownWizard()
        self.host.wizard = self.wizard  # type: ignore[assignment]
        self.page.set_viewport_size(SIZES["desk"])
        self.page.goto(self.url)
        self.page.locator("#part > .part-cameras").wait_for(timeout=WAIT_MS)

    def show(self, step: StepName, view: Any, **changes: object) -> None:
        self.wizard.show(step, view, **changes)
        expect(self.page.locator("#sentence")).to_have_text(view.sentence, timeout=WAIT_MS)
        self.page.locator(f"#part > .part-{step.value}").wait_for(timeout=WAIT_MS)

    def wait_for(self, word: str) -> None:
        """Until it is said; the page's policy allows no predicate there."""
        for _ in range(WAIT_MS // 100):
            if word in self.words():
                return
            self.page.wait_for_timeout(100)
        pytest.fail(f"{word} is not said: {self.words()}")

    def words(self) -> list[str]:
        found: list[str] = self.page.evaluate("heard.words")
        return found


@pytest.fixture(scope="module")
def loaded(browser: Browser, server: WebServer, host: TinyHost) -> Iterator[Shown]:
    """One page for all: to load it takes longer than to look at it."""
    with browser.new_context(viewport=SIZES["desk"]) as context:
        page = context.new_page()
        page.add_init_script(f"({LISTEN})()")
        for camera in ("cam0", "cam1"):
            host.show(camera, 110)
        one = Shown(host, page, server.url)
        one.load()
        yield one
        host.wizard = None


@pytest.fixture
def shown(loaded: Shown) -> Iterator[Shown]:
    """At the first step again."""
    loaded.page.set_viewport_size(SIZES["desk"])
    loaded.show(*PAGES["cameras"])
    loaded.wizard.heard.clear()
    yield loaded
    assert loaded.problems == []


@pytest.fixture
def alone(loaded: Shown) -> Iterator[Shown]:
    """Loaded anew, as is the next: it hears, or ends."""
    loaded.load()
    yield loaded
    assert loaded.problems == []
    loaded.load()


def test_instruction_and_its_one_button_are_in_sight_at_every_size(
    shown: Shown, pictures: Path
) -> None:
    """On one page after the other, as in a setup: to load one takes longer than to look at it."""
    for name, (step, view) in PAGES.items():
        shown.show(step, view)
        for size_name, size in SIZES.items():
            shown.page.set_viewport_size(size)
            shown.page.wait_for_timeout(200)
            for scrolled in (0, 100_000):
                shown.page.evaluate(f"scrollTo(0, {scrolled})")
                for seen in (ONE_BUTTON[name], "#sentence"):
                    expect(shown.page.locator(seen), name).to_be_in_viewport(ratio=1)
            across = shown.page.evaluate("document.documentElement.scrollWidth")
            assert across <= size["width"], f"{name}: nothing is cut off at the side"
            if not FOR_THE_DOCS:
                continue
            shown.page.evaluate("scrollTo(0, 0)")
            shown.page.wait_for_timeout(200)
            shown.page.screenshot(path=pictures / f"step-{name}-{size_name}.png", full_page=True)


def test_one_button_at_most_is_the_one_to_press(shown: Shown) -> None:
    pages = {**PAGES, "body_done": (StepName.BODY, body(measured=True))}
    for name, (step, view) in pages.items():
        shown.show(step, view)
        assert shown.page.locator(".step-buttons .primary:visible").count() <= 1, name


def test_back_leads_to_the_step_before(shown: Shown) -> None:
    expect(shown.page.locator("#back")).to_be_hidden()
    shown.show(*PAGES["lens"])
    shown.page.click("#back")
    shown.page.wait_for_timeout(300)
    assert shown.wizard.heard == [("go", {"step": "cameras"})]


def test_drawings_say_how_to_hold_the_board_and_where_cameras_go(shown: Shown) -> None:
    for name, file in (
        ("cameras", "camera_places"),
        ("lens", "board_views"),
        ("room", "board_floor"),
    ):
        shown.show(*PAGES[name])
        drawing = shown.page.locator(f'img[src*="{file}.svg"]')
        expect(drawing.first).to_be_visible(timeout=WAIT_MS)
        for part in drawing.all():
            assert part.evaluate("image => image.decode().then(() => image.naturalWidth)") > 0


@pytest.mark.parametrize(("name", "widest"), [("cameras", 380), ("lens", 315)])
def test_drawings_can_be_read_on_a_phone(shown: Shown, name: str, widest: int) -> None:
    """Of parts that are drawn for that width, with letters of 13 pixels."""
    shown.page.set_viewport_size({"width": 390, "height": 844})
    shown.show(*PAGES[name])
    drawing = shown.page.locator(".how img")
    expect(drawing.last).to_be_visible(timeout=WAIT_MS)
    widths = [
        part.evaluate("image => image.getBoundingClientRect().width") for part in drawing.all()
    ]
    assert len(widths) == 2
    assert min(widths) >= 0.75 * widest


def test_how_far_cameras_disagree_is_not_given_as_an_error_of_the_pose(shown: Shown) -> None:
    """It is 1 cm where the pose may be off by 5 to 12."""
    shown.show(*PAGES["check"])
    expect(shown.page.locator("#verdicts")).to_contain_text("Disagrees in the room")
    expect(shown.page.locator("#verdicts")).not_to_contain_text("Off in the")


def test_the_plan_has_a_scale_and_says_how_large_the_play_area_is(shown: Shown) -> None:
    shown.show(*PAGES["room_done"])
    caption = shown.page.locator("figure:has(canvas.plan) figcaption")
    expect(caption).to_contain_text("You are seen whole on")
    expect(caption).to_contain_text("cameras 3.1 m apart")
    legend = shown.page.locator(".plan-legend li")
    expect(legend).to_have_text(["camera", "the board was here", "two cameras see you whole"])


def test_a_cameras_name_on_the_plan_is_not_in_what_it_sees(shown: Shown) -> None:
    shown.show(*PAGES["room_done"])
    named = shown.page.evaluate(NAMED)
    assert len(named) == 8
    for one in named:
        across, up = np.meshgrid(np.linspace(0, one["width"], 9), [0.0, 6.0, 12.0])
        away = np.array([one["x"] + across - one["at"][0], one["y"] - up - one["at"][1]])
        off_rad = np.arctan2(away[1], away[0]) - one["angle"]
        off_rad = np.abs((off_rad + np.pi) % (2 * np.pi) - np.pi)
        assert off_rad.min() > one["half"], one["name"]
        assert np.hypot(*away).min() > 7, "the symbol"


def test_it_is_said_aloud_what_to_do_until_it_is_switched_off(alone: Shown) -> None:
    alone.page.click("h1")  # browsers are silent before
    alone.show(StepName.LENS, lens(7))
    alone.page.wait_for_timeout(1300)
    alone.wizard.show(StepName.LENS, lens(8))
    alone.wait_for("Next.")
    alone.page.wait_for_timeout(1300)
    alone.show(StepName.LENS, dataclasses.replace(lens(8), sentence="Hold still."))
    alone.wait_for("Hold still.")
    for phase in ("leaving", "seeking", "judged"):
        alone.page.wait_for_timeout(1300)
        alone.show(StepName.CHECK, check(phase))
    alone.wait_for("Done.")
    words = alone.words()
    assert "Step out of every camera's picture." in words
    assert "Come back, stand upright, and face the cameras." in words
    assert alone.page.evaluate("heard.tones") >= len(words)
    alone.page.click("#sound")
    expect(alone.page.locator("#sound")).to_have_attribute("aria-pressed", "false")
    alone.page.wait_for_timeout(1300)
    alone.show(StepName.LENS, lens(3, StepState.FAILED))
    alone.page.wait_for_timeout(400)
    assert alone.words() == words, "it is silent now"


def test_the_last_page_says_what_is_saved_and_what_to_run(
    alone: Shown, host: TinyHost, pictures: Path
) -> None:
    """Also after the process that served it has ended."""
    page = alone.page
    alone.show(StepName.CHECK, check())
    alone.wizard.show(StepName.CHECK, check(saved=SAVED), saved=True)
    expect(page.locator("#finished")).to_be_visible(timeout=WAIT_MS)
    expect(page.locator("#saved-to")).to_have_text(SAVED)
    expect(page.locator("#next-command")).to_have_text("mocapd run")
    for name, size in SIZES.items():
        page.set_viewport_size(size)
        page.screenshot(path=pictures / f"step-finished-{name}.png")
    host.wizard = None
    page.wait_for_timeout(1000)
    expect(page.locator("#finished")).to_be_visible()
    expect(page.locator("#connection")).to_have_text("Saved")
    expect(page.locator(".state.failed")).to_have_count(0)
    assert [one.inner_text() for one in page.locator("button:visible").all()] == ["Copy"]
    page.click('[data-action="copy"]')
    expect(page.locator("#next-command ~ .good")).not_to_be_empty(timeout=WAIT_MS)


def test_where_a_daemon_runs_the_last_page_leads_to_its_live_view(
    alone: Shown, host: TinyHost
) -> None:
    alone.wizard.show(StepName.CHECK, check(saved=SAVED, following=""), saved=True)
    expect(alone.page.locator("#finished")).to_be_visible(timeout=WAIT_MS)
    host.wizard = None
    alone.page.wait_for_timeout(500)
    alone.page.get_by_role("link", name="live view", exact=True).click()
    expect(alone.page.locator("#live-title")).to_be_visible(timeout=WAIT_MS)
