"""A node and daemons at one router over TLS: the router knows them by their certificates, and decides who may set cameras."""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import zenoh

from mocapd.capture.kinds.source_kinds import open_source
from mocapd.capture.remote.remote_source import RemoteSource
from mocapd.capture.webcam.camera_controls import Control
from mocapd.config.node_params import Params
from mocapd.errors import CameraLost, UnavailableError
from tests.node.node_pair import StreamingWebcam, next_frame, opened, running_node
from tests.outputs.certificates import make_certificates
from tests.outputs.frames import free_port

pytestmark = pytest.mark.skipif(shutil.which("openssl") is None, reason="needs openssl")

PAGE = Path(__file__).resolve().parents[2] / "docs" / "camera-nodes.md"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("certificates")
    make_certificates(folder, "attic")
    return folder


def documented_access_control() -> dict[str, Any]:
    """The one that the documentation gives for a router."""
    text = PAGE.read_text().partition("```json\n")[2].partition("```")[0]
    found: dict[str, Any] = json.loads(text)
    return found


@pytest.fixture
def router(folder: Path) -> Iterator[str]:
    endpoint = f"tls/127.0.0.1:{free_port()}"
    config = {
        "mode": "router",
        "listen": {"endpoints": [endpoint]},
        "scouting": {"multicast": {"enabled": False}, "gossip": {"enabled": False}},
        "transport": {
            "link": {
                "tls": {
                    "listen_certificate": str(folder / "server.pem"),
                    "listen_private_key": str(folder / "server.key"),
                    "root_ca_certificate": str(folder / "ca.pem"),
                    "enable_mtls": True,
                }
            }
        },
        **documented_access_control(),
    }
    with zenoh.open(zenoh.Config.from_json5(json.dumps(config))):
        yield endpoint


def test_the_router_decides_who_sets_cameras(folder: Path, router: str) -> None:
    webcam = StreamingWebcam("left")
    with running_node(
        webcam,
        params=Params(router_decides=True),
        connect=(router,),
        tls_root_ca=str(folder / "ca.pem"),
        tls_certificate=str(folder / "attic.pem"),
        tls_private_key=str(folder / "attic.key"),
    ) as running:
        (printed,) = running.node.addresses()
        for name, may_set in (("pc", True), ("viewer", False)):
            own = f"certificate={folder}/{name}.pem&private_key={folder}/{name}.key"
            source = open_source(f"{printed}?ca={folder}/ca.pem&{own}")
            assert isinstance(source, RemoteSource)
            opened(source)
            assert next_frame(source).pixels.shape == (48, 64, 3)
            assert source.takes_orders == may_set
            device = source.device()
            if device is not None:
                assert device.write(Control.GAIN, 101) == 101
            webcam.plugged = False
            assert _says_why_it_is_lost(source)
            webcam.plugged = True
            source.close()
        with pytest.raises(UnavailableError):
            open_source(f"{printed}?ca={folder}/ca.pem").open()
    assert webcam.values[Control.GAIN] == 101


def _says_why_it_is_lost(source: RemoteSource) -> bool:
    with pytest.raises(CameraLost) as caught:
        _read_on(source)
    return "plugged" in str(caught.value)


def _read_on(source: RemoteSource) -> None:
    while True:
        source.read()
