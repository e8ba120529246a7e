"""Whose pictures a camera of the running service delivers: runs in the guest, with the package's Python.

python vm_whose.py RECORDING FOLDER      a line `left cam0`: the camera `left` shows what FOLDER/cam0.png does
"""

import sys
from pathlib import Path

import cv2
import numpy as np

from mocapd.capture.recording.mcap_origin import open_recording
from mocapd.types import Bytes, Floats


def few(pixels: Bytes) -> Floats:
    """Enough of them, as memory is dear to ask for in the guest."""
    return pixels[::8, ::8].astype(float)


def main(recording: Path, folder: Path) -> None:
    known = {path.stem: few(np.asarray(cv2.imread(str(path)))) for path in folder.glob("cam?.png")}
    seen: dict[str, str] = {}
    for frames in open_recording(recording).frame_sets():
        for name, frame in frames.frames.items():
            if name not in seen:
                pixels = few(frame.pixels)
                off = {film: np.abs(pixels - picture).mean() for film, picture in known.items()}
                seen[name] = min(off, key=lambda film: off[film])
        if len(seen) == len(known):
            break
    for name in sorted(seen):
        print(name, seen[name])


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
