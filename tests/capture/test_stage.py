"""Scenes that follow one another before simulated webcams: no stall, and all cameras at one frame."""

import threading
from itertools import pairwise

import numpy as np
import pytest

from mocapd.capture.simulated.stage import SceneSource, Stage
from mocapd.clock import monotonic_ns
from mocapd.errors import CameraLost, ConfigError
from mocapd.sim.clips import Clip, wearer_clips
from mocapd.sim.film import Film, encode_jpeg
from mocapd.sim.setup_record import SimSetup
from mocapd.sim.setup_scenes import WEARER_S, SetupScene
from mocapd.sim.world import rig_of
from mocapd.types import Frame
from tests.sim.small import scenario

PERIOD_NS = 1e9 / 30
CAMERAS = ("left", "right")
STEP = 40  # grey values between the pictures of a clip
SCENES = {SetupScene.EMPTY: 1, SetupScene.LENS: 3, SetupScene.FLOOR: 2}


def grey(value: int) -> bytes:
    return encode_jpeg(np.full((16, 16, 3), value, np.uint8), 95)


def stage(epoch_ns: int | None = None) -> Stage:
    """Scenes of grey pictures: that of `SCENES[scene]` in the tens, its frame in the fortieths."""
    clips = {}
    for scene, tens in SCENES.items():
        pictures = [grey(10 * tens + STEP * i) for i in range(5)]
        clips[scene] = Clip(range(5), dict.fromkeys(CAMERAS, pictures))
    return Stage(scenario(), clips, epoch_ns)


def shown(frame: Frame) -> tuple[int, int]:
    """Tens of the scene and number of the frame in it."""
    value = round(float(frame.pixels.mean()))
    return value % STEP // 10, value // STEP


def frame_number(source: SceneSource, frame: Frame) -> int:
    return round((frame.t_ns - source.exposure_ns(0)) / PERIOD_NS)


def test_a_scene_begins_with_the_next_frame_and_nothing_stalls() -> None:
    played = stage()
    source = SceneSource(played, "left")
    source.open()
    frames = [source.read() for _ in range(3)]
    assert {shown(frame)[0] for frame in frames} == {SCENES[SetupScene.EMPTY]}
    start = played.play("lens")
    assert (
        start
        <= frame_number(source, frames[-1]) + 2 + (monotonic_ns() - frames[-1].t_ns) // PERIOD_NS
    )
    after = [source.read() for _ in range(7)]
    source.close()
    for frame in after:
        n = frame_number(source, frame)
        if n >= start:
            assert shown(frame) == (SCENES[SetupScene.LENS], (n - start) % 5)
        else:
            assert shown(frame)[0] == SCENES[SetupScene.EMPTY]
    assert frame_number(source, after[-1]) >= start
    for a, b in pairwise([*frames, *after]):
        assert b.seq > a.seq
        assert b.t_ns - a.t_ns == pytest.approx((b.seq - a.seq) * PERIOD_NS, abs=2000)


def test_all_cameras_show_the_same_frame_of_a_scene() -> None:
    played = stage(epoch_ns=monotonic_ns() - 5_000_000_000)
    start = played.play(SetupScene.FLOOR)
    for n in range(start - 2, start + 12):
        assert played.jpeg("left", n) == played.jpeg("right", n)
    assert played.jpeg("left", start) == grey(10 * SCENES[SetupScene.FLOOR])
    left, right = (SceneSource(played, name) for name in CAMERAS)
    assert right.exposure_ns(start) - left.exposure_ns(start) == 11_000_000


def test_the_scene_that_is_played_goes_on_and_one_never_seen_leaves_no_trace() -> None:
    far_ns = 3600 * 1_000_000_000
    played = stage(epoch_ns=monotonic_ns() - far_ns)
    start = played.play("lens")
    assert played.play("lens") == start
    early = stage(epoch_ns=monotonic_ns() + far_ns)  # frame 0 is still to come
    assert early.play("lens") == 0
    assert early.play("floor") == 0
    assert early.jpeg("left", 0) == grey(10 * SCENES[SetupScene.FLOOR])


def test_what_there_is_not_is_refused() -> None:
    with pytest.raises(ValueError):
        stage().play("dinner")
    with pytest.raises(ConfigError, match="middle"):
        SceneSource(stage(), "middle")


def test_close_wakes_a_blocked_read() -> None:
    source = SceneSource(stage(epoch_ns=monotonic_ns() + 3600 * 1_000_000_000), "left")
    source.open()
    lost: list[CameraLost] = []

    def read() -> None:
        try:
            source.read()
        except CameraLost as error:
            lost.append(error)

    reader = threading.Thread(target=read)
    reader.start()
    source.close()
    reader.join(5.0)
    assert len(lost) == 1


def test_the_wearers_scenes_are_played_forth_and_back() -> None:
    seconds = max(end for _, end in WEARER_S.values())
    long = scenario(loop_s=seconds)
    frames = {name: tuple(b"%d" % i for i in range(round(30 * seconds))) for name in CAMERAS}
    film = Film(long, 0, frames, SimSetup(rig_of(long), 1.75, {}, ()))
    clips = wearer_clips(film)
    assert set(clips) == set(WEARER_S)
    for scene, (start_s, end_s) in WEARER_S.items():
        loop = [int(clips[scene].jpeg("left", n)) for n in range(2 * len(clips[scene].order))]
        assert all(abs(b - a) == 1 for a, b in pairwise(loop))
        assert (min(loop), max(loop)) == (round(30 * start_s), round(30 * end_s) - 1)
