"""The page's own files: nothing from elsewhere, nothing that the policy forbids, all there."""

import re

import pytest

from mocapd.web.app import MEDIA_TYPES, PAGE_DIR
from mocapd.web.server import WebServer
from tests.conftest import ROOT
from tests.web.browser import get, token_of

FILES = sorted(path for path in PAGE_DIR.iterdir() if path.is_file())
NAMESPACES = re.compile(r"http://www\.w3\.org/[\w/]+")  # of SVG: a name, never fetched


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_no_file_names_another_host(path) -> None:  # type: ignore[no-untyped-def]
    text = NAMESPACES.sub("", path.read_text())
    assert re.findall(r"(?:https?|wss?):\/\/(?!\$\{location\.host\})\S+", text) == []
    assert re.findall(r"""["'(]//\w""", text) == []


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_no_file_needs_what_the_policy_forbids(path) -> None:  # type: ignore[no-untyped-def]
    text = path.read_text()
    if path.suffix == ".html":
        assert re.findall(r"<script(?![^>]*\ssrc=)|<style|\sstyle=|\son\w+=", text) == []
    if path.suffix == ".js":
        assert re.findall(r"\beval\(|new Function\(|setAttribute\(\s*[\"']style", text) == []


def test_how_exact_the_pose_is_is_the_same_figure_wherever_it_is_said() -> None:
    readme = (ROOT / "README.md").read_text()
    for way in ("In a shirt", "In any clothes"):
        found = re.search(rf"\*\*{way}.*?([\d.]+ to [\d.]+ cm)", readme, re.DOTALL)
        assert found
        for path in (PAGE_DIR / "setup.js", ROOT / "docs/setup.md"):
            assert found.group(1) in path.read_text(), path.name


def test_every_file_that_is_named_is_there() -> None:
    for path in FILES:
        for name in re.findall(
            r"""["'](?:\./|page/)([\w.]+\.(?:js|css|svg))["']""", path.read_text()
        ):
            assert (PAGE_DIR / name).is_file(), f"{path.name} names {name}"


def test_no_file_is_named_relative_to_the_pages_own_address() -> None:
    """The page is above its files, at page/: a script says `new URL(name, import.meta.url)`. Where the
    page itself is, differs from start to start: nothing is named from the root."""
    for path in FILES:
        assert re.findall(r"""["'`]/[\w]""", path.read_text()) == [], path.name
        assert re.findall(r"""(?:href|src)[:=] ?["'][\w.]+\.\w+["']""", path.read_text()) == [], (
            path.name
        )


def test_every_file_is_served_as_what_it_is(server: WebServer) -> None:
    for path in FILES:
        answer = get(server, f"/page/{path.name}", token=token_of(server))
        assert answer.status_code == 200
        assert answer.headers["content-type"].startswith(MEDIA_TYPES[path.suffix])
        assert answer.content == path.read_bytes()


@pytest.mark.parametrize(
    "name", ["..%2fserver.py", "../server.py", "%2e%2e/server.py", ".", 4000 * "x" + ".js"]
)
def test_nothing_beside_the_page_is_served(server: WebServer, name: str) -> None:
    assert get(server, f"/page/{name}", token=token_of(server)).status_code == 404
