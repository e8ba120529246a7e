"""The setup's step Cameras shows and locks a camera at a node like one that is plugged in here."""

from pathlib import Path
from typing import Any

import pytest

from mocapd.capture.webcam.camera_controls import Control
from mocapd.config.node_params import Params
from mocapd.config.sections import TrackerSection
from mocapd.wizard.check.check_settings import CheckSettings
from mocapd.wizard.draft import Draft, DraftCamera
from mocapd.wizard.hosts.own_host import OwnHost
from tests.node.node_pair import Pluggable, StreamingWebcam, running_node
from tests.outputs.frames import eventually


@pytest.fixture
def users(tmp_path: Path) -> str:
    path = tmp_path / "users"
    path.write_text("pc:secret\n")
    path.chmod(0o600)
    return str(path)


def rows(host: OwnHost) -> dict[str, dict[str, Any]]:
    """Of the cameras, by id."""
    details: dict[str, Any] = dict(host.wizard.view().view.details)
    return {row["id"]: row for row in details.get("cameras", [])}


def test_it_is_locked_and_given_back(tmp_path: Path, users: str) -> None:
    webcam, other = StreamingWebcam("left"), Pluggable("right")
    before = dict(webcam.values)
    with running_node(
        webcam, other, params=Params(paired_user="pc"), password_file=users
    ) as running:
        cameras = tuple(
            DraftCamera(name, running.address(name, "pc:secret@"), (64, 48), 30.0)
            for name in ("left", "right")
        )
        host = OwnHost(
            Draft(cameras=cameras),
            CheckSettings(TrackerSection()),
            tmp_path / "state",
            tmp_path / "cache",
        )
        host.start()
        try:
            assert eventually(lambda: {row["phase"] for row in rows(host).values()} == {"locked"})
            left, right = rows(host)["left"], rows(host)["right"]
            assert left["lockable"]
            assert left["controls"]["auto_exposure"] is False
            assert left["source"].startswith("zenoh://pc:***@127.0.0.1:")
            assert webcam.values[Control.AUTO_EXPOSURE] == 1
            # what is no webcam there only has to deliver
            assert not right["lockable"]
            assert host.hub.newest("right") is not None
            other.plugged = False
            assert eventually(lambda: rows(host)["right"]["phase"] == "lost")
            assert eventually(
                lambda: any("plugged" in one["what"] for one in rows(host)["right"]["problems"])
            )
        finally:
            host.stop()
        assert webcam.values[Control.AUTO_EXPOSURE] == before[Control.AUTO_EXPOSURE]
        assert webcam.values[Control.GAIN] == before[Control.GAIN]
