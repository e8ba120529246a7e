"""`mocapd prepare`: what the first start makes is made, and the doctor says so."""

import json

import pytest

from tests.cli.mocapd_process import mocapd, mocapd_here

pytestmark = pytest.mark.kernels


def test_after_it_the_next_start_has_nothing_to_compile(clean_env: dict[str, str]) -> None:
    settings = ("--set", "tracker.name=markerless")
    done = mocapd(clean_env, "prepare", *settings)
    assert done.code == 0, done.err
    assert "`mocapd run` starts in seconds" in done.out
    assert (
        "renders its film" in done.out
    )  # of the simulated webcams, which `prepare` leaves to the demo
    said = mocapd(clean_env, "doctor", "--json", *settings).out.splitlines()
    findings = {one["about"]: one for one in map(json.loads, said)}
    assert findings["first start"]["verdict"] == "ok"


def test_what_no_table_knows_is_refused_with_its_name(clean_env: dict[str, str]) -> None:
    done = mocapd_here(clean_env, "prepare", "--set", "tracker.name=canned")
    assert done.code == 78
    assert "canned" in done.err
