"""Streams played to the Godot add-on under godot3-server."""

import json
import os
import shutil
import socket
import subprocess
from pathlib import Path
from typing import Any

from tests.clients.godot.avatars import AVATARS, as_given
from tests.clients.stream_cases import Stream
from tests.outputs.frames import free_port

ROOT = Path(__file__).resolve().parents[3]
ADDON = ROOT / "clients" / "godot" / "addons" / "mocapd"
SCRIPT = Path(__file__).with_name("play_streams.gd")
# What the add-on decodes with, and all that it needs for it: Godot 3 runs nothing else of it.
DECODER = (
    "mocapd_osc.gd",
    "mocapd_frames.gd",
    "mocapd_humanoid.gd",
    "mocapd_feet.gd",
    "mocapd_socket.gd",
)
PROJECT = "config_version=4\n"


def play(streams: dict[str, Stream], folder: Path) -> dict[str, Any]:
    """Of each stream what the add-on made of it, as JSON has it; `over UDP` is `golden` through a socket."""
    addon = folder / "addons" / "mocapd"
    addon.mkdir(parents=True)
    for name in DECODER:
        shutil.copy(ADDON / name, addon)
    (folder / "project.godot").write_text(PROJECT)
    told = {
        name: [[time_s, None if packet is None else packet.hex()] for time_s, packet in stream]
        for name, stream in streams.items()
    }
    (folder / "streams.json").write_text(json.dumps(told))
    (folder / "avatars.json").write_text(
        json.dumps({name: as_given(avatar) for name, avatar in AVATARS.items()})
    )
    env = {
        "PATH": os.environ["PATH"],
        "HOME": str(folder),
        "LANG": "en_US.UTF-8",
        "MOCAPD_STREAMS": str(folder / "streams.json"),
        "MOCAPD_AVATARS": str(folder / "avatars.json"),
        "MOCAPD_PLAYED": str(folder / "played.json"),
        "MOCAPD_PORT": str(free_port(socket.SOCK_DGRAM)),
    }
    command = ["godot3-server", "--path", str(folder), "-s", str(SCRIPT)]
    run = subprocess.run(command, env=env, capture_output=True, text=True, timeout=900, check=False)
    said = run.stdout + run.stderr
    assert run.returncode == 0, said
    assert "SCRIPT ERROR" not in said, said
    assert "Parse Error" not in said, said
    # not strict: Godot 3 leaves control characters in names, which come with changed bytes too
    played: dict[str, Any] = json.loads((folder / "played.json").read_text(), strict=False)
    return played
