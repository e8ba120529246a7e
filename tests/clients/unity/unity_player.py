"""The Unity package compiled by mcs, and streams played to it under mono."""

import json
import socket
import subprocess
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from tests.clients.stream_cases import Stream
from tests.outputs.frames import free_port

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = ROOT / "clients" / "unity"
HERE = Path(__file__).parent
# Unity 2021 has C# 9, of which mcs knows the most in 7.2; fields that the inspector sets are never assigned
MCS = ("mcs", "-langversion:7.2", "-warn:4", "-warnaserror", "-nowarn:0649", "-utf8output")


def compiled(folder: Path) -> Path:
    """Each assembly by itself, as Unity does: the decoder without UnityEngine. The program that plays streams."""
    _compile(folder, "UnityEngine.dll", [HERE / "StandIns.cs"], [])
    core = (PACKAGE / "Runtime" / "Core").glob("*.cs")
    _compile(folder, "Mocapd.Core.dll", core, [])
    unity = ["Mocapd.Core.dll", "UnityEngine.dll"]
    _compile(folder, "Mocapd.Unity.dll", (PACKAGE / "Runtime").glob("*.cs"), unity)
    sample = (PACKAGE / "Samples~" / "Sample").glob("*.cs")
    player = [HERE / "PlayStreams.cs", HERE / "Scene.cs", *sample]
    return _compile(folder, "PlayStreams.exe", player, [*unity, "Mocapd.Unity.dll"])


def play(streams: dict[str, Stream], folder: Path) -> dict[str, Any]:
    """Of each stream what the package made of it, as JSON has it; `over UDP` is `golden` through a socket."""
    program = compiled(folder)
    lines = []
    for name, stream in streams.items():
        lines.append(f"stream {name}")
        lines += [f"{at_s} {'-' if packet is None else packet.hex()}" for at_s, packet in stream]
    (folder / "streams.txt").write_text("\n".join(lines) + "\n")
    port = free_port(socket.SOCK_DGRAM)
    command = ["mono", "--debug", str(program), str(folder / "streams.txt"), str(port)]
    # not strict: the player leaves control characters in names, which come with changed bytes too
    played: dict[str, Any] = json.loads(_run(command, folder), strict=False)
    return played


def _compile(folder: Path, name: str, sources: Iterable[Path], references: Sequence[str]) -> Path:
    kind = "library" if name.endswith(".dll") else "exe"
    used = [f"-r:{folder / one}" for one in references]
    paths = [str(path) for path in sorted(sources)]
    _run([*MCS, f"-target:{kind}", f"-out:{folder / name}", *used, *paths], folder)
    return folder / name


def _run(command: Sequence[str], folder: Path) -> str:
    run = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, timeout=900, check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout
