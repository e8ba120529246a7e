"""Record and stop from the page: what is written, listed, named, downloaded and exported."""

import errno
import io
import json
import re
import stat
import tempfile
import time
import tracemalloc
from pathlib import Path

import httpx
import pytest

from mocapd.clock import monotonic_ns
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.outputs.messages import RestSkeleton
from mocapd.outputs.wire import SkeletonFrame
from mocapd.web.server import WebServer
from tests.clients.canned_daemon import canned_sample
from tests.web.browser import PATIENCE_S, get, origin_of, token_of
from tests.web.tiny_host import TinyHost

BODIES = 40
PERIOD_NS = 33_000_000


def posted(server: WebServer, path: str, message: object, origin: str = "") -> httpx.Response:
    """As the page does."""
    return httpx.post(
        f"{origin_of(server)}{path}?token={token_of(server)}",
        content=json.dumps(message),
        headers={"origin": origin or origin_of(server)},
        trust_env=False,
        verify=False,
        timeout=PATIENCE_S,
    )


def recorded(host: TinyHost, server: WebServer) -> dict[str, object]:
    """One recording of the canned person, as it is listed."""
    began = posted(server, "/recordings", {"verb": "start"})
    assert began.status_code == 200
    assert began.json()["now"] is not None
    begin_ns = monotonic_ns()
    for i in range(BODIES):
        host.bodies.put(canned_sample(host.skeleton, begin_ns + i * PERIOD_NS))
    told = posted(server, "/recordings", {"verb": "stop"}).json()
    assert told["now"] is None
    (one,) = told["recordings"]
    return dict(one)


def test_what_is_recorded_is_a_recording_like_any_other(
    host: TinyHost, server: WebServer, tmp_path: Path
) -> None:
    one = recorded(host, server)
    path = tmp_path / "recordings" / f"{one['id']}.mcap"
    found = list(RecordingReader(path).everything())
    assert sum(isinstance(item, SkeletonFrame) for item in found) == BODIES
    assert any(isinstance(item, RestSkeleton) for item in found)
    for written in (path, path.with_suffix(".json")):
        assert stat.S_IMODE(written.stat().st_mode) == 0o600, "it is of a person"
    answer = get(server, f"/recordings/{one['id']}", token=token_of(server))
    assert answer.content == path.read_bytes()
    assert re.search(r'attachment; filename="mocapd-\d{8}-\d{6}\.mcap"', str(answer.headers))


def test_one_may_begin_in_the_second_of_another(host: TinyHost) -> None:
    """Also where the clock was set back: here by ten minutes, in each second of which one was begun."""
    assert host.made is not None
    host.made.folder.mkdir()
    begin_s = time.time()
    for second in range(600):
        name = time.strftime("%Y%m%d-%H%M%S", time.localtime(begin_s + second))
        (host.made.folder / f"{name}.mcap").touch()
    host.made.start()
    host.made.stop()
    assert host.made.list().recordings[0].size_bytes > 0


def test_name_and_notes_are_kept_and_name_the_download(host: TinyHost, server: WebServer) -> None:
    one = recorded(host, server)
    note = {"verb": "note", "id": one["id"], "name": "Serve, no. 3", "notes": "left foot first"}
    (told,) = posted(server, "/recordings", note).json()["recordings"]
    assert (told["name"], told["notes"]) == ("Serve, no. 3", "left foot first")
    assert told["length_s"] == one["length_s"], "a note keeps what was measured"
    answer = get(server, f"/recordings/{one['id']}", token=token_of(server))
    assert 'filename="Serve-no.-3.mcap"' in answer.headers["content-disposition"]


def test_a_note_that_cannot_be_read_is_not_overwritten(
    host: TinyHost, server: WebServer, tmp_path: Path
) -> None:
    one = recorded(host, server)
    stored = tmp_path / "recordings" / f"{one['id']}.json"
    by_hand = '{"name": "Serve", "notes": "left foot first",}'
    stored.write_text(by_hand)
    (told,) = posted(
        server, "/recordings", {"verb": "note", "id": one["id"], "name": "Volley"}
    ).json()["recordings"]
    assert told["name"] == "Volley"
    (kept,) = stored.parent.glob("*.corrupt-*")
    assert kept.read_text() == by_hand


