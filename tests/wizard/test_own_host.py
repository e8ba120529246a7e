"""A setup by itself, whose cameras ail."""

from pathlib import Path

from mocapd.capture.simulated.sim import SimSource
from mocapd.capture.simulated.socket_camera import SocketCamera
from mocapd.capture.simulated.sockets import Fault, Sockets
from mocapd.config.sections import TrackerSection
from mocapd.wizard.check.check_settings import CheckSettings
from mocapd.wizard.draft import Draft, DraftCamera
from mocapd.wizard.hosts.own_host import OwnHost
from tests.capture.films import numbered_sim_film
from tests.capture.socket_control import SocketControl
from tests.outputs.frames import eventually


def test_a_driver_that_hangs_is_left_to_itself_and_its_camera_taken_up_again(
    tmp_path: Path,
) -> None:
    control = SocketControl(tmp_path / "sockets.json", {"cam0": "usb:1-1:046d:0825:A0"})
    film = numbered_sim_film()
    camera = SocketCamera("cam0", Sockets(control.path), lambda name: SimSource(film, name))
    host = OwnHost(
        Draft(cameras=(DraftCamera("cam0", "usb:1-1:046d:0825:A0", (64, 48), 30.0),)),
        CheckSettings(TrackerSection()),
        *(tmp_path / "state", tmp_path / "cache"),
        sources={"cam0": camera},
    )

    def trouble() -> str:
        assert not host.wait(0.0)
        return next(iter(host.wizard.statuses().values())).trouble

    host.start()
    try:
        assert eventually(lambda: host.hub.newest("cam0") is not None)
        control.ail("cam0", Fault.STUCK)
        assert eventually(lambda: "its driver has not come back" in trouble())
        control.unplug("cam0")
        control.plug("cam0")
        assert eventually(lambda: trouble() == "")
    finally:
        host.stop()
