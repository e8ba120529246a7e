"""clients/web in a real browser: on the canned tracker, and on everything that goes wrong."""

import hashlib
import json
import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import msgspec
import pytest
from playwright.sync_api import Browser, Page, ViewportSize, expect

from mocapd.config.web_params import Params
from mocapd.outputs import wire
from mocapd.outputs.from_skeleton import rest_skeleton
from mocapd.web.games.frames_access import FramesAccess
from mocapd.web.runtime_file import Place, running
from mocapd.web.server import WebServer
from tests.browser.conftest import FOR_THE_DOCS, problems_of
from tests.browser.game_site import PAGE, AnyDaemon, any_daemon, game_site
from tests.outputs.frames import left_hand_up, whole_frame
from tests.web.tiny_host import TinyHost

WAIT_MS = 120_000
PLACES = """async () => {
    const { figure, stage } = await import(new URL("main.js", location).href);
    const left = figure.positionOf("leftHand"), right = figure.positionOf("rightHand");
    return left && right && { left: left.toArray(), seen: [left, right].map((one) => one.project(stage.camera).toArray()) };
}"""


@pytest.fixture(scope="module")
def site() -> Iterator[str]:
    with game_site() as origin:
        yield origin


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """A window of its own, with nothing kept; small, as the processor draws it."""
    size: ViewportSize = {
        "width": 1000 if FOR_THE_DOCS else 480,
        "height": 640 if FOR_THE_DOCS else 360,
    }
    with browser.new_context(viewport=size) as context:
        context.set_default_timeout(WAIT_MS)
        yield context.new_page()


@pytest.fixture
def daemon() -> Iterator[AnyDaemon]:
    with any_daemon() as one:
        yield one


def rest_text() -> str:
    _, skeleton = left_hand_up()
    return msgspec.json.encode(rest_skeleton(skeleton, instance="", stature_m=1.75)).decode()


def frame_text(**changes: object) -> str:
    tree = json.loads(wire.encode_json(whole_frame(seq=3)))
    return json.dumps(tree | changes)


def with_hand(position: object) -> str:
    tree = json.loads(frame_text())
    tree["joints"]["leftHand"]["p"] = position
    return json.dumps(tree)


def until_true(page: Page, script: str) -> Any:
    """What an asynchronous script in the page returns, once it is true."""
    until_s = time.monotonic() + WAIT_MS / 1000.0
    while not (value := page.evaluate(script)):
        assert time.monotonic() < until_s, script
        page.wait_for_timeout(50)
    return value


def state(page: Page, name: str, *words: str) -> None:
    """Wait until it is so, and said in these words."""
    expect(page.locator("#state")).to_have_attribute("data-state", name, timeout=WAIT_MS)
    for word in words:
        shows(page, "#state", word)


def shows(page: Page, place: str, text: str | re.Pattern[str]) -> None:
    expect(page.locator(place)).to_contain_text(text, timeout=WAIT_MS)


def link_to(server: WebServer, place: Place, site: str) -> str:
    (found,) = running(place.folder)
    access = FramesAccess(found.status.origins, found.status.frames_key)
    (link,) = access.links(urlsplit(server.url).netloc)
    assert link.startswith(site)
    return link


def test_it_draws_the_canned_person(page: Page, site: str, tmp_path: Path, pictures: Path) -> None:
    heard, asked = problems_of(page), list[str]()
    page.on("request", lambda request: asked.append(request.url))
    host = TinyHost(tmp_path)
    place = Place(tmp_path / "run", tmp_path, "pc")
    died: list[BaseException] = []
    with WebServer(host, Params(allow_origins=(site,)), died.append, place) as server:
        link = link_to(server, place, site)
        page.goto(link.replace("/#", "/?full#") if FOR_THE_DOCS else link)
        state(page, "live")
        shows(page, "#left-hand", re.compile(r"1\.\d\d"))
        shows(page, "#tracking", "live")
        shows(page, "#rate", re.compile(r"^[1-9]\d* per second"))
        assert "key" not in page.url, "a key in the address bar ends up in screenshots"
        page.wait_for_timeout(4000 if FOR_THE_DOCS else 300)
        page.screenshot(path=pictures / "web-client.png")
        page.reload()  # by what it kept
        state(page, "live")
    assert died == []
    state(page, "unreachable")
    assert not [url for url in asked if not url.startswith((site, "data:"))]
    assert [one for one in heard if "WebSocket" not in one] == []


def test_a_site_that_is_not_allowed_is_told_what_to_look_at(
    page: Page, site: str, tmp_path: Path
) -> None:
    host = TinyHost(tmp_path)
    place = Place(tmp_path / "run", tmp_path, "pc")
    other = "http://localhost:8000"
    with WebServer(host, Params(allow_origins=(other,)), lambda error: None, place) as server:
        page.goto(link_to(server, place, other).replace(other, site))
        state(page, "unreachable", site, "allow_origins")


def test_an_asymmetric_pose_is_drawn_where_it_is(page: Page, site: str, daemon: AnyDaemon) -> None:
    """Left hand up, facing the viewer: not mirrored, not backwards, within a millimetre."""
    frame = whole_frame(seq=3)
    daemon.say(rest_text(), frame_text())
    page.goto(f"{site}/#mocapd={daemon.address}")
    state(page, "live")
    drawn = until_true(page, PLACES)
    assert drawn["left"] == pytest.approx(frame.joints["leftHand"].p, abs=1e-3)
    (left_x, left_y, _), (right_x, right_y, _) = drawn["seen"]
    assert left_x > right_x, "who faces us has the left hand to our right"
    assert left_y > right_y + 0.2


