"""What the live view draws of a body in a real browser: what is known, how well, and nothing else."""

import base64
import json
from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

from mocapd.body.skeleton import INDEX
from mocapd.config.web_params import Params
from mocapd.types import Floats
from mocapd.web.live_json import body_json, scene_json
from mocapd.web.server import WebServer
from tests.browser.conftest import problems_of
from tests.outputs.frames import left_hand_up
from tests.web.tiny_host import BELOW_THE_HIPS, TinyHost

WAIT_MS = 120_000
# The figure by itself, its background taken away: where the joints are on its canvas [px], and its picture.
DRAWN = """async ({ scene, body }) => {
    const { StickFigure } = await import(new URL("page/stick_figure.js", location.href.split("?")[0]).href);
    const place = document.createElement("div");
    place.style.width = "800px";
    document.body.append(place);
    const figure = new StickFigure(place);
    figure.setScene(scene);
    figure.setBody(body);
    const { width, height } = figure.canvas;
    const at = body.joints_m.map(figure.eye(width, height));
    const picture = figure.canvas.toDataURL("image/png");
    figure.destroy();
    place.remove();
    return { at, picture };
}"""


# What is written on the canvas, and where, of a body before one camera.
TEXTS = """async () => {
    const { StickFigure } = await import(new URL("page/stick_figure.js", location.href.split("?")[0]).href);
    const place = document.createElement("div");
    place.style.width = "800px";
    document.body.append(place);
    const figure = new StickFigure(place);
    const corners_m = [[-0.2, 1.2, -0.2], [0.2, 1.2, -0.2], [0.2, 1.0, -0.2], [-0.2, 1.0, -0.2]];
    const camera = { name: "cam0", centre_m: [0, 1.1, -0.5], corners_m };
    figure.setScene({ cameras: [camera], parents: [-1] });
    const texts = [];
    const context = figure.canvas.getContext("2d");
    context.fillText = (text, x, y) => texts.push({ text, x, y });
    figure.setBody({ tracking: "live", joints_m: [[0, 0.9, 0]], confidence: [1], uncertainty_m: [0.01] });
    const see = figure.eye(figure.canvas.width, figure.canvas.height);
    const corners = corners_m.map(see);
    figure.destroy();
    place.remove();
    return { texts, corners };
}"""


