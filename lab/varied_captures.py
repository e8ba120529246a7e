"""Captures made of others that are as true: mirrored, or with fewer pictures a second.

    python -m lab.varied_captures CAPTURE... --out FOLDER [--mirrored] [--every 2]

What is right of a capture must be right of these. One that is much worse shows a weakness that chance hid, or a left taken
for a right. A shirt is not symmetric, so those in it can only be thinned.
"""

import json
import shutil
from pathlib import Path
from typing import Annotated, Any

import cv2
import numpy as np
import typer

from lab.command_line import run
from mocapd.body.bones import other_side
from mocapd.errors import InputError
from mocapd.geometry.rig_file import read_json

_MIRROR = np.diag([-1.0, 1.0, 1.0])
_BY_FRAME = ("times", "joints", "global_quats", "verts", "visible")  # arrays of truth.npz


def mirrored_camera(camera: dict[str, Any]) -> dict[str, Any]:
    """A camera of rig.json that sees the mirrored world as this one's picture in a mirror."""
    K, dist = np.array(camera["K"], dtype=float), list(camera["dist"])
    K[0, 2] = camera["size"][0] - 1 - K[0, 2]
    dist[3] = -dist[3]  # p2
    R, t_m = np.array(camera["R"]), np.array(camera["t"], dtype=float).ravel()
    return camera | {
        "K": K.tolist(),
        "dist": dist,
        "R": (_MIRROR @ R @ _MIRROR).tolist(),
        "t": (_MIRROR @ t_m).tolist(),
    }


def mirrored_truth(truth: dict[str, Any]) -> dict[str, Any]:
    """The arrays of a truth.npz, mirrored at the plane x = 0: left is right."""
    names = [str(name) for name in truth["names"]]
    other = [names.index(other_side(name)) for name in names]
    sides, out = np.diag(_MIRROR), dict(truth)
    out["joints"] = truth["joints"][:, other] * sides
    out["tpose_joints"] = truth["tpose_joints"][other] * sides
    out["global_quats"] = truth["global_quats"][:, other] * (1.0, -1.0, -1.0, 1.0)
    for name in ("verts", "tpose_verts"):
        if name in truth:
            out[name] = truth[name] * sides
    return out


def _write_video(source: Path, target: Path, hz: float, mirrored: bool, every: int) -> None:
    """Without loss."""
    video = cv2.VideoCapture(str(source))
    width, height = (
        int(video.get(of)) for of in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT)
    )
    writer = cv2.VideoWriter(
        str(target), cv2.VideoWriter.fourcc(*"FFV1"), hz / every, (width, height)
    )
    frame = 0
    while video.grab():
        if frame % every == 0:
            picture = video.retrieve()[1]
            writer.write(np.ascontiguousarray(picture[:, ::-1]) if mirrored else picture)
        frame += 1
    writer.release()
    video.release()


def vary(capture: Path, target: Path, mirrored: bool, every: int) -> None:
    """Writes a capture's variation into a new folder. Raises InputError."""
    if mirrored and (capture / "scribble").is_dir():
        raise InputError("is of the shirt, which is not symmetric", str(capture), "leave it out")
    rig = read_json(capture / "rig.json")
    target.mkdir(parents=True)
    for at, camera in enumerate(rig["cameras"]):
        video = Path(camera["file"])
        changed = mirrored_camera(camera) if mirrored else camera
        rig["cameras"][at] = changed | {
            "file": f"{video.stem}.avi",
            "fps": camera["fps"] / every,
        }
        _write_video(capture / video, target / f"{video.stem}.avi", camera["fps"], mirrored, every)
    (target / "rig.json").write_text(json.dumps(rig))
    with np.load(capture / "truth.npz", allow_pickle=False) as data:
        truth = {name: data[name] for name in data.files}
    truth = mirrored_truth(truth) if mirrored else truth
    truth |= {name: truth[name][::every] for name in _BY_FRAME if name in truth}
    np.savez_compressed(target / "truth.npz", **truth)
    for name in ("subject.json", "info.json", "scribble", "model"):
        if (capture / name).is_dir():
            shutil.copytree(capture / name, target / name)
        elif (capture / name).exists():
            shutil.copy(capture / name, target / name)


def varied_captures(
    captures: Annotated[list[Path], typer.Argument(help="Folders of captures with their truth.")],
    out: Annotated[Path, typer.Option("--out", help="The folder that they are written into.")],
    mirrored: Annotated[bool, typer.Option("--mirrored", help="Left is right.")] = False,
    every: Annotated[int, typer.Option(min=1, help="Keep each so many-th picture.")] = 1,
) -> None:
    """Masks and labels are left out."""
    for capture in captures:
        vary(capture, out / capture.name, mirrored, every)


if __name__ == "__main__":
    run(varied_captures)
