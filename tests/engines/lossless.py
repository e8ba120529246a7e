"""A capture whose pictures every machine decodes alike: lossless RGB in place of mp4, whose decoders differ by machine."""

import json
from pathlib import Path

import cv2

from lab.simulated.export import export_capture
from mocapd.assets import asset_path
from mocapd.sim.scenario import load_scenario

SCENE = "living_room"


def write_lossless_capture(folder: Path, seconds: float) -> None:
    """So much of a simulated room with two cameras, in the capture format. Raises CannotCreateError."""
    scenario = load_scenario(asset_path("scenarios") / f"{SCENE}.toml")
    export_capture(scenario, folder, seconds)
    rig_file = folder / "rig.json"
    rig = json.loads(rig_file.read_text())
    for camera in rig["cameras"]:
        lossy = folder / camera["file"]
        camera["file"] = lossless_copy(lossy, float(camera["fps"])).name
        lossy.unlink()
    rig_file.write_text(json.dumps(rig, indent=1) + "\n")


def lossless_copy(video: Path, rate_hz: float) -> Path:
    """The same pictures, as this machine decodes them, beside the video in FFV1, which keeps RGB exactly."""
    path = video.with_suffix(".mkv")
    source = cv2.VideoCapture(str(video))
    size_px = tuple(
        round(source.get(prop)) for prop in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT)
    )
    written = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"FFV1"), rate_hz, size_px)
    while True:
        is_there, pixels = source.read()
        if not is_there:
            break
        written.write(pixels)
    written.release()
    source.release()
    return path
