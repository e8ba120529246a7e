"""udev's word of a camera is heard where there is udev, and not missed where there is none."""

import shutil
import subprocess
import sys

import pytest

from tests.conftest import ROOT

UNSHARE = ["unshare", "--map-root-user", "--net"]


def own_network() -> bool:
    """Whether a process may have a network namespace, in which it may speak as udev."""
    if shutil.which("unshare") is None:
        return False
    return subprocess.run([*UNSHARE, "true"], check=False, capture_output=True).returncode == 0


def said_by(command: list[str]) -> str:
    ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


@pytest.mark.skipif(not own_network(), reason="no network namespace is to be had")
def test_a_camera_that_comes_is_heard_and_nothing_else_also_after_a_flood() -> None:
    said = said_by([*UNSHARE, sys.executable, "-m", "tests.capture.announced_camera"])
    assert said.splitlines() == [
        *("can hear True", "of others False", "of a camera True"),
        "after more than is taken at once True",
    ]


def test_without_libudev_nothing_is_heard_and_nothing_fails() -> None:
    without = (
        "import sys; sys.modules['pyudev'] = None\n"
        "from mocapd.capture.webcam.plug_events import PlugEvents\n"
        "events = PlugEvents(print); print(events.start()); events.stop()"
    )
    assert said_by([sys.executable, "-c", without]) == "False\n"
