"""The outputs' benchmark encodes what is sent; how quickly is for its command to say."""

from pathlib import Path

import pytest

from lab import bench_outputs
from lab.bench_outputs import encoders, moving_frames, timed_ms
from mocapd.outputs.vmc.vrm_file import read_vrm
from tests.outputs.vmc.vrm_models import model, write_vrm


def test_every_output_has_its_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_vrm(tmp_path / "a.vrm", model(1))
    monkeypatch.setattr("sys.argv", ["bench_outputs", "--frames", "3", "--vrm", str(path)])
    bench_outputs.main()
    printed = capsys.readouterr().out
    for name in encoders(read_vrm(path)):
        assert f"| {name} " in printed


def test_the_person_moves() -> None:
    first, second = moving_frames(2)
    assert first.joints["leftHand"].p != second.joints["leftHand"].p
    assert all(joint.c == 1.0 for joint in first.joints.values())  # toes too are sent


def test_median_and_p95_are_in_order() -> None:
    median_ms, p95_ms = timed_ms(lambda frame: frame.seq, moving_frames(5))
    assert 0.0 < median_ms <= p95_ms
