"""A network camera's password is known to its source, and shown to nobody."""

import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from mocapd.calibrate.bump.bump_watch import Mounting
from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.capture.kinds.source_kinds import open_source
from mocapd.capture.source_request import SourceRequest
from mocapd.capture.url import UrlSource
from mocapd.config.sections import CameraSection, Config, TrackerSection
from mocapd.errors import ConfigError, InputError
from mocapd.pipeline.bundler import CameraCounts
from mocapd.pipeline.metrics import CameraMetrics
from mocapd.service.health import camera_message
from mocapd.service.service import Service
from mocapd.session.session import open_session
from mocapd.wizard.hosts.daemon_host import DaemonHost

ADDRESS = "rtsp://admin:hunter2@127.0.0.1:9/live?token=hunter2"
SHOWN = "rtsp://admin:***@127.0.0.1:9/live?token=***"


def config_of(address: str, folder: Path) -> Config:
    return Config(
        camera=(CameraSection("net", address),),
        tracker=TrackerSection(name="canned"),
        outputs={},
        state_dir=folder / "state",
        cache_dir=folder / "cache",
    )


def test_its_status_and_its_records_show_it_masked(tmp_path: Path) -> None:
    (camera,) = open_session(config_of(ADDRESS, tmp_path), lambda *_: None).cameras
    status = CaptureStatus("net", CaptureState.LOST, "", 0, 0, 0, 0.0, None)
    metrics = CameraMetrics(0.0, CameraCounts(0, 0, 0, 0))
    assert camera_message("home", camera, status, metrics, Mounting.UNKNOWN).source == SHOWN
    assert "hunter2" not in repr(camera)
    assert camera.address == ADDRESS


def test_a_hash_in_a_url_makes_no_folder_of_it(tmp_path: Path) -> None:
    session = open_session(config_of("http://127.0.0.1:9/v#hunter2", tmp_path), lambda *_: None)
    assert isinstance(session.cameras[0].source, UrlSource)


def test_the_daemon_and_a_setup_on_it_wait_for_a_camera_as_the_configuration_says(
    tmp_path: Path,
) -> None:
    config = config_of(ADDRESS, tmp_path)
    config = replace(config, camera=(replace(config.camera[0], wait_s=0.25),))
    service = Service(config, open_session(config, lambda *_: None))
    assert service.hub.bundler.camera_waits_s == {"net": 0.25}


@pytest.fixture
def host(tmp_path: Path) -> Iterator[DaemonHost]:
    config = config_of(ADDRESS, tmp_path)
    host = DaemonHost(Service(config, open_session(config, lambda *_: None)))
    yield host
    host.rest()


def test_a_setup_on_the_daemons_cameras_knows_the_true_address(host: DaemonHost) -> None:
    assert [camera.source for camera in host.setup().draft.cameras] == [ADDRESS]


def test_a_typing_error_in_the_scheme_does_not_show_it() -> None:
    with pytest.raises(InputError, match="no such camera or file") as caught:
        open_source("rtps://admin:hunter2@127.0.0.1/live")
    assert "hunter2" not in str(caught.value)


@pytest.mark.parametrize(
    "address", ["rtsp://admin:hunter2@[bad", "rtsp://admin:hun/ter2@cam/x", "http:cam"]
)
def test_what_is_no_address_is_refused_at_the_start(address: str) -> None:
    with pytest.raises(ConfigError, match=r"address.*rtsp://user:password@host") as caught:
        open_source(address, SourceRequest("net"))
    assert "ter2" not in str(caught.value)


def test_the_libraries_print_nothing_of_a_camera_that_does_not_answer(
    clean_env: dict[str, str],
) -> None:
    code = (
        "from mocapd.capture.url import UrlSource\n"
        "from mocapd.errors import UnavailableError\n"
        "for scheme in ('rtsp', 'http', 'https'):\n"
        "    source = UrlSource('net', scheme + '://admin:hunter2@127.0.0.1:9/live')\n"
        "    try:\n"
        "        source.open()\n"
        "    except UnavailableError as error:\n"
        "        print(error)\n"
    )
    env = {k: v for k, v in clean_env.items() if not k.startswith("OPENCV_")}
    done = subprocess.run(
        [sys.executable, "-c", code], env=env, capture_output=True, text=True, check=True
    )
    assert done.stderr == ""
    assert done.stdout.count("admin:***@127.0.0.1:9") == 3
    assert "hunter2" not in done.stdout
