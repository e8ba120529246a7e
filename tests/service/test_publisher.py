"""What outputs are given: every frame under the next number, and the rest skeleton when it is another."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.shape import mean_shape
from mocapd.clock import NS_PER_S
from mocapd.errors import UnavailableError
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.messages import RestSkeleton, StateMessage
from mocapd.outputs.wire import SkeletonFrame
from mocapd.pipeline.body_hub import BodySample
from mocapd.service.publisher import REST_EVERY_NS, Publisher
from mocapd.tracking.base import Track
from mocapd.types import BodyState, FrameSet, Skeleton, Tracking
from tests.outputs.frames import left_hand_up

BODY, SKELETON = left_hand_up()
FRAME_NS = NS_PER_S // 30


class Recorder:
    """Keeps what it is given."""

    name = "recorder"

    def __init__(self) -> None:
        self.frames: list[SkeletonFrame] = []
        self.states: list[StateMessage] = []

    def open(self) -> None: ...

    def send(self, frame: SkeletonFrame) -> None:
        self.frames.append(frame)

    def send_state(self, message: StateMessage) -> None:
        self.states.append(message)

    def status(self) -> SinkStatus:
        return SinkStatus(len(self.frames), 0, -1, "")

    def close(self) -> None: ...

    def statures_m(self) -> list[float]:
        return [one.stature_m for one in self.states if isinstance(one, RestSkeleton)]


class Run:
    """A publisher whose clock is moved by hand."""

    def __init__(self) -> None:
        self.now_ns = NS_PER_S
        self.sink = Recorder()
        self.publisher = Publisher([self.sink], "pc", lambda: self.now_ns)
        self.publisher.begin(SKELETON, 1.75)

    def publish(self, skeleton: Skeleton, for_ns: int) -> None:
        until_ns = self.now_ns + for_ns
        while self.now_ns < until_ns:
            self.now_ns += FRAME_NS
            self.publisher.put(
                BodySample(Track(BODY, mean_shape(1.75)), skeleton, FrameSet(BODY.t_ns, {}))
            )


def grown(by: float) -> Skeleton:
    return replace(SKELETON, rest_m=SKELETON.rest_m * by)


def test_the_rest_skeleton_is_told_before_the_first_frame_and_not_with_each() -> None:
    run = Run()
    assert run.sink.statures_m() == [1.75]
    run.publish(SKELETON, 5 * NS_PER_S)
    assert len(run.sink.states) == 1
    assert [frame.seq for frame in run.sink.frames] == list(range(len(run.sink.frames)))


def test_what_is_learned_of_the_body_is_told_when_it_is_noticeable_and_once_a_second_at_most() -> (
    None
):
    run = Run()
    run.publish(grown(1.001), 3 * NS_PER_S)
    assert len(run.sink.states) == 1
    for percent in range(1, 31):
        run.publish(grown(1.0 + percent / 100), REST_EVERY_NS // 10)
    assert 3 <= len(run.sink.states) <= 5
    run.publish(grown(1.3), 2 * NS_PER_S)
    newest = run.sink.states[-1]
    assert isinstance(newest, RestSkeleton)
    assert abs(newest.offsets_m[0][1] - 1.3 * SKELETON.rest_m[0, 1]) < 1e-9


def test_another_session_goes_on_counting_and_tells_its_wearer() -> None:
    run = Run()
    run.publish(SKELETON, NS_PER_S)
    run.publisher.begin(SKELETON, 1.9)
    run.publish(SKELETON, NS_PER_S)
    assert run.sink.statures_m() == [1.75, 1.9]
    assert [frame.seq for frame in run.sink.frames] == list(range(len(run.sink.frames)))


def test_a_recentre_tells_which_way_the_newest_person_faces() -> None:
    run = Run()
    seen = replace(BODY, confidence=np.ones(len(SKELETON.names)))

    def put(body: BodyState) -> None:
        frames = FrameSet(body.t_ns, {})
        run.publisher.put(BodySample(Track(body, mean_shape(1.75)), SKELETON, frames))

    with pytest.raises(
        UnavailableError, match=r"no person in view.*stand where the cameras see you"
    ):
        run.publisher.recenter()
    put(seen)
    facing = run.publisher.recenter()
    assert run.sink.states[-1] is facing
    assert facing.yaw_deg == pytest.approx(0.0)
    assert (facing.instance, facing.person) == ("pc", run.sink.frames[-1].person)
    assert facing.at_unix_ns == run.sink.frames[-1].capture_unix_ns
    lost = replace(seen, tracking=Tracking.LOST, pose=None, joints_m=None)
    hidden = replace(seen, confidence=np.full(len(SKELETON.names), 0.1))
    for body in (lost, replace(seen, tracking=Tracking.COASTING), hidden):
        put(body)
        with pytest.raises(UnavailableError):
            run.publisher.recenter()
    put(seen)
    assert run.publisher.recenter().yaw_deg == pytest.approx(0.0)
