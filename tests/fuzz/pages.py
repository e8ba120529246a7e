"""The page: requests and WebSockets of somebody who was let in, and of somebody who was not."""

import json
from collections.abc import Callable, Mapping
from random import Random

from tests.fuzz import setups
from tests.fuzz.mutations import JSON_VALUES, damaged, mistyped
from tests.fuzz.page_bench import SECRET, SITE, SITE_KEY, PageBench, request
from tests.fuzz.row import Attempt, Place, WrongError, one_of

_PATHS = (
    "/", "/page/app.js", "/page/style.css", "/page/index.html", "/picture/colour-1", "/status", "/setup", "/ws", "/live",
)  # fmt: skip
_PIECES = (
    "%00", "%ff", "%2f", "%5c", "..", "../..", "%2e%2e/", "//", "?", "#", ";", "%", "%zz", "%c0%af", "%ed%a0%80", "é", "~",
    "x" * 300 + ".js", "x" * 5000, ".js", ".png", "%0a", "%0d%0aX: y", "*", "[", "{name}", "?token=", "?token=%ff", "/",
)  # fmt: skip
_PICTURES = {"camera": "cam0", "width": 480, "after": None, "over": "setup"}
_WATCH = {"watch": True}
_FRAMES = f"/frames?key={SITE_KEY}"


def requests(place: Place) -> Attempt:
    """HTTP with the cookie, its bytes and paths damaged."""
    return _of_page(place, _changed_request)


def _changed_request(random: Random, _number: int, page: PageBench) -> bool:
    path = random.choice(_PATHS)
    good = request(*_method_of(path), page.base + path, page.cookie, _body_of(path))
    if random.random() < 0.5:
        at = random.randint(1, len(path))
        path = path[:at] + random.choice(_PIECES) + random.choice((path[at:], ""))
        good = request(*_method_of(path), page.base + path, page.cookie)
    if random.random() < 0.6:
        good = damaged(random, good)
    answer = page.ask(good)
    return 200 <= answer.status < 400


def _method_of(path: str) -> tuple[str]:
    return ("POST" if path.startswith("/setup") else "GET",)


def _body_of(path: str) -> bytes:
    return b'{"step": "lens"}' if path == "/setup" else b""


def setup_bodies(place: Place) -> Attempt:
    """Bodies of POST /setup."""
    steps = [f'{{"step":{value}}}' for value in JSON_VALUES]
    others = [f'{{"step":"lens","x":{value}}}' for value in JSON_VALUES]
    keys = (
        '{"step"}',
        "{",
        "",
        " ",
        "\ufeff{}",
        '{"step":"lens"}x',
        '{"step":"lens","step":1}',
        "null\0",
    )
    cases = [one.encode() for one in (*steps, *others, *JSON_VALUES, *keys)]
    cases += [
        b"\xff",
        b'{"step":"\xff"}',
        b'{"\xed\xa0\x80":1}',
        b"\x00" * 100,
        b'{"step":"lens"' + b" " * 1000,
    ]

    def post(_random: Random, number: int, page: PageBench) -> bool:
        body = one_of(cases, number)
        answer = page.ask(request("POST", f"{page.base}/setup", page.cookie, body))
        return answer.status == 200

    return _of_page(place, post)


def setup_messages(place: Place) -> Attempt:
    """/ws."""
    return _of_socket(place, "/ws", setups.spoilt)


def picture_messages(place: Place) -> Attempt:
    """/pictures."""
    return _of_socket(place, "/pictures", lambda random: _changed(random, _PICTURES))


def live_messages(place: Place) -> Attempt:
    """/live."""
    return _of_socket(place, "/live", lambda random: _changed(random, _WATCH))


