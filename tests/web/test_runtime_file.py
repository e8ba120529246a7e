"""How other processes find a page: only one that lives, is ours and has its port; damaged files are none."""

import html
import json
import os
import random
import re
import socket
import stat
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest

from mocapd.config.runtime_folder import runtime_folder
from mocapd.config.web_params import Params
from mocapd.errors import UnavailableError
from mocapd.outputs.socket_owners import listens
from mocapd.web.runtime_file import Place, begin_setup, running
from mocapd.web.server import WebServer
from tests.web.browser import PATIENCE_S
from tests.web.tiny_host import TinyHost


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "run"


@contextmanager
def served(host: TinyHost, place: Place) -> Iterator[WebServer]:
    with WebServer(host, Params(), lambda error: None, place) as server:
        yield server


def said(folder: Path, pid: int, port: int) -> Path:
    """A file as a page of that process would have left it."""
    folder.mkdir(mode=0o700, exist_ok=True)
    path = folder / f"page-{pid}.json"
    told = {"port": port, "token": "old", "pid": pid, "state_dir": "/", "instance": "x"}
    path.write_text(json.dumps(told))
    path.with_suffix(".html").write_text("")
    return path


def test_other_processes_find_the_page(host: TinyHost, folder: Path, tmp_path: Path) -> None:
    with served(host, Place(folder, tmp_path, "game")) as server:
        files = sorted(folder.iterdir())
        assert [path.name for path in files] == [
            f"page-{os.getpid()}.html",
            f"page-{os.getpid()}.json",
        ]
        assert {stat.S_IMODE(path.stat().st_mode) for path in files} == {0o600}
        assert stat.S_IMODE(folder.stat().st_mode) == 0o700
        (found,) = running(folder)
        assert found.url == server.url
        assert (found.instance, found.state_dir, found.pid) == ("game", str(tmp_path), os.getpid())
        assert found.status.setup is None
        begin_setup(found.url, None)
        assert host.begun == 1
        host.why_not = "the cameras are being opened"
        with pytest.raises(UnavailableError, match="are being opened"):
            begin_setup(found.url, None)
    assert list(folder.iterdir()) == []


def test_a_file_leads_the_browser_to_the_page_without_a_word_to_others(
    host: TinyHost, folder: Path, tmp_path: Path
) -> None:
    with served(host, Place(folder, tmp_path, findable=False)) as server:
        assert running(folder) == ()
        assert server.redirect is not None
        text = server.redirect.read_text()
        found = re.search(r'http-equiv="refresh" content="0;url=([^"]+)"', text)
        assert found
        url = html.unescape(found[1])
        assert url == f"{server.url}#setup"
        assert '<meta name="referrer" content="no-referrer">' in text
        shown = httpx.get(url, trust_env=False, timeout=PATIENCE_S, follow_redirects=True)
        assert "<title>mocapd</title>" in shown.text
    assert list(folder.iterdir()) == []


def test_a_page_that_is_gone_is_not_found_and_its_files_are_removed(folder: Path) -> None:
    assert running(folder) == ()
    with subprocess.Popen([sys.executable, "-c", ""]) as ended:
        pass
    said(folder, ended.pid, 9)
    assert running(folder) == ()
    assert list(folder.iterdir()) == []
    with pytest.raises(UnavailableError):
        begin_setup("http://127.0.0.1:9/?token=x", None)


def test_a_page_of_a_newer_mocapd_is_left_alone(
    host: TinyHost, folder: Path, tmp_path: Path
) -> None:
    with served(host, Place(folder, tmp_path, "game")):
        (path,) = folder.glob("page-*.json")
        told = json.loads(path.read_text())
        path.write_text(json.dumps({**told, "schema": told["schema"] + 1}))
        assert running(folder) == ()
        assert path.exists()
        path.write_text(json.dumps({name: told[name] for name in told if name != "schema"}))
        assert len(running(folder)) == 1  # of an older one


def test_another_process_at_the_port_is_told_nothing(folder: Path) -> None:
    """After kill -9, whoever listens there next would be sent the token."""
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as living:
        with socket.create_server(("127.0.0.1", 0)) as impostor:
            impostor.settimeout(0.2)
            said(folder, living.pid, impostor.getsockname()[1])
            assert running(folder) == ()
            with pytest.raises(TimeoutError):
                impostor.accept()
        living.kill()


def test_who_listens() -> None:
    with socket.create_server(("127.0.0.1", 0)) as one:
        port = one.getsockname()[1]
        assert listens(os.getpid(), "127.0.0.1", port)
        assert not listens(os.getpid(), "127.0.0.2", port)
        assert not listens(os.getppid(), "127.0.0.1", port)
    assert not listens(os.getpid(), "127.0.0.1", port)
    assert not listens(2**31, "127.0.0.1", port)


def test_two_pages_of_one_user_are_both_found(host: TinyHost, folder: Path, tmp_path: Path) -> None:
    """The other is of a process of its own, as each process has one page."""
    with (
        subprocess.Popen(
            [sys.executable, "-c", OTHER_PAGE],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        ) as other,
        served(host, Place(folder, tmp_path, "one")) as server,
    ):
        assert other.stdout is not None
        path = said(folder, other.pid, int(other.stdout.readline()))
        assert {page.pid: page.instance for page in running(folder)} == {
            os.getpid(): "one",
            other.pid: "x",
        }
        server.stop()
        assert [page.pid for page in running(folder)] == [other.pid]
        assert path.exists()
        other.kill()


OTHER_PAGE = """
import http.server
class Page(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        self.send_response(200)
        self.end_headers()
        self.wfile.write(b'{"version": "0", "pid": 1, "cameras": [], "setup": null, "tracks": true}')
server = http.server.HTTPServer(("127.0.0.1", 0), Page)
print(server.server_port, flush=True)
server.serve_forever()
"""


def test_damaged_files_are_no_pages(host: TinyHost, folder: Path, tmp_path: Path) -> None:
    chance = random.Random(5)
    with served(host, Place(folder, tmp_path)) as server:
        path = folder / f"page-{os.getpid()}.json"
        whole = path.read_bytes()
        for _ in range(300):
            data = bytearray(whole)
            for _ in range(chance.randint(1, 6)):
                data[chance.randrange(len(data))] = chance.randrange(256)
            path.write_bytes(
                data[: chance.randint(0, len(data))] if chance.random() < 0.3 else data
            )
            for page in running(folder):
                assert page.url.startswith(f"http://127.0.0.1:{server.port}/")
        path.unlink(missing_ok=True)
        path.mkdir()  # nor what is no file at all
        (folder / "page-x.json").symlink_to("/dev/zero")
        assert running(folder) == ()


def test_where_it_is_announced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("RUNTIME_DIRECTORY", raising=False)
    monkeypatch.delenv("XDG_RUNTIME_DIR", raising=False)
    assert runtime_folder(tmp_path) == tmp_path
    monkeypatch.setenv("XDG_RUNTIME_DIR", "/run/user/7")
    assert runtime_folder(tmp_path) == Path("/run/user/7/mocapd")
    monkeypatch.setenv("RUNTIME_DIRECTORY", "/run/mocapd:/run/other")
    assert runtime_folder(tmp_path) == Path("/run/mocapd")
