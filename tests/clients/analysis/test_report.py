"""The report and its tables, as somebody opens them."""

import base64
import csv
import io
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from mocapd.errors import CannotCreateError
from mocapd_analysis.comparison import compared
from mocapd_analysis.csv_tables import frames_csv, measures_csv
from mocapd_analysis.main import app
from mocapd_analysis.measures import Measures, measure
from mocapd_analysis.plots import as_svg, speed_plot, thinned
from mocapd_analysis.report import NO_HEAD, report_html
from mocapd_analysis.report_head import ReportHead, head_html
from tests.clients.analysis.motions import AT, session, standing, times, turning_arm
from tests.clients.analysis.test_sessions import track


def swung(hz: float, name: str = "known") -> Measures:
    """An arm that goes up and down, with a time in which nobody was tracked."""
    t = times(6.0, 30.0)
    t = t[(t < 3.0) | (t > 3.6)]
    one = session(t, turning_arm(t, "left", 1.2 - 0.9 * np.cos(2.0 * np.pi * hz * t)))
    return measure(replace(one, name=name))


def still() -> Measures:
    """Hardly anything: somebody who stands for a moment."""
    return measure(session(times(0.1), standing(times(0.1))))


@pytest.fixture(scope="module")
def page() -> str:
    return report_html([swung(1.0, "<b>Monday</b>")])


def test_the_report_is_one_file_that_asks_for_nothing(page: str) -> None:
    assert "default-src 'none'" in page
    outside = re.findall(r'(?:src|href)="(?!data:)[^"]*"', page)
    assert outside == []
    assert "<script" not in page


def test_its_pictures_are_whole_svg(page: str) -> None:
    pictures = re.findall(r"data:image/svg\+xml;base64,([^\"]+)", page)
    assert len(pictures) >= 5
    for picture in pictures:
        assert ET.fromstring(base64.b64decode(picture)).tag.endswith("svg")


def test_a_name_from_outside_is_text(page: str) -> None:
    assert "<b>Monday</b>" not in page
    assert "&lt;b&gt;Monday&lt;/b&gt;" in page


def test_the_same_session_gives_the_same_picture() -> None:
    assert as_svg(speed_plot(swung(1.0))) == as_svg(speed_plot(swung(1.0)))


def test_the_report_says_what_was_not_tracked(page: str) -> None:
    assert "1 time not tracked" in page


def test_a_report_of_hardly_anything_is_written() -> None:
    page = report_html([still()])
    assert "No swing" in page
    assert "Nothing repeats" in page
    assert "nan" not in re.sub(r"base64,[^\"]+", "", page)


def test_two_sessions_stand_side_by_side() -> None:
    slow, fast = swung(0.8, "slow"), swung(1.6, "fast")
    by_name = {one.measure: one for one in compared(slow, fast)}
    assert by_name["peak swing speed"].change_percent == pytest.approx(100.0, abs=5.0)
    assert by_name["leftShoulder range"].change_percent == pytest.approx(0.0, abs=5.0)
    page = report_html([slow, fast])
    assert "Side by side" in page
    assert "A: slow" in page
    assert "B: fast" in page


def test_the_tables_hold_what_was_measured() -> None:
    found = swung(1.0)
    rows = list(csv.DictReader(io.StringIO(measures_csv([found]))))
    peak = next(r for r in rows if (r["measure"], r["of"]) == ("peak speed", "leftHand"))
    assert float(peak["value"]) == pytest.approx(
        found.joints["leftHand"].peak_speed.value, rel=1e-4
    )
    frames = list(csv.DictReader(io.StringIO(frames_csv(found))))
    assert len(frames) == len(found.session.times_s)
    assert float(frames[40]["leftHand_y_m"]) == pytest.approx(
        found.session.joints_m[40, AT["leftHand"], 1], rel=1e-4
    )


def test_every_figure_says_of_which_time_it_is(page: str) -> None:
    found = swung(1.0)
    rows = list(csv.DictReader(io.StringIO(measures_csv([found]))))
    assert all(float(row["from_s"]) < float(row["to_s"]) for row in rows)
    assert all(
        float(r["from_s"]) <= float(r["at_s"]) <= float(r["to_s"]) for r in rows if r["at_s"]
    )
    way = next(r for r in rows if (r["measure"], r["of"]) == ("way", "swing 1 left"))
    assert float(way["from_s"]) == pytest.approx(found.swings[0].start_s, rel=1e-4)
    heights = [float(r["value"]) for r in rows if r["measure"] in ("start y", "end y")]
    assert len(heights) == 2 * len(found.swings)
    assert "above half of it from [s]" in page


def test_the_head_has_person_date_and_notes_as_text(page: str) -> None:
    assert 'class="head"' not in page
    found = still()
    at_s = datetime(2026, 11, 26, 15, 4).astimezone().timestamp()
    dated = replace(found, session=replace(found.session, recorded_unix_s=at_s))
    recorded = "<dt>Date</dt><dd>2026-11-26 15:04</dd>"
    assert recorded in head_html(NO_HEAD, [dated, found])
    given = report_html([dated], ReportHead("A. Player", notes="<i>left</i> knee"))
    assert recorded in given
    assert "<dd>A. Player</dd>" in given
    assert "&lt;i&gt;left&lt;/i&gt; knee" in given
    assert "<dt>Date</dt><dd>yesterday</dd>" in head_html(ReportHead(date="yesterday"), [dated])
    unknown = replace(found, session=replace(found.session, recorded_unix_s=1e30))
    assert head_html(NO_HEAD, [unknown]) == ""


def test_thinning_a_line_loses_no_top() -> None:
    t = np.linspace(0.0, 100.0, 50_000)
    values = np.zeros(len(t))
    values[12_345] = 7.0
    values[30_000] = np.nan
    few_s, few = thinned(t, values)
    assert len(few) < 2000
    assert np.nanmax(few) == 7.0
    assert (np.diff(few_s) > 0.0).all()


def test_the_command_writes_all_files_and_says_which(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["report", str(track(tmp_path / "monday.npz"))])
    assert result.exit_code == 0, result.output
    names = {"monday.html", "monday_measures.csv", "monday_frames.csv"}
    assert names <= {path.name for path in tmp_path.iterdir()}
    assert all(name in result.output for name in names)
    written = {path: path.read_bytes() for path in tmp_path.iterdir()}
    again = CliRunner().invoke(app, ["report", str(tmp_path / "monday.npz")])
    assert isinstance(again.exception, CannotCreateError)  # which ends the program with 73
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == written
    assert not (tmp_path / "monday.csv").exists()  # the name of an export
