"""THIRD_PARTY_NOTICES.md: what the runtime locks install, from the installed packages' metadata.

`python -m tests.supply.third_party_notices` writes it anew, in an environment made from the lock
(`make dev`); tests compare.
"""

from importlib import metadata

from tests.supply.bundled_libraries import table_rows
from tests.supply.lock_files import ROOT, Pin, runtime_pins

PAGE = ROOT / "THIRD_PARTY_NOTICES.md"

_HEAD = """\
# Third-party notices

<!-- Made by `python -m tests.supply.third_party_notices` from locks/run.txt; `make lock` runs it. -->

mocapd itself is under the [Apache License 2.0](LICENSE). It stands on the packages below, which pip
downloads as their own publishers made them, each with its licence inside. Who passes
them on *together* with mocapd (an installer, an image, a container) distributes them too, and has to keep
the licences and notices that the wheels hold (`*.dist-info/`), and to read the second and third part.

## Python packages

Every package of `locks/run.txt` that Linux installs: the base and the extra `print`. The extras `plots`
(matplotlib) and `vrchat` (zeroconf, LGPL 2.1) are in no bundle: whoever asks for them gets them from their publishers.

| package | version | licence |
|---|---|---|
"""

_LIBRARIES = """
## Native libraries inside the wheels

As found in the wheels for Linux on x86_64 and aarch64. All are shared libraries, in a folder of their
own or beside the package's code, and can be replaced by others of the same interface, as the LGPL asks.

| wheel | work | files | licence |
|---|---|---|---|
"""

_BESIDES = """
## What to know before passing them on

- **FFmpeg** (in opencv-python-headless) is under the LGPL 2.1 or later, **libquadmath** (in numpy, scipy and
  opencv-python-headless for x86_64) likewise: their licence text and an offer of their source go with a bundle.
- **libgfortran** is under the GPL 3 with GCC's runtime exception, which permits its use by works under
  any licence.
- **OpenSSL 1.1.1k** (in opencv-python-headless; `openssl-libs 1.1.1k-15.el8_6` of AlmaLinux 8 by the wheel's
  bill of materials) is of a series that its authors no longer support since September 2023. It is loaded with
  OpenCV, and talks to a network only for a camera at `rtsps://` or `https://` (or sent there by `http://`).
- **DarkGarden** (in reportlab, `reportlab/fonts/DarkGardenMK.*`) is a font under the GPL, with an exception for
  documents that use it. mocapd does not use it; a bundle may leave these files out.
- Other fonts carried: Bitstream Vera and Type 1 fonts in place of PostScript's (in reportlab; Vera's licence
  lies beside it, the others tell theirs inside).
- Linked into code of the wheels, not files of their own: OpenCV's third-party parts (`LICENSE-3RD-PARTY.txt` in
  `cv2/` lists them), some 120 Rust crates in eclipse-zenoh (its bill of materials, `sboms/`, lists them),
  Raqm in pillow, and what scipy, numpy and numba name in their licence files.

## Files in mocapd itself

`calib/joint_heatmaps.onnx` was trained by mocapd's own authors on pictures of its simulator, in poses that are made up or of
the CMU Graphics Lab Motion Capture Database: "The data used in this project was obtained from mocap.cs.cmu.edu. The database
was created with funding from NSF EIA-0196217."

`mocapd/published/hecht2009/face/lbpcascade_frontalface.xml` is OpenCV's cascade of frontal faces, unchanged but for a
note at its head (Copyright OpenCV Foundation and contributors, Apache License 2.0).
"""


def licence_of(package: str) -> str:
    """What the installed package's metadata say: the SPDX expression, else the shortest that is there."""
    try:
        told = metadata.metadata(package)
    except metadata.PackageNotFoundError:  # of the extra, on ARM
        return "not told"
    if told["License-Expression"]:
        return str(told["License-Expression"])
    classifiers = [
        text.split(" :: ")[-1]
        for text in told.get_all("Classifier") or []
        if text.startswith("License :: ") and text != "License :: OSI Approved"
    ]
    free_text = (told["License"] or "").strip()
    if free_text and len(free_text) <= 20:
        return free_text
    if free_text.startswith("This is free and unencumbered software"):
        return "Unlicense"
    return " OR ".join(classifiers) or "not told"


def row(pin: Pin) -> str:
    return f"| {pin.name} | {pin.version} | {licence_of(pin.name)} |"


def page() -> str:
    packages = "\n".join(row(pin) for pin in runtime_pins())
    return _HEAD + packages + "\n" + _LIBRARIES + "\n".join(table_rows()) + "\n" + _BESIDES


if __name__ == "__main__":
    PAGE.write_text(page())
