"""A daemon answers from the moment its outputs are open: first that it is starting, then how it fares."""

from pathlib import Path

import pytest

from mocapd.config.sections import Config
from mocapd.control.control_client import RunningDaemon, running_daemons
from mocapd.control.daemon_control import DaemonControl
from mocapd.control.last_trouble import LastTrouble
from mocapd.control.reloads import Reloads
from mocapd.control.socket_place import socket_path
from mocapd.errors import UnavailableError
from mocapd.service.open_outputs import OpenOutputs
from mocapd.service.service import Service
from tests.outputs.frames import eventually
from tests.service.test_service import session_of


def the_one(folder: Path) -> RunningDaemon:
    (daemon,) = running_daemons((folder,), services=()).daemons
    return daemon


def test_it_is_starting_until_there_is_a_session(tmp_path: Path) -> None:
    config = Config(outputs={}, state_dir=tmp_path, instance="hall")
    outputs = OpenOutputs(config)
    path = socket_path(tmp_path, 1)
    with DaemonControl(path, config, outputs, LastTrouble()) as control, outputs:
        assert running_daemons((tmp_path,), services=()).daemons == ()
        control.open()
        told = the_one(tmp_path).status
        assert (told.state, told.instance, told.cameras) == ("starting", "hall", ())
        for ask in (the_one(tmp_path).recenter, the_one(tmp_path).reload):
            with pytest.raises(UnavailableError, match="still starting"):
                ask()
        with Service(config, session_of("a"), outputs) as service:
            control.attach(service, Reloads())
            assert eventually(lambda: the_one(tmp_path).status.state == "tracking")
    assert running_daemons((tmp_path,), services=()).daemons == ()


def test_a_folder_that_cannot_be_written_is_told_and_no_trouble(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "file").write_text("")
    config = Config(outputs={}, state_dir=tmp_path)
    path = socket_path(tmp_path / "file", 1)
    with DaemonControl(path, config, OpenOutputs(config), LastTrouble()) as control:
        control.open()
    assert "`mocapd status` will not find this daemon" in caplog.text
