"""The hub of bodies: the newest for who looks, every one for who joins."""

import numpy as np

from mocapd.body.shape import mean_shape, skeleton_of
from mocapd.pipeline.body_hub import BodyHub, BodySample
from mocapd.tracking.base import Track
from mocapd.types import BodyState, FrameSet, Tracking

SHAPE = mean_shape(1.75)


class Taker:
    def __init__(self) -> None:
        self.t_ns: list[int] = []

    def put(self, sample: BodySample) -> None:
        self.t_ns.append(sample.body.t_ns)


def sample(t_ns: int) -> BodySample:
    nobody = BodyState(t_ns, Tracking.LOST, "test", None, None, np.zeros(22))
    return BodySample(Track(nobody, SHAPE), skeleton_of(SHAPE), FrameSet(t_ns, {}))


def test_the_newest_is_there_for_who_looks_until_it_no_longer_holds() -> None:
    hub = BodyHub()
    assert hub.newest() is None
    for t_ns in range(3):
        hub.put(sample(t_ns))
    newest = hub.newest()
    assert newest is not None
    assert newest.body.t_ns == 2
    hub.forget()
    assert hub.newest() is None


def test_who_joins_gets_every_body_until_he_leaves() -> None:
    always, sometimes = Taker(), Taker()
    hub = BodyHub(always)
    hub.put(sample(0))
    hub.join(sometimes)
    hub.put(sample(1))
    hub.put(sample(2))
    hub.leave(sometimes)
    hub.leave(sometimes)
    hub.put(sample(3))
    assert always.t_ns == [0, 1, 2, 3]
    assert sometimes.t_ns == [1, 2]
