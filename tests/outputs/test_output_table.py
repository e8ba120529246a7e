"""Outputs from their sections: those that are enabled."""

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
from tests.service.test_publisher import Recorder


@dataclass(frozen=True)
class NewSection:
    """level: of something"""

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
    new = OutputEntry(NewSection, lambda _section, _name: Recorder())
    monkeypatch.setattr(output_table, "OUTPUTS", {**OUTPUTS, "new": new})
    assert "new" not in [sink.name for sink in build_sinks(default_sections(), "pc")]
    flags = {"new.enabled": "true", "new.level": "7"}
    effective = load_config(flags, env={"MOCAPD_OSC_ENABLED": "false"}, candidates=())
    assert effective.config.outputs["new"] == NewSection(7, True)
    assert {"new.level", "new.enabled"} <= {one.key.path for one in effective.settings}
    sinks = build_sinks(effective.config.outputs, "pc")
    assert [sink.name for sink in sinks] == ["zenoh", Recorder.name]


def test_what_is_unsafe_is_told_of_those_that_are_enabled() -> None:
    flags = {"zenoh.listen": '["tcp/0.0.0.0:7447"]', "zenoh.allow_unencrypted": "true"}
    assert len(unsafe_outputs(load_config(flags, env={}, candidates=()).config.outputs)) == 1
    off = load_config(flags | {"zenoh.enabled": "false"}, env={}, candidates=()).config.outputs
    assert unsafe_outputs(off) == []
    nothing: dict[str, OutputSection] = {}
    assert unsafe_outputs(nothing) == []
