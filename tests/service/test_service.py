"""A service whose session is replaced: outputs stay open and hear of what is new, and what was before is gone."""

import gc
import weakref
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import pytest

from mocapd.body.shape import mean_shape
from mocapd.config.sections import Config, SmoothingSection
from mocapd.outputs import output_table
from mocapd.outputs.messages import CalibrationInfo, CameraStatus, RestSkeleton
from mocapd.outputs.output_table import OutputEntry
from mocapd.service.service import Service
from mocapd.session.camera_inputs import CameraInput
from mocapd.session.session import Session
from mocapd.trackers.canned.tracker import CannedTracker
from mocapd.types import BodyState, Rig
from tests.capture.films import SIZE_PX
from tests.e2e.fake_cameras import FakeCamera
from tests.geometry.rigs import ring
from tests.outputs.frames import eventually
from tests.service.test_publisher import Recorder


@dataclass(frozen=True)
class Enabled:
    enabled: bool = True


@pytest.fixture
def sink(monkeypatch: pytest.MonkeyPatch) -> Recorder:
    """The only output of `config_of`."""
    recorder = Recorder()
    entry = OutputEntry(Enabled, lambda _section, _name: recorder)
    monkeypatch.setattr(output_table, "OUTPUTS", {"recorder": entry})
    return recorder


def config_of(preset: str = "balanced") -> Config:
    return Config(
        outputs={"recorder": Enabled()},
        smoothing=SmoothingSection(preset),
        state_dir=Path("/nonexistent"),
    )


def session_of(*names: str, stature_m: float = 1.75, rig: Rig | None = None) -> Session:
    inputs = tuple(CameraInput(FakeCamera(name), f"test-{name}", SIZE_PX) for name in names)
    source = "rig.json" if rig else ""
    return Session(inputs, rig, source, CannedTracker(), mean_shape(stature_m))


@pytest.fixture
def service(sink: Recorder) -> Iterator[Service]:
    with Service(config_of(), session_of("a", "b", rig=Rig(ring(2)))) as one:
        assert eventually(lambda: len(sink.frames) > 5)
        yield one


def test_frames_are_numbered_on_and_counted_on(service: Service, sink: Recorder) -> None:
    before = service.snapshot().metrics.sets_made
    service.replace(config_of(), session_of("a", "b"))
    count = len(sink.frames)
    assert eventually(lambda: len(sink.frames) > count + 5)
    assert all(b.seq == a.seq + 1 for a, b in pairwise(sink.frames))
    assert service.snapshot().metrics.sets_made > before
    assert not service.wait(0.0)


def test_a_camera_is_counted_on_over_a_reload(service: Service) -> None:
    """As its messages say: pictures since the start."""
    assert eventually(lambda: service.statuses()["a"].frames > 5)
    service.replace(config_of(), session_of("a", "c"))
    one, counts = service.snapshot().cameras["a"], service.snapshot().metrics.cameras["a"].counts
    assert one.frames > 5
    assert counts.received > 0
    assert service.statuses()["a"].frames >= one.frames
    now = {message.camera: message.frames for message in service.camera_messages()}
    assert now["a"] >= one.frames


class HeirTracker(CannedTracker):
    """Remembers whose body it was given."""

    def __init__(self) -> None:
        super().__init__()
        self.near: list[BodyState | None] = []

    def reset(self, near: BodyState | None = None) -> None:
        self.near.append(near)


@pytest.mark.parametrize("moved", [False, True])
def test_the_body_is_handed_on_where_the_cameras_stand_as_before(
    service: Service, moved: bool
) -> None:
    heir, rig = HeirTracker(), Rig(ring(2))
    if moved:
        rig = Rig(tuple(replace(camera, t_m=camera.t_m + 0.1) for camera in rig.cameras))
    service.replace(config_of(), replace(session_of("a", "b", rig=rig), tracker=heir))
    if moved:
        assert heir.near == []
    else:
        (body,) = heir.near
        assert body is not None
        assert body.pose is not None


def test_state_is_told_anew_also_of_cameras_that_are_no_more(
    service: Service, sink: Recorder
) -> None:
    sink.states.clear()
    service.replace(config_of(), session_of("b", "c", stature_m=1.9))
    service.publish_status(service.snapshot())
    (rest,) = (one for one in sink.states if isinstance(one, RestSkeleton))
    assert rest.stature_m == 1.9
    (calibration,) = (one for one in sink.states if isinstance(one, CalibrationInfo))
    assert calibration.cameras == ()
    told = {one.camera: one for one in sink.states if isinstance(one, CameraStatus)}
    assert told["a"].state == "ended"
    assert told["a"].detail == "no longer configured"
    assert told["b"].state != "ended"
    assert set(told) == {"a", "b", "c"}


def test_what_ran_before_is_let_go(service: Service, sink: Recorder) -> None:
    old = service.session
    tracker = weakref.ref(old.tracker)
    cameras = [one.source for one in old.cameras]
    del old
    service.replace(config_of("smooth"), session_of("a", "b"))
    count = len(sink.frames)
    assert eventually(lambda: len(sink.frames) > count + 5)
    gc.collect()
    assert tracker() is None
    assert all(isinstance(one, FakeCamera) and one.closed for one in cameras)
    assert service.config.smoothing.preset == "smooth"


def test_a_service_that_is_told_to_end_begins_no_other_session(
    service: Service, sink: Recorder
) -> None:
    service.end()
    service.replace(config_of(), session_of("a"))
    count = len(sink.frames)
    assert service.wait(0.1)
    assert len(sink.frames) == count
