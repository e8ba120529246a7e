"""GET /metrics: figures in Prometheus' format, for who has the key, from our own Host, and nothing else for it."""

import stat
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from prometheus_client.parser import text_string_to_metric_families

from mocapd.config.web_params import Params
from mocapd.errors import InputError
from mocapd.web.metrics_access import FILE_NAME
from mocapd.web.runtime_file import Place
from mocapd.web.server import WebServer
from tests.web.browser import get, origin_of, token_of
from tests.web.tiny_host import TinyHost


@pytest.fixture
def state_dir(tmp_path: Path) -> Path:
    return tmp_path / "state"


@pytest.fixture
def collected(host: TinyHost, tmp_path: Path, state_dir: Path) -> Iterator[WebServer]:
    """A page with figures."""
    died: list[BaseException] = []
    place = Place(tmp_path / "run", state_dir, "pc")
    with WebServer(host, Params(metrics=True), died.append, place) as one:
        yield one
    assert died == []


def key_of(state_dir: Path) -> str:
    return (state_dir / FILE_NAME).read_text().strip()


def asked(server: WebServer, key: str, path: str = "/metrics", **headers: str) -> httpx.Response:
    return get(server, path, {"authorization": f"Bearer {key}", **headers})


def figures(answer: httpx.Response) -> dict[tuple[str, tuple[str, ...]], float]:
    """Samples by name and values of labels, as a collector reads them."""
    return {
        (sample.name, tuple(sample.labels.values())): sample.value
        for family in text_string_to_metric_families(answer.text)
        for sample in family.samples
    }


def test_a_collector_with_the_key_gets_the_figures(collected: WebServer, state_dir: Path) -> None:
    answer = asked(collected, key_of(state_dir))
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("text/plain; version=")
    found = figures(answer)
    assert found["mocapd_frames_published_total", ()] == 100
    assert found["mocapd_frame_sets_dropped_total", ()] == 1
    assert found["mocapd_state", ("tracking",)] == 1
    assert found["mocapd_state", ("blind",)] == 0
    assert found["mocapd_camera_up", ("cam0",)] == 1
    assert found["mocapd_camera_up", ("cam1",)] == 0
    assert found["mocapd_output_sent_total", ("osc",)] == 99
    assert found["mocapd_output_listeners", ("osc",)] == 1
    assert found["process_resident_memory_bytes", ()] > 0
    assert found["mocapd_latency_seconds_bucket", ("0.03",)] == 2
    assert found["mocapd_latency_seconds_bucket", ("+Inf",)] == 3
    assert found["mocapd_latency_seconds_sum", ()] == pytest.approx(2.05)


def test_when_nothing_tracks_the_process_is_told_of(
    collected: WebServer, host: TinyHost, state_dir: Path
) -> None:
    host.tracks = False
    found = figures(asked(collected, key_of(state_dir)))
    assert ("process_open_fds", ()) in found
    assert ("mocapd_state", ("tracking",)) not in found


def test_the_key_is_kept_for_its_user_and_opens_nothing_else(
    collected: WebServer, state_dir: Path
) -> None:
    key = key_of(state_dir)
    assert stat.S_IMODE((state_dir / FILE_NAME).stat().st_mode) == 0o600
    for path in ("/", "/status", "/metrics/", "/page/app.js"):
        assert asked(collected, key, path).status_code == 401, path
    assert get(collected, "/metrics", {"authorization": f"bearer {key}"}).status_code == 200
    assert get(collected, "/metrics", token=token_of(collected)).status_code == 200


def test_nobody_else_gets_them(collected: WebServer, state_dir: Path) -> None:
    key = key_of(state_dir)
    assert get(collected, "/metrics").status_code == 401
    assert asked(collected, "wrong").status_code == 401
    no_text = {b"authorization": b"Bearer " + b"\xff" * 32}
    url = f"{origin_of(collected)}/metrics"
    assert httpx.get(url, headers=no_text, trust_env=False).status_code == 401
    assert get(collected, "/metrics", {"authorization": f"Basic {key}"}).status_code == 401
    assert asked(collected, key, host="example.org").status_code == 403
    assert asked(collected, key, origin="http://example.org").status_code == 403


def test_without_web_metrics_there_is_no_such_address(server: WebServer) -> None:
    assert asked(server, "wrong").status_code == 401
    assert get(server, "/metrics", token=token_of(server)).status_code == 404


def test_a_key_lasts_and_a_damaged_one_is_named(
    host: TinyHost, tmp_path: Path, state_dir: Path
) -> None:
    place = Place(tmp_path / "run", state_dir, "pc")
    with WebServer(host, Params(metrics=True), lambda error: None, place):
        before = key_of(state_dir)
    with WebServer(host, Params(metrics=True), lambda error: None, place) as again:
        assert asked(again, before).status_code == 200
    (state_dir / FILE_NAME).write_text("short\n")
    with pytest.raises(InputError, match=FILE_NAME):
        WebServer(host, Params(metrics=True), lambda error: None, place).start()
