"""The daemon's name: how long it may be, and what it is when none is given."""

from pathlib import Path

import pytest

from mocapd.body.shape import mean_shape
from mocapd.config.effective import load_config
from mocapd.config.sections import Config
from mocapd.errors import ConfigError
from mocapd.outputs.instance import instance_name
from mocapd.outputs.output_table import OscSection, OutputSection, ZenohSection
from mocapd.service.service import Service
from mocapd.session.camera_inputs import CameraInput
from mocapd.session.session import Session
from mocapd.trackers.canned.tracker import CannedTracker
from tests.e2e.dying_camera import DyingCamera

LONGEST = "x" * 64
TOO_LONG = LONGEST + "x"


@pytest.mark.parametrize(
    ("flags", "env", "text", "where"),
    [
        ({"instance": TOO_LONG}, {}, "", "command line"),
        ({}, {"MOCAPD_INSTANCE": TOO_LONG}, "", "environment MOCAPD_INSTANCE"),
        ({}, {}, f"instance = '{TOO_LONG}'", "config.toml:1"),
    ],
)
def test_more_than_64_characters_are_refused_wherever_they_come_from(
    flags: dict[str, str], env: dict[str, str], text: str, where: str, tmp_path: Path
) -> None:
    file = tmp_path / "config.toml"
    file.write_text(text)
    with pytest.raises(ConfigError, match="instance = ") as caught:
        load_config(flags, file, env)
    assert caught.value.where.endswith(where)


def test_64_characters_are_a_name() -> None:
    assert load_config({"instance": LONGEST}, env={}, candidates=()).config.instance == LONGEST


@pytest.mark.parametrize("on_zenoh", [True, False])
def test_without_a_name_it_is_the_machines_also_when_only_osc_is_sent(on_zenoh: bool) -> None:
    outputs: dict[str, OutputSection] = {
        "zenoh": ZenohSection(enabled=on_zenoh),
        "osc": OscSection(enabled=not on_zenoh),
    }
    config = Config(outputs=outputs)
    camera = CameraInput(DyingCamera(), "never opened")
    session = Session((camera,), None, "", CannedTracker(), mean_shape(1.75))
    assert Service(config, session).instance == instance_name()
