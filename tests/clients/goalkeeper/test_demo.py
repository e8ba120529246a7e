"""The demo: simulated cameras and shooter follow one script."""

from pathlib import Path

import pytest

from goalkeeper.app.headless import play_headless
from goalkeeper.streams.demo_daemon import DemoStream
from goalkeeper.streams.demo_script import SCRIPT, demo_scenario, scenario_toml
from goalkeeper.streams.person_stream import PersonStream
from goalkeeper.streams.scripted_shooter import ScriptedShooter
from mocapd.errors import CannotCreateError
from mocapd.sim.scenario import load_scenario


def test_the_cameras_read_the_scenario_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "goalkeeper.toml"
    path.write_text(scenario_toml(demo_scenario()))
    assert load_scenario(path) == demo_scenario()


def test_she_saves_what_she_reaches_for_and_not_where_the_script_says_that_she_is_wrong() -> None:
    report = play_headless(
        PersonStream(demo_scenario(), rate_hz=30.0, latency_s=0.05), ScriptedShooter(), 12, 120.0
    )
    wrong = sum(one.miss_m != (0.0, 0.0) for one in SCRIPT)
    assert report.score.goals in (wrong - 1, wrong, wrong + 1)
    assert report.score.saves == 12 - report.score.goals
    assert {shot.limb for shot in report.shots} >= {"left hand", "right hand"}


def test_a_folder_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    (tmp_path / "cache").write_text("a file in its place")
    with pytest.raises(CannotCreateError, match=r"goalkeeper\.toml"):
        DemoStream(tmp_path / "cache")
