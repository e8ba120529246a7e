"""The times of a video's frames, from the stamps of its file."""

from pathlib import Path

import numpy as np
import pytest

from mocapd.capture import video_times as video_times_module
from mocapd.capture.video_times import stored_times, times_of_stamps, video_times
from mocapd.types import Floats
from tests.capture.films import write_film


def test_a_constant_rate_is_the_files_and_not_another(tmp_path: Path) -> None:
    times = video_times(write_film(tmp_path / "a.avi", 20, 25.0))
    assert (times.rate_hz, times.is_constant, times.unknown, times.start_s) == (25.0, True, "", 0.0)
    assert times.times_s.tolist() == pytest.approx([f / 25.0 for f in range(20)], abs=1e-12)
    assert len(video_times(tmp_path / "a.avi", most_frames=7).times_s) == 7


@pytest.mark.parametrize(
    ("suffix", "code"), [(".avi", "MJPG"), (".mp4", "mp4v"), (".mkv", "mp4v"), (".webm", "VP80")]
)
def test_what_is_stored_has_the_times_of_what_is_decoded(
    tmp_path: Path, suffix: str, code: str
) -> None:
    path = write_film(tmp_path / f"a{suffix}", 20, 25.0, code=code)
    for most in (None, 7):
        decoded, stored = video_times(path, most), stored_times(path, most)
        np.testing.assert_array_equal(stored.times_s, decoded.times_s)
        assert (stored.rate_hz, stored.is_constant) == (decoded.rate_hz, decoded.is_constant)
        assert (stored.start_s, stored.unknown) == (decoded.start_s, decoded.unknown)


@pytest.mark.parametrize(("late", "decodes"), [(0.0, False), (0.01, True)])
def test_frames_stored_in_another_order_than_shown_are_decoded_only_if_their_rate_varies(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, late: float, decodes: bool
) -> None:
    path = write_film(tmp_path / "a.avi", 20, 25.0)
    true = video_times(path)
    read, opened = video_times_module._stamps, list[bool]()

    def reordered(path: Path, most: int | None, how: list[int]) -> tuple[Floats, Floats]:
        opened.append(not how)
        stamps_s, periods = read(path, most, how)
        if not how:
            return stamps_s, periods
        stamps_s[7] += late
        order = np.r_[0, 3, 1, 2, 6, 4, 5, 7 : len(stamps_s)]
        return stamps_s[order], periods[order]

    monkeypatch.setattr(video_times_module, "_stamps", reordered)
    np.testing.assert_array_equal(stored_times(path).times_s, true.times_s)
    assert any(opened) is decodes


def test_whole_milliseconds_are_still_a_constant_rate() -> None:
    times = times_of_stamps(np.round(np.arange(90) * 1000.0 / 30.0) * 1e-3, 30.0, 0.5)
    assert (times.is_constant, times.rate_hz, times.start_s) == (True, 30.0, 0.5)
    assert np.abs(times.times_s - np.arange(90) / 30.0).max() < 1e-9


def test_frames_that_a_recorder_dropped_are_gaps_of_so_many() -> None:
    kept = np.delete(np.arange(60), [10, 11, 12, 40])
    # the header of such a file gives frames over duration
    times = times_of_stamps(kept / 30.0, 28.0)
    assert times.gaps.tolist() == [[9, 3], [36, 1]]
    assert not times.is_constant
    assert times.rate_hz == pytest.approx(30.0)
    assert np.abs(times.times_s - kept / 30.0).max() < 1e-9


def test_a_rate_that_varies_keeps_each_stamp() -> None:
    stamps_s = np.cumsum(np.random.default_rng(0).uniform(0.025, 0.05, 100))
    times = times_of_stamps(stamps_s, 30.0)
    assert (times.is_constant, times.unknown) == (False, "")
    assert np.abs(times.times_s - (stamps_s - stamps_s[0])).max() < 1e-12


def test_another_rate_than_the_header_states_is_the_stamps() -> None:
    times = times_of_stamps(np.arange(300) / 25.0, 30.0)
    assert times.is_constant
    assert times.rate_hz == pytest.approx(25.0)


@pytest.mark.parametrize(
    "stamps_s",
    [
        np.zeros(30),
        np.r_[np.arange(10), 5.0, np.arange(11, 20)] / 30.0,
        np.r_[np.arange(10) / 30.0, np.nan],
        np.r_[np.arange(10) / 30.0, 9000.0],
        np.arange(10) * 1e-6,
    ],
)
def test_nonsense_stamps_are_unknown_and_the_header_holds(stamps_s: Floats) -> None:
    times = times_of_stamps(stamps_s, 30.0)
    assert times.unknown
    assert times.times_s.tolist() == pytest.approx([f / 30.0 for f in range(len(stamps_s))])


def test_one_frame_has_a_time() -> None:
    times = times_of_stamps(np.array([0.0]), 30.0)
    assert (times.times_s.tolist(), times.unknown) == ([0.0], "")
