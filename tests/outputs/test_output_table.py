"""Outputs from their sections: those that are enabled, and on a thread of their own where they may block."""

from dataclasses import dataclass

import pytest

from mocapd.config.effective import load_config
from mocapd.outputs import output_table
from mocapd.outputs.output_table import (
    OUTPUTS,
    OutputEntry,
    OutputSection,
    build_sinks,
    default_sections,
    unsafe_outputs,
)
from mocapd.outputs.threaded import ThreadedSink
from tests.outputs.test_threaded import SlowSink


@dataclass(frozen=True)
class SlowSection:
    """level: how slow"""

    level: int = 3
    enabled: bool = False


def test_all_are_built_unless_they_are_disabled_or_left_out() -> None:
    wanted = [name for name, section in default_sections().items() if section.enabled]
    assert [sink.name for sink in build_sinks(default_sections(), "pc")] == wanted
    everything = load_config({f"{name}.enabled": "true" for name in OUTPUTS}, env={}, candidates=())
    sinks = build_sinks(everything.config.outputs, "pc")
    assert [sink.name for sink in sinks] == list(OUTPUTS)
    config = load_config({"zenoh.enabled": "false"}, env={}, candidates=()).config
    assert [sink.name for sink in build_sinks(config.outputs, "pc")] == ["osc"]
    assert build_sinks({}, "pc") == ()


def test_a_line_in_the_table_is_all_that_a_new_output_needs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    slow = OutputEntry(SlowSection, lambda _section, _name: SlowSink(), blocks=True)
    monkeypatch.setattr(output_table, "OUTPUTS", {**OUTPUTS, "slow": slow})
    assert "slow" not in [sink.name for sink in build_sinks(default_sections(), "pc")]
    flags = {"slow.enabled": "true", "slow.level": "7"}
    effective = load_config(flags, env={"MOCAPD_OSC_ENABLED": "false"}, candidates=())
    assert effective.config.outputs["slow"] == SlowSection(7, True)
    assert {"slow.level", "slow.enabled"} <= {one.key.path for one in effective.settings}
    sinks = build_sinks(effective.config.outputs, "pc")
    assert [sink.name for sink in sinks] == ["zenoh", "slow"]
    assert [type(sink) is ThreadedSink for sink in sinks] == [False, True]


def test_what_is_unsafe_is_told_of_those_that_are_enabled() -> None:
    flags = {"zenoh.listen": '["tcp/0.0.0.0:7447"]', "zenoh.allow_unencrypted": "true"}
    assert len(unsafe_outputs(load_config(flags, env={}, candidates=()).config.outputs)) == 1
    off = load_config(flags | {"zenoh.enabled": "false"}, env={}, candidates=()).config.outputs
    assert unsafe_outputs(off) == []
    nothing: dict[str, OutputSection] = {}
    assert unsafe_outputs(nothing) == []
