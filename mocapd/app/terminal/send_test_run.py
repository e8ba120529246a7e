"""Implementation of `mocapd send-test`: sends a synthetic person to one output, and reports whether it is received."""

import sys
import time
from contextlib import closing

from mocapd.app.terminal.waving_person import waving_person
from mocapd.body.shape import mean_shape
from mocapd.clock import NS_PER_S, monotonic_ns, nanoseconds
from mocapd.geometry.nominal_rig import nominal_rig
from mocapd.outputs.base import Sink, SinkStatus
from mocapd.outputs.from_rig import calibration_info
from mocapd.outputs.osc.osc_sink import NO_RECEIVER, SENDING
from mocapd.service.publisher import Publisher

RATE_HZ = 60.0
STATURE_M = 1.75
NAME = "send-test"  # of the fictitious camera and its calibration
CAMERA_PX = (640, 480)
FEWEST = 3  # frames; with fewer a refusal may go unnoticed
NOBODY_LISTENS = 1  # exit code
SAY_EVERY_NS = NS_PER_S
_REASONS = {
    NO_RECEIVER: "its port refused the frames",
    SENDING: "whether anybody listens there is not told",
}


def send_test(sink: Sink, instance: str, duration_s: float) -> int:
    """Sends for `duration_s` [s], with a report each second; returns the exit code. Raises errors of opening the sink."""
    shape = mean_shape(STATURE_M)
    publisher = Publisher([sink], instance)
    with closing(sink):
        sink.open()
        print("a person waves its left hand, and steps to its left and back", file=sys.stderr)
        # some receivers freeze the avatar while a sender reports no calibration
        rig = nominal_rig(NAME, CAMERA_PX)
        publisher.publish_state(calibration_info(rig, instance=instance, source=NAME))
        publisher.begin(waving_person(shape, 0, 0).skeleton, STATURE_M)
        frames, said, halfway = 0, 0, None
        began_ns, lasts_ns = monotonic_ns(), nanoseconds(duration_s)
        while (gone_ns := monotonic_ns() - began_ns) < lasts_ns or frames < FEWEST:
            publisher.put(waving_person(shape, gone_ns, monotonic_ns()))
            frames += 1
            if halfway is None and 2 * gone_ns >= lasts_ns:
                halfway = sink.status()
            if gone_ns // SAY_EVERY_NS > said:
                said = gone_ns // SAY_EVERY_NS
                print(f"{said} of {duration_s:g} s: {sink.status().detail}", file=sys.stderr)
            time.sleep(max(0.0, frames / RATE_HZ - (monotonic_ns() - began_ns) / NS_PER_S))
        status = sink.status()
    heard = is_heard(status, halfway)
    wanted = max(frames, status.sent + status.refused)  # more with several destinations
    print(f"{sink.name}: {status.sent} of {wanted} frames were sent: {outcome(status, heard)}")
    return 0 if heard else NOBODY_LISTENS


def is_heard(status: SinkStatus, halfway: SinkStatus | None) -> bool:
    """True if a receiver listens at the end; for other machines, if none has refused since halfway."""
    if status.listeners < 0:
        return status.sent > 0 and (halfway is None or status.refused == halfway.refused)
    return status.listeners > 0


def outcome(status: SinkStatus, heard: bool) -> str:
    """One line for people: of each destination how its state is known, or that it is not."""
    detail = "; ".join(map(_explained, status.detail.split("; ")))
    if heard:
        return detail
    return f"nobody {'listens' if status.listeners == 0 else 'is known to listen'} ({detail})"


def _explained(destination: str) -> str:
    for words, reason in _REASONS.items():
        if destination.startswith(words):
            return f"{destination} ({reason})"
    return destination
