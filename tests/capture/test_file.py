"""A video file as a camera: numbering, time, pacing, and files that are not whole."""

import struct
import threading
from pathlib import Path

import pytest

from mocapd.capture.file import FileSource, probe_video
from mocapd.capture.pace import Pace
from mocapd.clock import NS_PER_S, monotonic_ns
from mocapd.errors import CameraLost, ConfigError, EndOfStream, InputError
from mocapd.types import Frame
from tests.capture.films import number_of, write_film


def read_all(source: FileSource) -> tuple[list[Frame], EndOfStream]:
    source.open()
    frames: list[Frame] = []
    while True:
        try:
            frames.append(source.read())
        except EndOfStream as end:
            source.close()
            return frames, end


def test_offline_gives_every_frame_with_the_time_of_its_index(tmp_path: Path) -> None:
    source = FileSource("a", write_film(tmp_path / "a.avi", 20, 25.0), time_offset_s=0.0105)
    frames, end = read_all(source)
    assert [number_of(frame.pixels) for frame in frames] == list(range(20))
    assert [frame.seq for frame in frames] == list(range(20))
    assert [frame.t_ns for frame in frames] == [40_000_000 * f + 10_500_000 for f in range(20)]
    assert "20 frames" in str(end)


def test_the_given_rate_wins_over_the_files_own(tmp_path: Path) -> None:
    frames, _ = read_all(FileSource("a", write_film(tmp_path / "a.avi", 4, 25.0), fps_hz=50.0))
    assert [frame.t_ns for frame in frames] == [0, 20_000_000, 40_000_000, 60_000_000]


def test_live_frames_come_no_earlier_than_they_are_due(tmp_path: Path) -> None:
    source = FileSource("a", write_film(tmp_path / "a.avi", 60, 60.0), pace=Pace(live=True))
    source.open()
    began_ns = monotonic_ns()
    arrivals: list[tuple[Frame, int]] = []
    while True:
        try:
            frame = source.read()
        except EndOfStream:
            break
        arrivals.append((frame, monotonic_ns()))
    source.close()
    assert all(arrival_ns >= frame.t_ns for frame, arrival_ns in arrivals)
    first = arrivals[0][0]
    assert first.t_ns >= began_ns  # stamped on the live clock
    for frame, _ in arrivals:  # the stamp is that of the index, whenever the reader came
        want_ns = first.t_ns + round((frame.seq - first.seq) * NS_PER_S / 60.0)
        assert abs(frame.t_ns - want_ns) <= 1
        assert number_of(frame.pixels) == frame.seq


def test_a_slow_reader_skips_frames_as_a_webcam_would(tmp_path: Path) -> None:
    source = FileSource("a", write_film(tmp_path / "a.avi", 250, 100.0), pace=Pace(live=True))
    source.open()
    first = source.read()
    threading.Event().wait(0.2)
    late = source.read()
    source.close()
    assert late.seq - first.seq >= 15
    assert number_of(late.pixels) == late.seq


def test_files_of_one_pace_stay_in_step_though_one_opens_later(tmp_path: Path) -> None:
    pace = Pace(live=True)
    film = write_film(tmp_path / "a.avi", 250, 100.0)
    early, late = FileSource("a", film, pace=pace), FileSource("b", film, pace=pace)
    early.open()
    start = early.read()
    threading.Event().wait(0.1)
    late.open()
    frame = late.read()
    assert frame.t_ns - start.t_ns == (frame.seq - start.seq) * 10_000_000
    assert frame.seq >= 8
    early.close()
    late.close()


def test_close_wakes_a_reader_that_waits_for_its_frame(tmp_path: Path) -> None:
    source = FileSource("a", write_film(tmp_path / "a.avi", 3, 0.1), fps_hz=0.1, pace=Pace(True))
    source.open()
    source.read()
    woken = threading.Event()

    def reader() -> None:
        with pytest.raises(CameraLost):
            source.read()  # due in ten seconds
        woken.set()

    thread = threading.Thread(target=reader)
    thread.start()
    source.close()
    assert woken.wait(5.0)
    thread.join()


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"gone\.avi: no such video file"):
        FileSource("a", tmp_path / "gone.avi").open()


@pytest.mark.parametrize("content", [b"", b"this is no video" * 100])
def test_what_is_not_a_video_is_an_input_error(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.mp4"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.mp4"):
        FileSource("a", path).open()
    with pytest.raises(InputError, match=r"a\.mp4"):
        probe_video(path)


