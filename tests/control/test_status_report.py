"""What a running service says of itself: its cameras, its outputs, its age and its last trouble."""

import logging
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import pytest

from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.control.control_messages import (
    CalibrationReport,
    CameraStatusReport,
    OutputReport,
    StatusReport,
    Trouble,
)
from mocapd.control.last_trouble import LastTrouble
from mocapd.control.status_report import status_report
from mocapd.outputs import output_table
from mocapd.outputs.output_table import OutputEntry
from mocapd.pipeline.metrics import Metrics
from mocapd.pipeline.rolling import Percentiles
from mocapd.service.readiness import readiness_of
from mocapd.service.service import Service, Snapshot
from mocapd.types import Rig, Tracking
from tests.geometry.rigs import ring
from tests.outputs.frames import eventually
from tests.service.test_publisher import Recorder
from tests.service.test_service import Enabled, config_of, session_of

LIVE = CaptureStatus("a", CaptureState.LIVE, "", 100, 0, 0, 30.0, 1)
SILENT = replace(LIVE, silent_s=3.0)
LOST = replace(LIVE, state=CaptureState.LOST)
OPENING = replace(LIVE, state=CaptureState.OPENING)


@pytest.fixture
def service(monkeypatch: pytest.MonkeyPatch) -> Iterator[Service]:
    sink = Recorder()
    entry = OutputEntry(Enabled, lambda _section, _name: sink)
    monkeypatch.setattr(output_table, "OUTPUTS", {"recorder": entry})
    made = datetime(2026, 11, 1, 12, 0)
    session = replace(session_of("a", "b", rig=Rig(ring(2))), calibrated=made)
    with Service(config_of(), session) as one:
        assert eventually(lambda: len(sink.frames) > 5)
        yield one


def test_it_tells_of_each_camera_and_output_and_of_the_calibration(service: Service) -> None:
    told = status_report(service, None)
    assert told.state == "tracking"
    assert [(one.id, one.state, one.source) for one in told.cameras] == [
        ("a", "live", "test-a"),
        ("b", "live", "test-b"),
    ]
    assert [one.name for one in told.outputs] == ["recorder"]
    assert told.latency_median_ms is not None
    assert told.tracker == "canned"
    assert told.uptime_s > 0.0
    assert told.calibration is not None
    made = datetime(2026, 11, 1, 12, 0, tzinfo=UTC)
    assert told.calibration.made_unix_s == made.timestamp()


def test_another_session_is_told_in_its_place(service: Service) -> None:
    service.replace(config_of(), session_of("c"))
    told = status_report(service, None)
    assert [one.id for one in told.cameras] == ["c"]
    assert told.calibration is None


@pytest.mark.parametrize(
    ("cameras", "tracking", "published", "state"),
    [
        ((LIVE, LOST), Tracking.LIVE, 9, "tracking"),
        ((LIVE,), Tracking.COASTING, 9, "tracking"),
        ((LIVE, SILENT), Tracking.LOST, 9, "nobody"),
        ((LIVE,), Tracking.LOST, 0, "starting"),
        ((OPENING, LOST), Tracking.LOST, 0, "starting"),
        ((SILENT, LOST), Tracking.COASTING, 9, "blind"),
        ((LOST,), Tracking.LOST, 9, "blind"),
        ((), Tracking.LOST, 0, "blind"),
    ],
)
def test_one_word_says_whether_it_can_track(
    cameras: tuple[CaptureStatus, ...], tracking: Tracking, published: int, state: str
) -> None:
    none = Percentiles(0.0, 0.0)
    metrics = Metrics(0.0, published, 0, 0, none, none, none, tracking, "", {})
    by_name = {str(number): one for number, one in enumerate(cameras)}
    assert readiness_of(Snapshot(metrics, by_name, {})) == state


def test_the_newest_warning_is_remembered_and_nothing_less() -> None:
    log = logging.getLogger("mocapd.some.room")
    with LastTrouble() as trouble:
        log.info("all is well")
        before = trouble.newest
        log.warning("camera %r: lost", "a")
        log.error("worse")
        log.info("well again")
        newest = trouble.newest
    log.warning("nobody listens any more")
    assert before is None
    assert newest is not None
    assert newest == trouble.newest
    assert (newest.level, newest.text) == ("error", "worse")


def test_the_page_about_it_names_every_field() -> None:
    page = (Path(__file__).parents[2] / "docs/operating.md").read_text()
    told = page.partition("In JSON:")[2].partition("\n\n")[0]
    kinds = (StatusReport, CameraStatusReport, OutputReport, CalibrationReport, Trouble)
    for kind in kinds:
        for name in kind.__struct_fields__:
            assert f"`{name}`" in told, (kind.__name__, name)