def test_it_is_exported_from_the_page(host: TinyHost, server: WebServer) -> None:
    one = recorded(host, server)
    answer = get(server, f"/recordings/{one['id']}/csv", token=token_of(server))
    assert answer.status_code == 200, answer.text
    assert answer.text.startswith("time_s,gap,")
    assert answer.text.count("\n") > BODIES // 2


def test_a_long_recording_is_never_whole_in_memory(
    host: TinyHost, server: WebServer, tmp_path: Path
) -> None:
    path = tmp_path / "recordings" / "20260101-000000.mcap"
    path.parent.mkdir()
    with path.open("wb") as file:
        file.truncate(64 << 20)
    tracemalloc.start()
    try:
        url = f"{origin_of(server)}/recordings/{path.stem}"
        with httpx.stream("GET", url, params={"token": token_of(server)}, trust_env=False) as got:
            assert sum(map(len, got.iter_raw())) == path.stat().st_size
        assert tracemalloc.get_traced_memory()[1] < 16 << 20
    finally:
        tracemalloc.stop()


def test_a_recording_that_cannot_be_read_ends_nothing(
    server: WebServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "recordings" / "20260101-000000.mcap"
    path.parent.mkdir()
    path.touch()

    def refuse(*_: object) -> None:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(io, "open", refuse)
    answer = get(server, f"/recordings/{path.stem}", token=token_of(server))
    monkeypatch.undo()
    assert answer.status_code == 503
    assert answer.json()["what"] == "cannot be read (Permission denied)"


def test_an_export_without_room_for_it_ends_nothing(
    host: TinyHost, server: WebServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = recorded(host, server)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "gone"))
    answer = get(server, f"/recordings/{one['id']}/csv", token=token_of(server))
    assert answer.status_code == 503
    assert "the export cannot be made" in answer.json()["what"]


@pytest.mark.parametrize(
    "path",
    [
        "/recordings/20260101-000000",
        "/recordings/..%2f..%2fcalibration",
        "/recordings/20260101-000000/csv",
    ],
)
def test_nothing_else_is_given_away(server: WebServer, path: str) -> None:
    assert get(server, path, token=token_of(server)).status_code in (404, 503)


def test_two_at_once_are_refused_and_garbage_is_not_understood(
    host: TinyHost, server: WebServer
) -> None:
    assert posted(server, "/recordings", {"verb": "start"}).status_code == 200
    again = posted(server, "/recordings", {"verb": "start"})
    assert again.status_code == 503
    assert "stop it first" in again.json()["fix"]
    assert posted(server, "/recordings", {"verb": "delete"}).status_code == 400
    assert posted(server, "/recordings", {"verb": "stop"}, "http://evil.example").status_code == 403
    assert host.made is not None
    host.made.close()


def test_a_folder_that_cannot_be_looked_into_ends_nothing(
    host: TinyHost, server: WebServer, tmp_path: Path
) -> None:
    # as of a state directory on a disk that is gone; too long a name fails alike, and for root as well
    assert host.made is not None
    host.made.folder = tmp_path / ("x" * 300)
    assert get(server, "/recordings", token=token_of(server)).json()["recordings"] == []
    file = get(server, "/recordings/20260101-000000", token=token_of(server))
    assert (file.status_code, file.json()["what"]) == (503, "there is no such recording")


def test_a_host_without_recordings_says_so(host: TinyHost, server: WebServer) -> None:
    host.made = None
    answer = get(server, "/recordings", token=token_of(server))
    assert (answer.status_code, answer.json()["fix"]) == (503, "start `mocapd run`")


def test_recenter_is_asked_from_the_page(host: TinyHost, server: WebServer) -> None:
    assert posted(server, "/recenter", {}).status_code == 200
    assert host.recentered == 1
    host.tracks = False
    refused = posted(server, "/recenter", {})
    assert refused.status_code == 503
    assert refused.json()["fix"] == "stand in view"
