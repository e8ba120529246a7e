"""Exposed with TLS and passwords: who has both gets in, nobody else."""

import itertools
import shutil
import threading
from pathlib import Path

import pytest
import tomli_w
import zenoh

from mocapd.client import Client, Link
from mocapd.errors import UnavailableError
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.outputs.wire import SkeletonFrame
from mocapd.outputs.zenoh.zenoh_config import Params
from mocapd.outputs.zenoh.zenoh_sink import ZenohSink
from tests.cli.mocapd_process import mocapd_here
from tests.outputs.certificates import make_certificates
from tests.outputs.frames import eventually, free_port, small_frame

pytestmark = pytest.mark.skipif(shutil.which("openssl") is None, reason="needs openssl")


@pytest.fixture(scope="module")
def certificates(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An authority (ca.pem) and a certificate of 127.0.0.1 signed by it (server.pem, server.key)."""
    folder = tmp_path_factory.mktemp("certificates")
    make_certificates(folder)
    (folder / "users").write_text("game:secret\n")
    return folder


def test_only_the_right_login_over_tls_gets_the_stream(certificates: Path) -> None:
    endpoint = f"tls/127.0.0.1:{free_port()}"
    sink = ZenohSink(
        Params(
            listen=(endpoint,),
            tls_certificate=str(certificates / "server.pem"),
            tls_private_key=str(certificates / "server.key"),
            password_file=str(certificates / "users"),
        )
    )
    sink.open()
    ca = str(certificates / "ca.pem")
    with Client(Link(endpoint, tls_root_ca=ca, user="game", password="secret")) as client:
        assert eventually(lambda: sink.status().listeners == 1)
        sink.send(small_frame(seq=3))
        body = client.wait(30.0)
        assert body is not None
        assert body.seq == 3
    for refused in (
        Link(endpoint, tls_root_ca=ca, user="game", password="wrong", connect_timeout_s=0.0),
        Link(endpoint, tls_root_ca=ca, connect_timeout_s=0.0),
        Link(endpoint, user="game", password="secret", connect_timeout_s=0.0),
        Link(endpoint.replace("tls", "tcp"), user="game", password="secret", connect_timeout_s=0.0),
    ):
        with pytest.raises(UnavailableError, match="check tls_root_ca, user and password too"):
            Client(refused)
    sink.close()


def test_a_certificate_that_is_none_is_one_line(certificates: Path) -> None:
    users = str(certificates / "users")
    sink = ZenohSink(
        Params(
            listen=(f"tls/127.0.0.1:{free_port()}",), tls_certificate=users, tls_private_key=users
        )
    )
    with pytest.raises(UnavailableError, match="tls/127") as caught:
        sink.open()
    assert "\n" not in str(caught.value)
    assert isinstance(caught.value.__cause__, zenoh.ZError)


@pytest.mark.parametrize("words", ["watch --json --count 1", "record {}", "status --all"])
def test_commands_show_the_certificate_and_the_user_of_the_configuration(
    words: str, certificates: Path, clean_env: dict[str, str], tmp_path: Path
) -> None:
    endpoint = f"tls/127.0.0.1:{free_port()}"
    of_daemon = Params(
        listen=(endpoint,),
        tls_certificate=str(certificates / "server.pem"),
        tls_private_key=str(certificates / "server.key"),
        tls_root_ca=str(certificates / "ca.pem"),
        tls_require_client=True,
        password_file=str(certificates / "users"),
    )
    config = tmp_path / "config.toml"
    zenoh_table = {name: getattr(of_daemon, name) for name in of_daemon.__dataclass_fields__}
    config.write_text(tomli_w.dumps({"zenoh": zenoh_table}))
    recording = tmp_path / "a.mcap"
    argv: list[str | Path] = [*words.format(recording).split(), "--config", config]
    if words.startswith("record"):
        argv += ["--seconds", "1"]
    sink = ZenohSink(of_daemon, "pc")
    sink.open()
    over = threading.Event()

    def publish() -> None:
        for seq in itertools.count():
            sink.send(small_frame(seq=seq))
            if over.wait(0.02):
                return

    thread = threading.Thread(target=publish)
    thread.start()
    try:
        done = mocapd_here(clean_env, *argv)
    finally:
        over.set()
        thread.join()
        sink.close()
    assert "no mocapd at" not in done.err
    if words.startswith("record"):
        assert any(
            isinstance(one, SkeletonFrame) for one in RecordingReader(recording).everything()
        )
    else:
        assert "pc" in done.out