@pytest.fixture(scope="module")
def page(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    """The page of a daemon that tracks the upper body, at its live view."""
    host = TinyHost(tmp_path_factory.mktemp("state"))
    died: list[BaseException] = []
    with (
        WebServer(host, Params(), died.append) as server,
        browser.new_context(viewport={"width": 1100, "height": 800}) as context,
    ):
        one = context.new_page()
        heard = problems_of(one)
        one.goto(f"{server.url}#live")
        expect(one.locator("#tracking")).to_have_text("Tracking", timeout=WAIT_MS)
        yield one
        assert heard == []
    host.stop()
    assert died == []


def upper_body(**changes: Any) -> dict[str, Any]:
    """As the page is told of a person whose legs nobody looks at."""
    body, _ = left_hand_up()
    confidence, uncertainty_m = np.ones(len(INDEX)), np.full(len(INDEX), 0.01)
    confidence[BELOW_THE_HIPS], uncertainty_m[BELOW_THE_HIPS] = 0.0, np.inf
    told = body_json(body) | {
        "confidence": confidence.tolist(),
        "uncertainty_m": [sd if np.isfinite(sd) else None for sd in uncertainty_m],
    }
    return told | changes


def changed(of: list[Any], joint: str, value: float | None) -> list[Any]:
    """The same with another value of one joint."""
    return [value if i == INDEX[joint] else one for i, one in enumerate(of)]


def drawn(page: Page, body: dict[str, Any]) -> tuple[Floats, Floats]:
    """Joints (J,3) on the canvas: x, y [px], px a metre; and by how much of 255 the body covers each of its pixels."""
    _, skeleton = left_hand_up()
    scene = json.loads(json.dumps(scene_json((), None, skeleton)))
    pictures = []
    nothing = {"confidence": [0.0] * len(INDEX), "uncertainty_m": [None] * len(INDEX)}
    for one in (body, body | nothing):
        shown = page.evaluate(DRAWN, {"scene": scene, "body": one})
        encoded = np.frombuffer(base64.b64decode(shown["picture"].partition(",")[2]), np.uint8)
        picture = cv2.imdecode(encoded, cv2.IMREAD_UNCHANGED)
        assert picture is not None
        pictures.append(picture[:, :, 3].astype(float))
    return np.array(shown["at"]), np.abs(pictures[0] - pictures[1])


def at_middle_of(at: Floats, change: Floats, one: str, other: str) -> float:
    """The most covered pixel within 4 px of the middle between two joints."""
    x, y, _ = np.rint((at[INDEX[one]] + at[INDEX[other]]) / 2.0).astype(int)
    return float(change[y - 4 : y + 5, x - 4 : x + 5].max())


def test_the_figure_is_framed_on_the_body_wherever_it_stands(page: Page) -> None:
    for off_m in (0.0, 3.0):
        body = upper_body()
        body["joints_m"] = [[x + off_m, y, z - off_m] for x, y, z in body["joints_m"]]
        at, change = drawn(page, body)
        height, width = change.shape
        hips = at[INDEX["hips"]]
        assert abs(hips[0] - width / 2) < 0.02 * width
        assert 0.35 * height < hips[2] < 0.5 * height, "a metre of the body"
        assert (at[:, 1] > 0.02 * height).all(), "raised hands are in the picture"
        assert (at[:, 1] < 0.95 * height).all()


def test_a_cameras_name_is_beside_its_symbol_and_the_floor_has_a_scale(page: Page) -> None:
    told = page.evaluate(TEXTS)
    assert {one["text"] for one in told["texts"]} == {"cam0", "1 m"}
    (name,) = [one for one in told["texts"] if one["text"] == "cam0"]
    assert name["y"] < min(y for _, y, _ in told["corners"]), "above all of it"


LEG_BONES = [
    (side + one, side + other)
    for side in ("left", "right")
    for one, other in (("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot"))
]


def test_legs_that_nobody_looks_at_are_not_drawn(page: Page) -> None:
    at, change = drawn(page, upper_body())
    assert at_middle_of(at, change, "leftLowerArm", "leftHand") > 100
    for one, other in LEG_BONES:
        assert at_middle_of(at, change, one, other) == 0.0, f"{one} to {other}"
    _, change = drawn(page, upper_body(confidence=[1.0] * len(INDEX)))
    for one, other in LEG_BONES:
        assert at_middle_of(at, change, one, other) > 100, "else this test would see nothing"


def test_a_guess_is_drawn_fainter_and_in_another_colour(page: Page) -> None:
    sure = upper_body()
    guessed = sure | {"confidence": changed(sure["confidence"], "leftHand", 0.1)}
    at, change = drawn(page, sure)
    _, fainter = drawn(page, guessed)
    x, y, _ = ((at[INDEX["leftLowerArm"]] + at[INDEX["leftHand"]]) / 2.0).astype(int)
    around = np.s_[y - 12 : y + 13, x - 12 : x + 13]
    assert 0 < (fainter[around] > 100).sum() < 0.6 * (change[around] > 100).sum()


def test_an_arm_that_no_picture_shows_is_a_guess_and_does_not_vanish(page: Page) -> None:
    hidden = upper_body()
    for joint in ("leftLowerArm", "leftHand"):
        hidden["confidence"] = changed(hidden["confidence"], joint, 0.0)
        hidden["uncertainty_m"] = changed(hidden["uncertainty_m"], joint, 0.2)
    at, change = drawn(page, hidden)
    assert at_middle_of(at, change, "leftLowerArm", "leftHand") > 20


def test_what_is_uncertain_is_seen_to_be(page: Page) -> None:
    sure = upper_body()
    unsure = sure | {"uncertainty_m": changed(sure["uncertainty_m"], "leftHand", 0.15)}
    at, change = drawn(page, sure)
    _, wider = drawn(page, unsure)
    x, y, px_per_m = at[INDEX["leftHand"]]
    # straight beside the hand, within what it may be off by
    beside = (round(y), round(x + 0.1 * px_per_m))
    far = (round(y), round(x + 0.2 * px_per_m))
    assert change[beside] == 0.0
    assert wider[beside] > 20
    assert wider[far] == 0.0
    unknown = sure | {"uncertainty_m": [None] * len(INDEX)}
    _, plain = drawn(page, unknown)
    assert at_middle_of(at, plain, "leftLowerArm", "leftHand") > 100, "a tracker that tells none"
