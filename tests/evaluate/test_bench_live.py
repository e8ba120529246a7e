"""The live benchmark on a real daemon and a real subscriber, for three seconds."""

import json
import sys
from pathlib import Path

import pytest

from mocapd.errors import UnavailableError
from mocapd.evaluate.bench.bench_live import bench_live
from tests.cli.mocapd_process import mocapd, mocapd_here

SCENARIO = """
name = "small"
loop_s = 0.5
[[cameras]]
name = "cam0"
position_m = [-1.4, 1.4, 2.4]
look_at_m = [0.0, 1.0, 0.0]
size_px = [160, 120]
[[cameras]]
name = "cam1"
position_m = [1.6, 1.3, 2.2]
look_at_m = [0.0, 1.0, 0.0]
size_px = [160, 120]
clock_offset_s = 0.011
[[motion.keyframes]]
t_s = 0.0
"""


def test_a_daemon_is_run_and_seen_from_outside(clean_env: dict[str, str], tmp_path: Path) -> None:
    scenario = tmp_path / "small.toml"
    scenario.write_text(SCENARIO)
    words = ("--tracker", "canned", "--live", "--watched", "--seconds", "3", "--json")
    outcome = mocapd(clean_env, "bench", "--capture", f"sim:{scenario}", *words)
    assert outcome.code == 0, outcome.err
    seen = json.loads(outcome.out)["canned"]
    assert seen["sets"] > 30  # of 90, on however busy a machine
    assert 0.0 <= seen["dropped"] < 1.0
    assert 0.0 < seen["latency_median_ms"] <= seen["latency_p95_ms"]
    assert seen["arrival_median_ms"] >= seen["latency_median_ms"]
    assert seen["live"] > 0.9  # canned bodies are live, but for a gap of a busy machine
    assert seen["start_s"] > 0.0
    assert seen["cpu_share"] > 0.0
    assert seen["pictures_per_s"] > 2.0  # somebody looked at the page
    assert seen["rss_mb"] > 20.0


def test_a_daemon_that_nobody_can_hear_is_refused(
    clean_env: dict[str, str], tmp_path: Path
) -> None:
    scenario = tmp_path / "small.toml"
    scenario.write_text(SCENARIO)
    silent = ("--set", "zenoh.enabled=false")
    words = ("--tracker", "canned", "--live", "--seconds", "1", *silent)
    outcome = mocapd_here(clean_env, "bench", "--capture", f"sim:{scenario}", *words)
    assert outcome.code == 78
    assert "zenoh.enabled" in outcome.err


def test_a_daemon_that_ends_before_its_first_frame_is_quoted() -> None:
    program = "import sys; sys.exit('mocapd: camera cam7 is not plugged in')"
    with pytest.raises(UnavailableError, match="ended by itself -- mocapd: camera cam7"):
        bench_live([sys.executable, "-c", program], 2, 1.0)
