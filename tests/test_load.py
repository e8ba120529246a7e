"""The load measurements in small: each runs, with real processes, and what it measures makes sense."""

from pathlib import Path

import pytest

from tests.load.bad_subscribers import bad_subscriber_table, measure_bad_subscribers
from tests.load.camera_nodes import measure_camera_nodes, node_table
from tests.load.streams import measure_streams, stream_table

pytestmark = [pytest.mark.long, pytest.mark.usefixtures("empty_home")]


def test_nodes_with_a_poor_network_and_another_clock_are_used_by_a_daemon(tmp_path: Path) -> None:
    found = measure_camera_nodes(tmp_path, nodes=3, seconds=3.0, size_px=(64, 48))
    assert found.live.sets > 0
    assert found.live.all_cameras > 0.0
    plain, poor, other = found.clocks
    assert found.live.cpu_share > 0.0
    for clock in (plain, poor, other):
        # three seconds off, were it not known; told is how far it may be
        assert clock.worst_ms < 20 * clock.told_ms + 20.0
    assert "offset_s=3" in node_table(found)


def test_every_subscriber_gets_its_stream_through_the_router() -> None:
    found = measure_streams(streams=2, subscribers=4, seconds=1.5)
    assert found.slowest_hz > 0.0
    assert found.missed < 0.5
    assert found.p50_ms > 0.0
    assert "| 2 | 4 |" in stream_table([found])


def test_subscribers_that_hang_or_die_leave_the_others_their_frames(tmp_path: Path) -> None:
    found = measure_bad_subscribers(tmp_path, subscribers=4, stuck=1, killed=1, seconds=1.5)
    assert found.well.slowest_hz > 0.0
    assert found.beside.slowest_hz > 0.5 * found.well.slowest_hz
    assert "1 stuck and 1 killed" in bad_subscriber_table(found)
