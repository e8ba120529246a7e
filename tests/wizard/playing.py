"""Simulated frame sets for a hub, by a wearer who moves as slowly as a busy machine can follow."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from mocapd.clock import monotonic_ns
from mocapd.pipeline.bundler import BundlerParams
from mocapd.types import Frame, FrameSet
from tests.cli.own_time import own_time
from tests.wizard.context import FakeContext

_WAIT_S = 30.0  # that a set waits for its last frame: the thread that puts it may be kept from the processor


@contextmanager
def playing(
    context: FakeContext, frame_set: Callable[[int], FrameSet], period_s: float
) -> Iterator[None]:
    """Frame sets by number go to the hub, one every `period_s` of this process's own time, and tell that time."""
    stop = threading.Event()
    context.hub.bundler = BundlerParams(camera_waits_s=dict.fromkeys(context.hub.names, _WAIT_S))

    def play() -> None:
        begin_ns, own_s = monotonic_ns(), own_time()
        number = 0
        while not stop.wait(max(0.0, number * period_s - own_s())):
            if own_s() < number * period_s:
                continue
            frames = frame_set(number)
            first_ns = min(frame.t_ns for frame in frames.frames.values())
            for name, frame in frames.frames.items():
                t_ns = begin_ns + round(1e9 * number * period_s) + frame.t_ns - first_ns
                context.hub.put(Frame(name, number, t_ns, frame.pixels))
            number = max(number + 1, int(own_s() / period_s))

    thread = threading.Thread(target=play)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()
