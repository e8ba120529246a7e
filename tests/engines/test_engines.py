"""What `make engines` and `make platforms` stand on, as far as it needs no other system: those are run by hand."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.engines import chroot
from tests.engines.chroot import NoChrootError
from tests.engines.lossless import lossless_copy
from tests.engines.mirror import configured_mirror
from tests.engines.wire_poses import greatest_error_m, osc_poses, vmc_poses
from tests.golden import make_osc, make_vmc

NEW_FORMAT = """Types: deb
# a comment with http://commented.example/debian
URIs: http://mirror.example/debian
Suites: bookworm
Components: main

Types: deb
URIs: http://mirror.example/debian-security
"""


@pytest.mark.parametrize(
    ("name", "text", "found"),
    [
        ("sources.list.d/debian.sources", NEW_FORMAT, "http://mirror.example/debian"),
        ("sources.list", "deb [arch=amd64] http://a.example/debian/ sid main\n", "http://a.example/debian/"),
        ("sources.list.d/other.list", "deb https://tools.example/apt stable main\n", None),
        ("sources.list", "# deb http://a.example/debian sid main\n", None),
        ("sources.list.d/notes.txt", "deb http://a.example/debian sid main\n", None),
    ],
)  # fmt: skip
def test_the_mirror_is_the_one_that_the_machine_is_set_up_with(
    name: str, text: str, found: str | None, tmp_path: Path
) -> None:
    file = tmp_path / name
    file.parent.mkdir(exist_ok=True)
    file.write_text(text)
    assert configured_mirror(tmp_path) == found


def test_where_no_chroot_can_be_made_the_reason_is_a_word(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(chroot, "CACHE", tmp_path)
    monkeypatch.setattr(chroot, "configured_mirror", lambda: None)
    monkeypatch.setattr("os.geteuid", lambda: 1000)
    with pytest.raises(NoChrootError, match="not root"):
        chroot.sid()
    monkeypatch.setattr("os.geteuid", lambda: 0)
    monkeypatch.setattr("shutil.which", lambda _tool: "/usr/bin/tool")
    with pytest.raises(NoChrootError, match="no Debian mirror"):
        chroot.sid()
    assert not list(tmp_path.iterdir())


def test_poses_out_of_the_golden_datagrams_are_the_golden_pose() -> None:
    frame = make_osc.whole()
    truth = {name: np.array(joint.p) for name, joint in frame.joints.items()}
    ((at_ns, pose),) = osc_poses(make_osc.kept("whole")).items()
    assert at_ns == frame.capture_unix_ns
    assert pose.keys() == truth.keys()
    assert greatest_error_m({name: list(at_m) for name, at_m in pose.items()}, truth) < 1e-4
    *_, seen = vmc_poses(make_vmc.kept("two"))
    # a person faces -Z there
    hand_m = seen["LeftHand"] * (-1.0, 1.0, -1.0)
    assert hand_m == pytest.approx(truth["leftHand"], abs=1e-3)


def test_a_lossless_copy_has_the_very_pixels_that_were_decoded(tmp_path: Path) -> None:
    lossy = tmp_path / "cam0.mp4"
    noise = np.random.default_rng(3).integers(0, 256, (6, 48, 64, 3), dtype=np.uint8)
    video = cv2.VideoWriter(str(lossy), cv2.VideoWriter.fourcc(*"mp4v"), 30.0, (64, 48))
    for pixels in noise:
        video.write(pixels)
    video.release()
    before, after = _pictures(lossy), _pictures(lossless_copy(lossy, 30.0))
    assert len(after) == 6
    assert all(np.array_equal(a, b) for a, b in zip(before, after, strict=True))


def _pictures(path: Path) -> list[np.ndarray]:
    source, pictures = cv2.VideoCapture(str(path)), []
    while (answer := source.read())[0]:
        pictures.append(answer[1])
    return pictures
