"""mocapd's add-on in headless Godot 4, and another's VMC receiver: what they make of the stream of `mocapd send-test`."""

import json
import os
import re
import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from tests.engines.chroot import Chroot
from tests.engines.godot_project import ADDON, bare_project, sample_project
from tests.engines.relay import Relay, wait_for_line
from tests.engines.results import Result, at_most, left_out
from tests.engines.wire_poses import greatest_error_m, osc_poses, vmc_poses
from tests.outputs.frames import free_port

WHERE = "Godot"
JOINTS_CM = 0.1
FEET_CM = 1.0
STARTS = 200
SEND_S = 8.0
READY_S = 120.0
PROBE_S = 90.0
CM = 100.0
FEET = ("LeftFoot", "LeftToes", "RightFoot", "RightToes")
VMC_NAME = "VMC receiver"
VMC_TRACKER = "/vmc/body"
ROOT = Path(__file__).resolve().parents[2]


def godot_checks(chroot: Chroot, work: Path, logs: Path) -> list[Result]:
    """work: an empty folder inside of the chroot."""
    return [
        *_sample(chroot, work / "sample", logs),
        *_starts(chroot, work / "starts", logs),
    ]


def vmc_checks(chroot: Chroot, work: Path, logs: Path, addon: Path | None) -> list[Result]:
    """An add-on that reads VMC, as its folder below `addons/` is: GodotXRVmcTracker."""
    if addon is None:
        return [left_out(VMC_NAME, "pose", "give its folder by --vmc-addon")]
    port = free_port(socket.SOCK_DGRAM)
    project = work / "vmc"
    plugin = "res://addons/godot_vmc_tracker/vmc_plugin.gd"
    setting = (
        f"[godot_vmc_tracker]\n\nnetwork/udp_listener_port={port}\n"
        f'tracking/body_tracker_name="{VMC_TRACKER}"\n'
    )
    placed = work / "godot_vmc_tracker"
    shutil.copytree(addon, placed)
    bare_project(project, "vmc_probe.gd", placed, {"Vmc": plugin}, setting)
    out = work / "vmc.jsonl"
    env = {"PROBE_OUT": chroot.inside(out), "PROBE_TRACKER": VMC_TRACKER, "PROBE_S": "30"}
    _import(chroot, project, logs / "vmc_import.log")
    log = logs / "vmc.log"
    with _running(chroot, project, log, env), Relay(port) as relay:
        if wait_for_line(log, "probe: ready", READY_S):
            _send("vmc", relay.port, "vmc.bundle=one")
    poses = [json.loads(line) for line in out.read_text().splitlines()]
    wire = vmc_poses(relay.datagrams)
    if not poses or not wire:
        return [Result(VMC_NAME, "poses", f"none; see {log}", "some", False)]
    errors_cm = [CM * min(greatest_error_m(pose, known) for known in wire) for pose in poses]
    return [
        at_most(
            VMC_NAME,
            f"joints of {len(poses)} poses, greatest error",
            max(errors_cm),
            JOINTS_CM,
            "cm",
        )
    ]


def _sample(chroot: Chroot, project: Path, logs: Path) -> Iterator[Result]:
    port = free_port(socket.SOCK_DGRAM)
    sample_project(project, port)
    imported = _import(chroot, project, logs / "sample_import.log")
    yield Result(WHERE, "errors while importing the sample", str(imported), "0", imported == 0)
    log, out = logs / "sample.log", project / "out.jsonl"
    env = {"PROBE_OUT": chroot.inside(out), "PROBE_S": f"{PROBE_S:g}"}
    with _running(chroot, project, log, env), Relay(port) as relay:
        if wait_for_line(log, "probe: ready", READY_S):
            _send("osc", relay.port)
    errors = _errors(log)
    yield Result(WHERE, "errors while running it", str(errors), "0", errors == 0)
    lines = [json.loads(line) for line in out.read_text().splitlines()]
    silent, frames = lines[-1:], lines[:-1]
    if not frames:
        yield Result(WHERE, "frames", f"none; see {log}", "some", False)
        return
    yield from _against_the_wire(frames, relay.datagrams)
    yield _feet([line for line in frames if line["figure"] == "rotation only"])
    unknown = max(line["unknown"] for line in frames)
    yield Result(WHERE, "flags of joints that mocapd does not know", str(unknown), "0", not unknown)
    told = f"data {silent[0]['has_data']}, {silent[0]['valid']} joints"
    yield Result(
        WHERE,
        "after the stream's end",
        told,
        "data False, 0 joints",
        told == "data False, 0 joints",
    )


