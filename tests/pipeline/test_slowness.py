"""The verdict "too slow": when it comes, what it names as the cause, and where everybody reads it."""

import math
from dataclasses import replace

import msgspec
import pytest

from mocapd.app.terminal.status_line import status_text
from mocapd.app.terminal.status_text import status_lines
from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.cli.care.status import SLOW, exit_code
from mocapd.clock import NS_PER_S
from mocapd.doctor.checks.system_checks import check_daemons
from mocapd.doctor.finding import Verdict
from mocapd.outputs.messages import HEALTH, decode_health
from mocapd.outputs.wire import MSGPACK_MIME
from mocapd.pipeline.collector import CollectorCounts
from mocapd.pipeline.metrics import Metrics, MetricsRecorder
from mocapd.pipeline.other_programs import OtherPrograms
from mocapd.pipeline.rolling import Percentiles
from mocapd.pipeline.slowness import Slowness, SlownessWatch
from mocapd.service.health import health_message
from mocapd.service.readiness import readiness_of
from mocapd.service.service import Snapshot
from mocapd.tracking.base import lost_body
from mocapd.types import Tracking
from mocapd.web.live_json import figures_json
from tests.control.reports import report

SLOW_NOW = Slowness(0.95, 1.5, 30.0, 640.0)
LIVE = CaptureStatus("left", CaptureState.LIVE, "", 100, 0, 0, 30.0, 1)
MS = Percentiles(30.0, 40.0)
METRICS = Metrics(*(1.5, 30, 600, 570, MS, MS, MS, Tracking.LOST, "shirt", {}), slowness=SLOW_NOW)


def verdicts(
    gaps: list[int], rate_hz: float = 30.0, others: float = math.nan
) -> list[Slowness | None]:
    """After each frame set, of which so many were made since the one before."""
    watch, number, found = SlownessWatch(), 0, []
    for gap in gaps:
        number += gap
        now_ns = round(number / rate_hz * NS_PER_S)
        found.append(watch.update(number, round(gap / rate_hz * NS_PER_S), now_ns, others))
    return found


def test_a_tracker_that_keeps_nineteen_of_twenty_waiting_is_too_slow() -> None:
    found = verdicts([20] * 8)[-1]
    assert found is not None
    assert found.skipped == pytest.approx(0.95)
    assert found.tracked_hz == pytest.approx(1.5)
    assert found.made_hz == pytest.approx(30.0)
    assert "95 % of the frame sets are skipped" in found.what
    assert "takes 667 ms" in found.what
    assert "fps_hz" in found.fix


def test_a_tracker_that_skips_now_and_then_or_paused_once_is_not() -> None:
    assert set(verdicts([1, 1, 1, 2] * 100)) == {None}
    assert set(verdicts([1] * 60 + [90] + [1] * 300)) == {None}, "a kernel compiled"


def test_the_verdict_ends_when_the_machine_is_free_again() -> None:
    found = verdicts([10] * 30 + [1] * 300)
    assert found[25] is not None
    assert found[-1] is None


def test_programs_beside_it_are_the_cause_where_they_use_the_processor() -> None:
    found = verdicts([20] * 8, others=0.6)[-1]
    assert found is not None
    assert "other programs use 60 % of this machine" in found.what
    assert found.fix.startswith("close other programs")


def test_other_programs_are_what_is_busy_without_us() -> None:
    readings = iter([(100.0, 50.0, 5.0), (104.0, 53.0, 6.0), (108.0, 54.0, 7.0)])
    others = OtherPrograms(lambda: next(readings))
    assert math.isnan(others.share(0))
    assert math.isnan(others.share(NS_PER_S // 2))
    assert others.share(NS_PER_S) == pytest.approx(0.5)
    assert others.share(2 * NS_PER_S) == pytest.approx(0.0)


def test_this_machine_can_be_read() -> None:
    others = OtherPrograms()
    others.share(0)
    share = others.share(2 * NS_PER_S)
    assert math.isnan(share) or 0.0 <= share <= 1.0


def test_without_frames_nobody_is_too_slow() -> None:
    """All cameras are unplugged: that the tracker skipped frame sets is over, and not what the health is to say."""
    recorder = MetricsRecorder()
    recorder.set_slowness(SLOW_NOW)
    recorder.absent(lost_body(0, "shirt"))
    assert recorder.snapshot(CollectorCounts(0, 0, {}, {}), 0).slowness is None


def test_status_says_it_with_a_code_of_its_own() -> None:
    assert readiness_of(Snapshot(METRICS, {"left": LIVE}, {})) == "slow"
    text = f"{SLOW_NOW.what} -- {SLOW_NOW.fix}"
    slow = report(state="slow", slowness=text)
    assert exit_code(slow) == SLOW == 151
    (state,) = [line for line in status_lines(slow) if line.startswith("state")]
    assert "too slow: 95 %" in state
    assert "smaller pictures" in state
    assert "nobody" not in state


def test_the_doctor_says_it() -> None:
    text = f"{SLOW_NOW.what} -- {SLOW_NOW.fix}"
    (found,) = check_daemons((report(state="slow", slowness=text),))
    assert found.verdict is Verdict.BAD
    assert "too slow" in found.what
    assert found.fix == SLOW_NOW.fix


def test_games_hear_it_on_the_wire() -> None:
    health = health_message("pc", 1, 2, METRICS, {})
    assert health.slowness.startswith("too slow: 95 %")
    assert health.detail == health.slowness
    again = decode_health(msgspec.msgpack.encode(health), f"{MSGPACK_MIME};{HEALTH}")
    assert (again.schema, again.slowness) == (HEALTH, health.slowness)
    assert health_message("pc", 1, 2, replace(METRICS, slowness=None), {}).slowness == ""


def test_the_page_and_the_terminal_say_it() -> None:
    snapshot = Snapshot(METRICS, {"left": LIVE}, {})
    figures = figures_json(snapshot)["figures"]
    assert isinstance(figures, dict)
    assert str(figures["slowness"]).startswith("too slow")
    assert "too slow: 95 %" in status_text(snapshot)
