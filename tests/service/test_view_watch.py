"""What live cameras show is compared with their calibration, and told as a notice of the cameras concerned."""

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from mocapd.capture.capture_folder import frame_sets, load_folder
from mocapd.service.view_watch import ViewWatch
from mocapd.types import Rig


def test_exchanged_cameras_are_told_with_the_mend_and_lower_what_is_believed(
    dev_captures: Callable[[str], Path],
) -> None:
    folder = load_folder(dev_captures("stereo_plain_jog"))
    a, b = folder.rig.cameras
    exchanged = Rig((replace(b, name=a.name), replace(a, name=b.name)))
    watch = ViewWatch(exchanged, folder.stature_m, longest_s=5.0)
    watch.start()
    for one in frame_sets(folder):
        for frame in one.frames.values():
            watch.put(frame)
        time.sleep(0.002)  # a live camera leaves more time
    until_s = time.monotonic() + 300.0
    while not watch.notice(a.name) and time.monotonic() < until_s:
        time.sleep(0.1)
    watch.stop()
    assert "exchanged" in watch.notice(a.name)
    assert watch.is_exchanged(b.name)
    assert watch.off_m > 0.1


def test_without_a_rig_nothing_is_done() -> None:
    watch = ViewWatch(None)
    watch.start()
    watch.stop()
    assert (watch.off_m, watch.notice("any")) == (0.0, "")
