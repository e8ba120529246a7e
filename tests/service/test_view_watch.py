"""What live cameras show is compared with their calibration."""

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from mocapd.calibrate.consistency.findings import Mistake
from mocapd.capture.capture_folder import frame_sets, load_folder
from mocapd.service.view_watch import ViewWatch
from mocapd.types import Frame, Rig


def test_exchanged_cameras_are_found_and_lower_what_is_believed(
    dev_captures: Callable[[str], Path],
) -> None:
    folder = load_folder(dev_captures("stereo_plain_jog"))
    a, b = folder.rig.cameras
    exchanged = Rig((replace(b, name=a.name), replace(a, name=b.name)))
    newest: dict[str, Frame] = {}
    watch = ViewWatch(exchanged, newest.get, folder.stature_m, longest_s=5.0)
    watch.start()
    for one in frame_sets(folder):
        for frame in one.frames.values():
            newest[frame.camera] = frame
            watch.put(frame)
        time.sleep(0.002)  # a live camera leaves more time
    until_s = time.monotonic() + 300.0
    while not watch.result.findings and time.monotonic() < until_s:
        time.sleep(0.1)
    watch.stop()
    [found] = [one for one in watch.result.findings if one.mistake is Mistake.EXCHANGED]
    assert found.cameras == (a.name, b.name)
    assert watch.off_m > 0.1