def frames_messages(place: Place) -> Attempt:
    """/frames, of an allowed site that has the key."""

    def talk(random: Random, _number: int, page: PageBench) -> bool:
        answers = [{"seen": random.randint(0, 3)} for _ in range(3)]
        messages = [json.dumps(one).encode() for one in answers]
        if random.random() < 0.8:
            messages[random.randrange(3)] = _changed(random, answers[0])
        said = page.talk(_FRAMES, messages, "", SITE)
        if not any(one["type"] == "websocket.accept" for one in said):
            raise WrongError("the WebSocket was not opened")
        return not any(one["type"] == "websocket.close" for one in said)

    return _of_page(place, talk)


def other_sites(place: Place) -> Attempt:
    """Sites that are not allowed, and those that have no key, get no frame, whatever they say."""
    page = PageBench(place.folder)
    assert any(one["type"] == "websocket.accept" for one in page.talk(_FRAMES, [], "", SITE))

    def attempt(random: Random, _number: int) -> bool:
        site, path = SITE, _FRAMES
        if random.random() < 0.5:
            at = random.randint(0, len(site))
            site = random.choice((
                site[:at] + random.choice(_PIECES) + site[at:], site[:-1], f"{site}:443", "null", "",
                site.upper(), site.replace("https", "http"), f"{site}, {site}", f"x{site}",
            ))  # fmt: skip
        else:
            wrong = damaged(random, SITE_KEY.encode()).decode(errors="replace")
            if wrong == SITE_KEY:
                return False
            path = random.choice(("/frames", f"/frames?key={wrong}", f"/frames?token={SITE_KEY}"))
        if any(one["type"] == "websocket.accept" for one in page.talk(path, [b"{}"], "", site)):
            raise WrongError("frames for a site that is not allowed")
        return False

    return attempt


def _changed(random: Random, message: Mapping[str, object]) -> bytes:
    good = json.dumps(message).encode()
    return good if random.random() < 0.1 else mistyped(random, good, JSON_VALUES)


def strangers(place: Place) -> Attempt:
    """Whoever has no token is served nothing, whatever they say."""
    page = PageBench(place.folder)
    page.let_in()

    def attempt(random: Random, number: int) -> bool:
        path = page.base + random.choice(_PATHS)
        if number % 5 == 0:
            said = page.talk(random.choice((path, "/ws", "/live", f"{page.base}/ws")), [b"{}"], "")
            if any(one["type"] == "websocket.accept" for one in said):
                raise WrongError("a stranger was let in")
            return False
        if random.random() < 0.4:
            path += random.choice(_PIECES)
        name, _, value = page.cookie.partition("=")
        wrong = random.choice(("", "x", value[:-1], f"{value}x", "é", SECRET[1:], "*"))
        cookie = random.choice(("", f"{name}={wrong}"))
        raw = request(*_method_of(path), path, cookie)
        answer = page.ask(damaged(random, raw))
        if 0 < answer.status < 400 or "set-cookie" in answer.headers:
            raise WrongError(f"a stranger was answered {answer.status}")
        return False

    return attempt


def _of_socket(place: Place, path: str, make: Callable[[Random], bytes]) -> Attempt:
    def talk(random: Random, _number: int, page: PageBench) -> bool:
        message = make(random)
        said = page.talk(page.base + path, [message], page.cookie)
        page.settle()
        if not any(one["type"] == "websocket.accept" for one in said):
            raise WrongError("the WebSocket was not opened")
        return not any(one["type"] == "websocket.close" for one in said)

    return _of_page(place, talk)


def _of_page(place: Place, use: Callable[[Random, int, PageBench], bool]) -> Attempt:
    """Each input has a page and a setup of its own."""

    def attempt(random: Random, number: int) -> bool:
        page = PageBench(place.folder)
        try:
            page.let_in()
            done = use(random, number, page)
            page.settle()
            return done
        finally:
            page.close()

    page = PageBench(place.folder)
    page.let_in()
    assert page.ask(request("GET", f"{page.base}/status", page.cookie)).status == 200
    assert page.ask(request("POST", f"{page.base}/setup", page.cookie, b"{}")).status == 200
    assert page.ask(request("GET", f"{page.base}/page/index.html", page.cookie)).status == 200
    page.settle()
    page.close()
    return attempt
