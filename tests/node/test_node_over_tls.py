"""A node that is exposed to a network: TLS, and who is who by password or by certificate."""

import shutil
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import pytest

from mocapd.capture.kinds.source_kinds import open_source
from mocapd.capture.remote.remote_source import RemoteSource
from mocapd.config.node_params import Params
from mocapd.errors import UnavailableError
from tests.node.node_pair import Running, StreamingWebcam, next_frame, opened, running_node
from tests.outputs.certificates import make_certificates
from tests.outputs.frames import free_port

pytestmark = pytest.mark.skipif(shutil.which("openssl") is None, reason="needs openssl")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("certificates")
    make_certificates(folder)
    (folder / "users").write_text("pc:secret\n")
    (folder / "users").chmod(0o600)
    return folder


def node_over_tls(folder: Path, port: int, **zenoh: Any) -> AbstractContextManager[Running]:
    """One with these certificates, which pairs with the user `pc`."""
    return running_node(
        StreamingWebcam("cam0"),
        params=Params(paired_user="pc"),
        listen=(f"tls/127.0.0.1:{port}",),
        tls_certificate=str(folder / "server.pem"),
        tls_private_key=str(folder / "server.key"),
        **zenoh,
    )


def remote(address: str) -> RemoteSource:
    source = open_source(address)
    assert isinstance(source, RemoteSource)
    return source


def test_over_tls_with_a_password(folder: Path) -> None:
    port = free_port()
    with node_over_tls(folder, port, password_file=str(folder / "users")) as running:
        (printed,) = running.node.addresses()
        assert printed == f"zenohs://pc:PASSWORD@127.0.0.1:{port}/attic/cam0"
        address = printed.replace("PASSWORD", "secret")
        source = opened(remote(f"{address}?ca={folder}/ca.pem"))
        assert source.takes_orders
        assert next_frame(source).pixels.shape == (48, 64, 3)
        source.close()
        for wrong in (
            address,  # an authority that nobody knows
            address.replace("secret", "guess") + f"?ca={folder}/ca.pem",
            address.replace("zenohs", "zenoh"),
        ):
            with pytest.raises(UnavailableError, match="check host and port, and user, password"):
                remote(wrong).open()


def test_certificates_say_who_may_look_and_who_may_set(folder: Path) -> None:
    port = free_port()
    with node_over_tls(folder, port, tls_root_ca=str(folder / "ca.pem"), tls_require_client=True):
        address = f"zenohs://127.0.0.1:{port}/attic/cam0?ca={folder}/ca.pem"
        for name, may_set in (("pc", True), ("viewer", False)):
            own = f"&certificate={folder}/{name}.pem&private_key={folder}/{name}.key"
            source = opened(remote(address + own))
            assert source.takes_orders == may_set
            assert next_frame(source).pixels.shape == (48, 64, 3)
            source.close()
        with pytest.raises(UnavailableError, match="certificates"):
            remote(address).open()
