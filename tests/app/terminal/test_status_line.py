"""The one live line: what stands in it, in good times and bad."""

from dataclasses import replace

from mocapd.app.daemon.supervision import state_text
from mocapd.app.terminal.status_line import status_text
from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.outputs.base import SinkStatus
from mocapd.pipeline.metrics import Metrics
from mocapd.pipeline.rolling import Percentiles
from mocapd.service.service import Snapshot
from mocapd.tracking.base import LostReason
from mocapd.tracking.effort import Effort
from mocapd.types import Tracking

NOTHING = Percentiles(float("nan"), float("nan"))
METRICS = Metrics(
    rate_hz=29.97,
    published=300,
    sets_made=301,
    sets_dropped=0,
    latency_ms=Percentiles(18.4, 24.6),
    step_ms=Percentiles(8.0, 9.0),
    spread_ms=Percentiles(3.0, 4.0),
    tracking=Tracking.LIVE,
    tracker="shirt",
    cameras={},
)
CAMERA = CaptureStatus("left", CaptureState.LIVE, "", 300, 0, 0, 30.04, 1)
LISTENED = SinkStatus(300, 0, 1, "game")
UNHEARD = SinkStatus(0, 300, 0, "no receiver on 127.0.0.1:39541")


def test_everything_is_in_one_line() -> None:
    text = status_text(Snapshot(METRICS, {"left": CAMERA}, {"zenoh": LISTENED, "osc": UNHEARD}))
    assert text == (
        "30.0 Hz | 18 ms (p95 25) | shirt live | left 30.0 | zenoh: game | osc: nobody listens"
    )


def test_before_the_first_frame_nothing_is_made_up() -> None:
    metrics = replace(METRICS, rate_hz=0.0, latency_ms=NOTHING, tracker="")
    opening = replace(CAMERA, state=CaptureState.OPENING, fps_hz=0.0)
    text = status_text(Snapshot(metrics, {"left": opening}, {}))
    assert text == " 0.0 Hz | no frame yet | left opening"


def test_somebody_who_is_not_taken_for_a_person_is_told_of() -> None:
    lost = replace(METRICS, tracking=Tracking.LOST, lost_reason=LostReason.UNRECOGNISED)
    text = status_text(Snapshot(lost, {"left": CAMERA}, {}))
    assert "| shirt lost | somebody moves here who is not taken for a person |" in text
    assert state_text(Snapshot(lost, {}, {})) == "somebody moves here who is not taken for a person"


def test_a_camera_that_counts_as_live_and_sends_nothing_is_told() -> None:
    stalled = replace(CAMERA, fps_hz=0.0, silent_s=3.2)
    assert "| left silent 3 s" in status_text(Snapshot(METRICS, {"left": stalled}, {}))


def test_a_lost_camera_and_dropped_frame_sets_are_told() -> None:
    lost = replace(CAMERA, state=CaptureState.LOST, reason="unplugged")
    text = status_text(Snapshot(replace(METRICS, sets_dropped=7), {"left": lost}, {}))
    assert "left lost" in text
    assert text.endswith("7 dropped")


def test_less_effort_is_said_with_its_reason() -> None:
    text = status_text(Snapshot(replace(METRICS, effort=Effort.SAVING), {"left": CAMERA}, {}))
    assert text.endswith("| saving effort: this machine is too slow")


def test_a_camera_whose_pictures_are_wrong_is_marked() -> None:
    black = replace(CAMERA, notice="its picture is black -- uncover the lens")
    assert "| left 30.0 (see the log)" in status_text(Snapshot(METRICS, {"left": black}, {}))
