"""Real footage in which nobody wears the shirt: nobody is found, live or offline."""

import json
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import pytest

from mocapd.calibration.calibration_record import Calibration, Wearer
from mocapd.capture.file import FileSource
from mocapd.config.sections import CameraSection
from mocapd.errors import EndOfStream
from mocapd.geometry.nominal_rig import nominal_rig
from mocapd.geometry.rig_file import load_rig
from mocapd.session.camera_inputs import picture_size
from mocapd.session.offline import track_all
from mocapd.session.tracker_setup import cache_resources, ready_tracker
from mocapd.types import Frame, FrameSet, Rig
from tests.cli.mocapd_process import mocapd, start
from tests.conftest import ABSENT, SHARED
from tests.outputs.frames import free_port

pytestmark = pytest.mark.kernels

CLIPS = tuple(sorted(path.stem for path in SHARED.glob("realvideo/intel_asl/*.mkv")))
RIGS = ("pose2sim_SinglePerson", "caliscope_charuco")
SETS = 57  # of several cameras: large pictures, which take long to read
FEWEST_HEARD = 3  # frames of a daemon


@pytest.fixture(scope="session")
def real_video(shared_dir: Path) -> Path:
    folder = shared_dir / "realvideo"
    if not (folder / "intel_asl").is_dir():
        pytest.skip(ABSENT.format("realvideo/intel_asl"))
    return folder


@pytest.fixture
def cache_dir(cache_home: Path) -> Path:
    return cache_home / "mocapd"


def write_rig(folder: Path, out: Path) -> Path:
    """The rig file of a folder's calibration."""
    entries = json.loads((folder / "calib_opencv.json").read_text())["cameras"]
    fields = {"name": "name", "image_size": "size", "K": "K", "dist": "dist", "R": "R", "t": "t"}
    cameras = [{ours: entry[theirs] for theirs, ours in fields.items()} for entry in entries]
    path = out / "rig.json"
    path.write_text(json.dumps({"cameras": cameras}))
    return path


def frames_of(name: str, video: Path) -> Iterator[Frame]:
    source = FileSource(name, video)
    source.open()
    try:
        while True:
            yield source.read()
    except EndOfStream:
        source.close()


def found_in(rig: Rig, sets: Iterator[FrameSet], cache_dir: Path) -> list[float]:
    """The times at which the tracker `shirt` sees somebody [s]; the pictures alone tell it who."""
    resources = cache_resources(cache_dir, lambda *_: None)
    ready = ready_tracker("shirt", Calibration(rig, Wearer(1.75)), resources)
    track = track_all(ready.tracker, ready.shape, sets, _nobody)
    return [float(t) for t in track.times_s]


def _nobody(_: int) -> None: ...


def test_the_clips_are_found(real_video: Path) -> None:
    assert len(CLIPS) == 10


@pytest.mark.parametrize("clip", CLIPS)
def test_no_skeleton_is_invented_from_one_webcam(
    clip: str, real_video: Path, cache_dir: Path
) -> None:
    video = real_video / "intel_asl" / f"{clip}.mkv"
    rig = nominal_rig("cam0", picture_size(CameraSection("cam0", str(video))))
    sets = (FrameSet(one.t_ns, {"cam0": one}) for one in frames_of("cam0", video))
    assert found_in(rig, sets, cache_dir) == []


@pytest.mark.parametrize("folder", RIGS)
def test_no_skeleton_is_invented_from_several_cameras(
    folder: str, real_video: Path, tmp_path: Path, cache_dir: Path
) -> None:
    rig = load_rig(write_rig(real_video / folder, tmp_path))
    videos = {name: real_video / folder / f"{name}.mp4" for name in rig.names}
    together = zip(*(frames_of(name, video) for name, video in videos.items()), strict=False)
    sets = (FrameSet(f[0].t_ns, {one.camera: one for one in f}) for f in islice(together, SETS))
    assert found_in(rig, sets, cache_dir) == []


@pytest.mark.parametrize(
    ("folder", "files"),
    [
        ("intel_asl", ("hungry.mkv",)),
        ("caliscope_charuco", ("cam_0.mp4", "cam_1.mp4", "cam_2.mp4", "cam_3.mp4")),
    ],
)
def test_the_daemon_publishes_lost_while_it_plays_them_at_their_own_pace(
    folder: str,
    files: tuple[str, ...],
    real_video: Path,
    clean_env: dict[str, str],
    tmp_path: Path,
) -> None:
    port = free_port()
    words: list[str | Path] = ["run", "--set", f"zenoh.port={port}", "--set", "osc.enabled=false"]
    words += ["--set", "web.enabled=false"]
    for name in files:
        words += ["--camera", f"{name.partition('.')[0]}={real_video / folder / name}"]
    if len(files) > 1:
        words += ["--rig", write_rig(real_video / folder, tmp_path)]
    daemon = start(clean_env, *words)
    endpoint = f"tcp/127.0.0.1:{port}"
    count = ("--count", str(FEWEST_HEARD), "--timeout", "200")
    try:
        heard = mocapd(clean_env, "watch", "--endpoint", endpoint, "--json", *count)
        daemon.terminate()  # some play on for long
        _, log = daemon.communicate(timeout=60)
    finally:
        daemon.kill()
        daemon.communicate()
    assert daemon.returncode == 0, log
    assert heard.code == 0, heard.err
    frames = [json.loads(line) for line in heard.out.splitlines()]
    assert len(frames) >= FEWEST_HEARD
    assert {frame["tracking"] for frame in frames} == {"lost"}
    assert not any(frame["joints"] for frame in frames)
    assert ("not calibrated" in log) == (len(files) == 1)
