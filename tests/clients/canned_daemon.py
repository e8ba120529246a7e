"""What a game hears of a daemon on the canned tracker, without cameras: its publisher and any outputs."""

import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import numpy as np

from mocapd.body.shape import mean_shape
from mocapd.body.skeleton import joint_positions, standard_skeleton
from mocapd.clock import monotonic_ns
from mocapd.outputs.base import Sink
from mocapd.pipeline.body_hub import BodySample
from mocapd.service.publisher import Publisher
from mocapd.trackers.canned.canned_motion import CannedMotion
from mocapd.trackers.canned.tracker import canned_pose
from mocapd.tracking.base import Track
from mocapd.types import BodyState, FrameSet, Skeleton, Tracking

STATURE_M = 1.75
INSTANCE = "pc"
EVERY_S = 0.01


def canned_sample(skeleton: Skeleton, t_ns: int) -> BodySample:
    """The body at that time, as the pipeline leaves it."""
    pose = canned_pose(skeleton, CannedMotion(), t_ns)
    joints_m = joint_positions(skeleton, pose)
    confidence = np.ones(len(joints_m))
    state = BodyState(t_ns, Tracking.LIVE, "canned", pose, joints_m, confidence)
    return BodySample(Track(state, mean_shape(STATURE_M)), skeleton, FrameSet(t_ns, {}))


@contextmanager
def canned_daemon(*sinks: Sink) -> Iterator[None]:
    """A body every EVERY_S through these, which are opened and closed here, until the block is left."""
    enough = threading.Event()
    skeleton = standard_skeleton(STATURE_M)
    with ExitStack() as opened:
        for sink in sinks:
            sink.open()
            opened.callback(sink.close)
        publisher = Publisher(sinks, INSTANCE)
        publisher.begin(skeleton, STATURE_M)

        def publish() -> None:
            while not enough.wait(EVERY_S):
                publisher.put(canned_sample(skeleton, monotonic_ns()))

        thread = threading.Thread(target=publish)
        thread.start()
        try:
            yield
        finally:
            enough.set()
            thread.join()
