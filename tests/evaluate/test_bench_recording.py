"""The figures of recording are made and told."""

from pathlib import Path

import pytest

from mocapd.errors import InputError
from mocapd.evaluate.bench import bench_recording
from tests.outputs.recorded import frames, record


def test_figures_of_a_short_hour(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(bench_recording, "KILLED_AFTER_S", (0.7,))
    path = record(tmp_path / "a.mcap", frames(1.0))
    found = bench_recording.recording_cost(path, hours=20.0 / 3600.0)
    alone, usual, exact = found.mb_an_hour
    assert alone < usual < exact
    assert usual < 130.0  # of twenty seconds, which carry the schemas of an hour
    assert len(found.lost_s) == 1
    assert -0.1 < found.lost_s[0] < 0.7
    assert not caplog.messages  # of its own temporary file
    assert len(bench_recording.as_lines(found)) == 3


def test_nobody_in_it_is_named(tmp_path: Path) -> None:
    path = record(tmp_path / "a.mcap", [])
    with pytest.raises(InputError):
        bench_recording.recording_cost(path, hours=1.0)
