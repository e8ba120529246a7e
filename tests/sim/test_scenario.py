"""Scenario files: what is wrong is named by key, value and fix."""

from pathlib import Path
from typing import Any

import pytest

from mocapd.assets import asset_path
from mocapd.errors import ConfigError, InputError
from mocapd.sim.scenario import load_scenario, scenario_from_dict
from mocapd.sim.world import World
from tests.sim.small import table


@pytest.mark.parametrize("name", ["living_room", "outdoor", "gym_mono", "first_setup", "jacket"])
def test_shipped_scenarios_load_and_move_on_the_floor(name: str) -> None:
    scenario = load_scenario(asset_path(f"scenarios/{name}.toml"))
    world = World(scenario)
    for t in (0.0, 0.37 * scenario.loop_s, 0.81 * scenario.loop_s):
        joints = world.at(t).joints_m
        assert 0.0 < joints[:, 1].min() < 0.12
        assert joints[:, 1].max() < 2.5


def _with(path: str, value: Any) -> dict[str, Any]:
    """The small scenario with one value changed; path as keys and indices, `a.0.b`."""
    out: Any = table()
    node: Any = out
    *head, last = path.split(".")
    for key in head:
        node = node[int(key)] if isinstance(node, list) else node.setdefault(key, {})
    node[last] = value
    return dict(out)


@pytest.mark.parametrize(
    ("path", "value", "named", "fix"),
    [
        ("fpshz", 30.0, "fpshz", "fps_hz"),
        ("cameras.0.positon_m", [0, 0, 0], "cameras[0].positon_m", "position_m"),
        ("cameras.1.shutter_s", "short", "cameras[1].shutter_s", ""),
        ("cameras.1.name", "left", "cameras", "rename"),
        ("body.stature_m", 17.5, "body.stature_m", ""),
        ("body.arm_lenght", 1.0, "body.arm_lenght", ""),
        ("motion.keyframes.1.pose", "t-pose", "motion.keyframes[1].pose", "t_pose"),
        ("motion.keyframes.2.t_s", 0.1, "motion.keyframes", "sort"),
        ("motion.oscillations", [{}], "motion.oscillations[0]", "add"),
        ("lights.0.events.0.t_s", 5.0, "lights[0].events", "sort"),
        ("room.things.0.lamp", "blue", "room.things[0].lamp", "warm"),
        ("loop_s", 2.01, "loop_s", "2"),
        ("clothes.trousers_srgb", [1, 2, 300], "clothes.trousers_srgb[2]", ""),
    ],
)
def test_a_wrong_value_is_named_with_its_key(path: str, value: Any, named: str, fix: str) -> None:
    with pytest.raises(ConfigError) as caught:
        scenario_from_dict(_with(path, value), "x.toml")
    message = str(caught.value)
    assert message.startswith("x.toml, ")
    assert named in message
    assert fix in caught.value.fix


def test_a_missing_key_is_named() -> None:
    broken = table()
    del broken["motion"]
    with pytest.raises(ConfigError, match="motion"):
        scenario_from_dict(broken)


def test_unreadable_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no_such"):
        load_scenario(tmp_path / "no_such.toml")
    (tmp_path / "torn.toml").write_text("name = \nseed = 1\n")
    with pytest.raises(ConfigError, match="line 1"):
        load_scenario(tmp_path / "torn.toml")


@pytest.mark.parametrize(
    ("path", "value", "named"),
    [
        ("cameras.0.position_m", [0.0, float("nan"), 0.0], "cameras[0].position_m[1]"),
        ("cameras.0.clock_offset_s", 1e300, "cameras[0].clock_offset_s"),
        ("cameras.0.size_px", [100_000, 100_000], "cameras[0].size_px"),
        ("seed", 10**30, "seed"),
        ("seed", -1, "seed"),
        ("fps_hz", 1e-300, "fps_hz"),
        ("name", "x" * 300, "name"),
    ],
)
def test_a_value_that_no_room_has_is_named_with_its_key(path: str, value: Any, named: str) -> None:
    with pytest.raises(ConfigError) as caught:
        scenario_from_dict(_with(path, value), "x.toml")
    assert named in str(caught.value)


@pytest.mark.parametrize(
    "text", ["seed = " + "9" * 5000, "a = " + "[" * 2000, "a" + ".a" * 600 + " = 1"]
)
def test_no_text_ends_in_a_traceback(tmp_path: Path, text: str) -> None:
    path = tmp_path / "x.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match="not valid TOML"):
        load_scenario(path)
