"""Godot projects for the checks: the sample with a probe, and bare ones with an add-on and a script."""

import shutil
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "clients/godot"
ADDON = SAMPLE / "addons/mocapd"
SCRIPTS = Path(__file__).with_name("godot")
_FRAMES_HZ = 60  # else a headless engine takes a whole core

_MAIN = """[gd_scene load_steps=2 format=3]

[ext_resource type="Script" path="res://main.gd" id="1"]

[node name="Main" type="Node"]
script = ExtResource("1")
"""


def sample_project(folder: Path, port: int) -> None:
    """The sample as it is, listening on this port, with the probe as another autoload."""
    shutil.copytree(SAMPLE, folder)
    shutil.copy(SCRIPTS / "probe.gd", folder)
    text = (folder / "project.godot").read_text()
    autoload = "[autoload]\n"
    before, found, after = text.partition(autoload)
    assert found
    own, _, rest = after.strip().partition("\n")
    text = f'{before}{autoload}\n{own}\nProbe="*res://probe.gd"\n{rest}'
    text = text.replace("[application]\n", f"[application]\n\nrun/max_fps={_FRAMES_HZ}", 1)
    (folder / "project.godot").write_text(f"{text}\n[mocapd]\n\nport={port}\n")


def bare_project(
    folder: Path, script: str, addon: Path, autoloads: Mapping[str, str], settings: str = ""
) -> None:
    """A project whose main scene is a node with this script of ours, and with this add-on."""
    (folder / "addons").mkdir(parents=True)
    shutil.copytree(addon, folder / "addons" / addon.name)
    shutil.copy(SCRIPTS / script, folder / "main.gd")
    (folder / "main.tscn").write_text(_MAIN)
    loads = "".join(f'{name}="*{path}"\n' for name, path in autoloads.items())
    (folder / "project.godot").write_text(
        "config_version=5\n\n[application]\n\n"
        f'config/name="probe"\nrun/main_scene="res://main.tscn"\nrun/max_fps={_FRAMES_HZ}\n'
        f'config/features=PackedStringArray("4.3")\n\n[autoload]\n\n{loads}\n{settings}'
    )