def _against_the_wire(frames: list[dict[str, Any]], datagrams: list[bytes]) -> Iterator[Result]:
    wire = osc_poses(datagrams)
    tracker_cm, full_cm = [], []
    for line in frames:
        truth = wire[int(line["capture_unix_ns"])]
        if line["figure"] == "full":
            bones = {name[0].lower() + name[1:]: at_m for name, at_m in line["bones"].items()}
            full_cm.append(CM * greatest_error_m(bones, truth))
        else:
            tracker_cm.append(CM * greatest_error_m(line["joints"], truth))
    for what, errors_cm in (("tracker", tracker_cm), ("bones of a full avatar", full_cm)):
        name = f"{what}, greatest error in {len(errors_cm)} frames"
        yield at_most(WHERE, name, max(errors_cm, default=np.inf), JOINTS_CM, "cm")


def _feet(frames: list[dict[str, Any]]) -> Result:
    """Of the sample's figure, whose ankles and toes are on the floor in the rest pose."""
    lowest_cm = [CM * min(line["bones"][bone][1] for bone in FEET) for line in frames]
    value = max(map(abs, lowest_cm))
    return at_most(WHERE, "lower foot of the sample off the floor", value, FEET_CM, "cm")


def _starts(chroot: Chroot, project: Path, logs: Path) -> Iterator[Result]:
    log = logs / "starts.log"
    bare_project(project, "poisoned_starts.gd", ADDON, {})
    _import(chroot, project, logs / "starts_import.log")
    chroot.run(_godot(chroot, project), log, {"STARTS": str(STARTS)})
    told = re.search(r"of the engine (\d+), of mocapd (\d+)", log.read_text(errors="replace"))
    what = f"valid joints after {STARTS} starts in poisoned memory"
    if told is None:
        yield Result(WHERE, what, f"no answer; see {log}", "0", False)
    else:
        measured = f"{told[2]} (the engine alone: {told[1]})"
        yield Result(WHERE, what, measured, "0", int(told[2]) == 0)


def _godot(chroot: Chroot, project: Path) -> list[str]:
    return ["godot", "--headless", "--path", chroot.inside(project)]


def _import(chroot: Chroot, project: Path, log: Path) -> int:
    """The number of errors."""
    code = chroot.run([*_godot(chroot, project), "--import"], log)
    return _errors(log) + (code != 0)


def _errors(log: Path) -> int:
    return len(re.findall(r"^(?:SCRIPT )?ERROR", log.read_text(errors="replace"), re.MULTILINE))


@contextmanager
def _running(chroot: Chroot, project: Path, log: Path, env: dict[str, str]) -> Iterator[None]:
    running = chroot.start(_godot(chroot, project), env, log)
    try:
        yield
        running.wait(PROBE_S + READY_S)
    finally:
        running.kill()
        running.wait()


def _send(output: str, port: int, *settings: str) -> None:
    """The person who waves and steps."""
    command = [sys.executable, "-m", "mocapd.cli.main", "send-test", "--output", output]
    command += ["--port", str(port), "--seconds", f"{SEND_S:g}"]
    for setting in settings:
        command += ["--set", setting]
    subprocess.run(command, cwd=ROOT, env=os.environ, capture_output=True, check=True)
