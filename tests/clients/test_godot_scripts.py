"""The Godot add-on as text: every script parses as GDScript of Godot 4 and passes gdlint; scenes name what is there."""

import re
from pathlib import Path

import pytest
from gdtoolkit.linter import DEFAULT_CONFIG, lint_code
from gdtoolkit.parser import parser

from tests.clients.godot.godot_player import ADDON, DECODER

PROJECT = ADDON.parents[1]
GDLINTRC = PROJECT / "gdlintrc"
SCRIPTS = sorted(PROJECT.rglob("*.gd"))
RESOURCES = sorted(
    p for kind in ("*.tscn", "*.godot", "*.cfg", "*.gd") for p in PROJECT.rglob(kind)
)


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda p: p.name)
def test_scripts_parse_and_pass_the_linter(script: Path) -> None:
    code = script.read_text()
    parser.parse(code, gather_metadata=True)
    (limit,) = re.findall(r"^max-line-length: (\d+)$", GDLINTRC.read_text(), re.MULTILINE)
    config = {**DEFAULT_CONFIG, "max-line-length": int(limit)}
    assert [(one.line, one.description) for one in lint_code(code, config)] == []


@pytest.mark.parametrize("path", RESOURCES, ids=lambda p: p.name)
def test_what_is_named_is_there(path: Path) -> None:
    text = path.read_text()
    named = [PROJECT / name for name in re.findall(r"res://([\w/.]+)", text)]
    named += [path.parent / name for name in re.findall(r'preload\("([\w.]+)"\)', text)]
    named += [path.parent / name for name in re.findall(r'^script="([\w.]+)"', text, re.MULTILINE)]
    assert [str(one) for one in named if not one.is_file()] == []


def test_the_decoder_stands_alone() -> None:
    for name in DECODER:
        text = (ADDON / name).read_text()
        assert set(re.findall(r'preload\("([\w.]+)"\)', text)) <= set(DECODER)
        assert "XR" not in re.sub(r"#.*", "", text)  # which Godot 3 does not have


def test_scenes_count_their_resources_and_number_them_once() -> None:
    for scene in PROJECT.rglob("*.tscn"):
        text = scene.read_text()
        ids = re.findall(r'^\[(?:ext|sub)_resource .*id="(\w+)"\]', text, re.MULTILINE)
        steps = re.findall(r"load_steps=(\d+)", text)
        assert steps == [str(len(ids) + 1)]
        used = re.findall(r'(?:Ext|Sub)Resource\("(\w+)"\)', text)
        assert set(used) == set(ids)
        assert len(set(ids)) == len(ids)


def test_no_joint_of_a_new_tracker_is_left_as_the_engine_made_it() -> None:
    """Its flags are uninitialised memory; `make engines` counts them in Godot 4."""
    receiver = (ADDON / "mocapd_receiver.gd").read_text()
    reset = "for joint in XRBodyTracker.JOINT_MAX:\n\t\t\ttracker.set_joint_flags(joint, 0)\n"
    assert 0 < receiver.find(reset) < receiver.find("XRServer.add_tracker(tracker)")