@pytest.mark.parametrize(
    ("code", "named"),
    [(b"VVC1", r"H\.266 \(VVC\)"), (b"APV1", "APV"), (b"IV50", "the codec 'IV50'")],
)
def test_a_codec_that_cannot_be_decoded_is_named(tmp_path: Path, code: bytes, named: str) -> None:
    path = tmp_path / "a film.avi"
    path.write_bytes(write_film(tmp_path / "a.avi", 5).read_bytes().replace(b"MJPG", code))
    convert = r"convert it to H\.264 .*ffmpeg -i 'a film\.avi' .* 'a film-h264\.mp4'"
    with pytest.raises(InputError, match=rf"a film\.avi: {named} cannot be read here -- {convert}"):
        probe_video(path)


def test_av1_is_named(shared_dir: Path) -> None:
    video = shared_dir / "findings/reports-2026-11-26/08-av1/right.mkv"
    if not video.exists():
        pytest.skip("no such finding here")
    with pytest.raises(InputError, match=r"AV1 cannot be read here -- convert it to H\.264"):
        probe_video(video)


@pytest.mark.parametrize("code", [b"H264", b"HEVC", b"VP90"])
def test_damage_is_not_taken_for_the_codec(tmp_path: Path, code: bytes) -> None:
    data = write_film(tmp_path / "a.avi", 5).read_bytes().replace(b"MJPG", code)
    path = tmp_path / "b.avi"
    path.write_bytes(data.replace(b"\xff\xd8\xff", bytes(3)))
    with pytest.raises(InputError, match="holds no frame that can be decoded -- record it again"):
        probe_video(path)


def test_a_film_cut_short_delivers_what_is_there_and_says_how_much(tmp_path: Path) -> None:
    whole = write_film(tmp_path / "a.avi", 40).read_bytes()
    cut = tmp_path / "cut.avi"
    cut.write_bytes(whole[: len(whole) // 2])
    frames, end = read_all(FileSource("a", cut))
    assert 5 < len(frames) < 35
    assert [number_of(frame.pixels) for frame in frames] == list(range(len(frames)))
    assert f"after {len(frames)} of the 40 frames" in str(end)
    assert end.fix


def test_frames_after_a_damaged_one_keep_their_index(tmp_path: Path) -> None:
    path = write_film(tmp_path / "a.avi", 20)
    data = bytearray(path.read_bytes())
    starts = [i for i in range(len(data) - 2) if data[i : i + 3] == b"\xff\xd8\xff"]
    data[starts[7] : starts[8] - 8] = bytes(starts[8] - 8 - starts[7])  # no JPEG any more
    path.write_bytes(data)
    source = FileSource("a", path)
    frames, end = read_all(source)
    assert [frame.seq for frame in frames] == [f for f in range(20) if f != 7]
    assert all(number_of(frame.pixels) == frame.seq for frame in frames)
    assert source.torn == 1
    assert not end.fix


def test_another_size_than_the_calibration_names_both(tmp_path: Path) -> None:
    source = FileSource("left", write_film(tmp_path / "a.avi", 3), size_px=(640, 480))
    with pytest.raises(ConfigError, match=r"64x48.*'left'.*640x480"):
        source.open()


@pytest.mark.parametrize(
    ("scale", "rate", "frames"), [(2**31, 1, 30), (1, 2**31, 30), (1, 30, 2**32 - 1)]
)
def test_what_a_header_cannot_mean_is_not_believed(
    tmp_path: Path, scale: int, rate: int, frames: int
) -> None:
    path = write_film(tmp_path / "a.avi", 30)
    data = bytearray(path.read_bytes())
    stream = data.index(b"strh") + 8
    data[stream + 20 : stream + 28] = struct.pack("<II", scale, rate)
    data[stream + 32 : stream + 36] = struct.pack("<I", frames)
    path.write_bytes(data)
    info = probe_video(path)
    assert (info.fps_hz, info.frames) == (30.0, 30 if frames == 30 else 0)
    source = FileSource("a", path, pace=Pace(live=True))
    came, end = read_all(source)
    start_ns = came[0].t_ns - round(came[0].seq * NS_PER_S / 30.0)
    for frame in came:  # at 30 Hz, each at its time; a reader that is late skips some
        assert number_of(frame.pixels) == frame.seq
        assert abs(frame.t_ns - start_ns - round(frame.seq * NS_PER_S / 30.0)) <= 1
    assert "all of its 30 frames" in str(end)


def test_pictures_larger_than_any_cameras_are_refused_before_they_are_decoded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mocapd.capture.file.MOST_PIXELS", 64 * 48 - 1)
    with pytest.raises(InputError, match="64x48, at most 3071 pixels"):
        probe_video(write_film(tmp_path / "a.avi", 3))