def test_a_figure_that_is_built_anew_leaves_nothing_behind(page: Page, site: str) -> None:
    """A rest skeleton comes whenever the daemon has learned the body a little better."""
    page.goto(site)
    first, second = page.evaluate(
        """async (rest) => {
        const { figure, stage } = await import(new URL("main.js", location).href);
        const geometries = () => {
            figure.build(rest);
            figure.group.visible = true;
            stage.renderer.render(stage.scene, stage.camera);
            return stage.renderer.info.memory.geometries;
        };
        return [geometries(), geometries()];
    }""",
        json.loads(rest_text()),
    )
    assert second == first


def test_joints_of_which_nothing_is_known_are_not_drawn(
    page: Page, site: str, daemon: AnyDaemon
) -> None:
    frame = whole_frame()
    assert frame.joints["hips"].c == 0.0
    daemon.say(rest_text(), frame_text())
    page.goto(f"{site}/#mocapd={daemon.address}")
    state(page, "live")
    until_true(page, PLACES)
    drawn = until_true(
        page,
        """async () => {
        const { figure } = await import(new URL("main.js", location).href);
        return figure.positionOf("spine") !== null && [figure.positionOf("hips")];
    }""",
    )
    assert drawn == [None]


def test_what_is_wrong_with_a_message_is_said_and_survived(
    page: Page, site: str, daemon: AnyDaemon
) -> None:
    heard = problems_of(page)
    page.goto(f"{site}/#mocapd={daemon.address}")
    daemon.say(frame_text())  # before any rest skeleton
    state(page, "live")
    wrong: tuple[tuple[str | bytes, str], ...] = (
        ("garbage", "no JSON"),
        (b"\x00\xff", "no text"),
        ("[1, 2]", "no message of mocapd"),
        ('{"schema": 7}', "no message of mocapd"),
        (frame_text(joints=[]), "without its fields"),
        (frame_text(seq="one"), "without its fields"),
        (frame_text().replace('"seq": 3', '"seq": NaN'), "no JSON"),
        (with_hand([None, 1.0, 0.0]), "1 joints of a frame are no numbers"),
        (json.dumps(json.loads(rest_text()) | {"parents": [5]}), "does not fit together"),
        ("x" * 2_000_000, "too long"),
        (with_hand([1.0]), "1 joints of a frame are no numbers"),
        (
            with_hand([1e999, 1, 1]).replace("Infinity", "1e999"),
            "1 joints of a frame are no numbers",
        ),
    )
    for count, (word, said) in enumerate(wrong, start=1):
        daemon.say(word)
        shows(page, "#ignored", re.compile(rf"so far: {count}\. The last: .*{said}"))
    shows(page, "#left-hand", "–")
    daemon.say('{"schema": "mocapd.Later.v1"}', rest_text(), frame_text(joints={}, tracking="lost"))
    state(page, "nobody")
    daemon.say(frame_text(schema="mocapd.Skeleton.v2"))
    state(page, "unusable", "mocapd.Skeleton.v2")
    daemon.say(frame_text())
    state(page, "live")
    shows(page, "#left-hand", "1.91")
    shows(page, "#ignored", f"so far: {len(wrong)}.")
    assert heard == []


def test_a_stream_that_stops_is_said_and_goes_on(page: Page, site: str, daemon: AnyDaemon) -> None:
    page.goto(f"{site}/#mocapd={daemon.address}")
    daemon.say(rest_text(), frame_text())
    state(page, "live")
    state(page, "quiet", "No frame for")
    shows(page, "#left-hand", "–")
    daemon.say(frame_text())
    state(page, "live")
    daemon.hang_up()
    state(page, "unreachable")
    daemon.say(rest_text(), frame_text())
    state(page, "live")


def test_slowness_is_that_of_the_daemon_which_is_connected(
    page: Page, site: str, daemon: AnyDaemon
) -> None:
    page.goto(f"{site}/#mocapd={daemon.address}")
    daemon.say('{"schema": "mocapd.Health.v1", "slowness": "too slow"}', frame_text())
    state(page, "slow", "too slow")
    daemon.hang_up()
    state(page, "unreachable")
    daemon.say(frame_text())
    state(page, "live")


def test_a_link_is_pasted_and_forgotten(page: Page, site: str, daemon: AnyDaemon) -> None:
    page.goto(site)
    state(page, "none", "mocapd web-link")
    for wrong in ("nonsense", "ws://evil.example/frames?key=x", "http://127.0.0.1:1/"):
        page.fill("#link", wrong)
        page.click("#link-form button")
        state(page, "unusable")
    page.fill("#link", f"http://game.example/#mocapd={daemon.address}")
    page.click("#link-form button")
    daemon.say(rest_text(), frame_text())
    state(page, "live")
    page.click("#forget")
    state(page, "none")
    page.reload()
    state(page, "none")


def test_what_is_vendored_is_what_the_lock_names() -> None:
    lock = json.loads((PAGE / "package-lock.json").read_text())["packages"]
    asked = json.loads((PAGE / "package.json").read_text())["dependencies"]
    assert {name: lock[f"node_modules/{name}"]["version"] for name in asked} == asked
    assert all(lock[f"node_modules/{name}"]["integrity"].startswith("sha512-") for name in asked)
    revision = asked["three"].split(".")[1]
    assert f'"{revision}"' in (PAGE / "vendor/three/three.core.min.js").read_text()[:400]
    assert "MIT License" in (PAGE / "vendor/three/LICENSE").read_text()
    sums = [line.split("  ") for line in (PAGE / "vendor/SHA256SUMS").read_text().splitlines()]
    assert {name for _, name in sums} == {
        path.relative_to(PAGE / "vendor").as_posix() for path in PAGE.glob("vendor/three/*")
    }
    for digest, name in sums:
        assert hashlib.sha256((PAGE / "vendor" / name).read_bytes()).hexdigest() == digest
