"""Who logs in wrongly to an exposed daemon is not let in, and who is let in cannot play the daemon."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest
import zenoh

from mocapd.client import Client, Link
from mocapd.errors import UnavailableError
from mocapd.outputs.zenoh.zenoh_config import Params
from mocapd.outputs.zenoh.zenoh_sink import ZenohSink
from tests.outputs.certificates import make_certificates, make_expired
from tests.outputs.frames import eventually, free_port, small_frame
from tests.outputs.test_zenoh_sink import HEALTH
from tests.outputs.zenoh_pair import GET_S, other_program, running_sink

needs_openssl = pytest.mark.skipif(shutil.which("openssl") is None, reason="needs openssl")


@pytest.fixture(scope="module")
def ours(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Certificates of our authority, some of them expired, and a file of users."""
    folder = tmp_path_factory.mktemp("ours")
    make_certificates(folder)
    make_expired(folder, "viewer", "late")
    make_expired(folder, "server", "late-server")
    (folder / "users").write_text("game:secret\n")
    (folder / "users").chmod(0o600)
    return folder


@pytest.fixture(scope="module")
def theirs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same names, by an authority of somebody else."""
    folder = tmp_path_factory.mktemp("theirs")
    make_certificates(folder)
    return folder


def exposed(folder: Path, server: str = "server", **more: object) -> tuple[ZenohSink, str]:
    """An open sink behind TLS, and its endpoint."""
    endpoint = f"tls/127.0.0.1:{free_port()}"
    certificate, key = str(folder / f"{server}.pem"), str(folder / f"{server}.key")
    sink = ZenohSink(
        Params(listen=(endpoint,), tls_certificate=certificate, tls_private_key=key, **more),  # type: ignore[arg-type]
        "pc",
    )
    sink.open()
    return sink, endpoint


def is_refused(link: Link) -> bool:
    try:
        Client(replace(link, connect_timeout_s=0.0)).close()
    except UnavailableError:
        return True
    return False


def hears_frames(sink: ZenohSink, link: Link) -> bool:
    with Client(replace(link, connect_timeout_s=30.0)) as client:
        assert eventually(lambda: sink.status().listeners == 1)
        sink.send(small_frame(seq=3))
        body = client.wait(30.0)
    return body is not None and body.seq == 3


@needs_openssl
def test_only_certificates_of_our_authority_that_are_valid_are_let_in(
    ours: Path, theirs: Path
) -> None:
    ca = str(ours / "ca.pem")
    sink, endpoint = exposed(ours, tls_root_ca=ca, tls_require_client=True)

    def link(folder: Path, name: str) -> Link:
        certificate, key = str(folder / f"{name}.pem"), str(folder / f"{name}.key")
        return Link(endpoint, tls_root_ca=ca, certificate=certificate, private_key=key)

    try:
        assert is_refused(Link(endpoint, tls_root_ca=ca))
        assert is_refused(link(theirs, "viewer"))
        assert is_refused(link(ours, "late"))
        assert hears_frames(sink, link(ours, "viewer"))
    finally:
        sink.close()


@needs_openssl
def test_a_game_gives_its_password_to_no_daemon_that_another_authority_or_none_vouches_for(
    ours: Path, theirs: Path
) -> None:
    def link(endpoint: str, authority: Path) -> Link:
        ca = str(authority / "ca.pem")
        return Link(endpoint, tls_root_ca=ca, user="game", password="secret")

    sink, endpoint = exposed(theirs, password_file=str(ours / "users"))
    try:
        assert is_refused(link(endpoint, ours))
        assert hears_frames(sink, link(endpoint, theirs))
    finally:
        sink.close()
    sink, endpoint = exposed(ours, "late-server", password_file=str(ours / "users"))
    try:
        assert is_refused(link(endpoint, ours))
    finally:
        sink.close()


def test_nobody_answers_in_the_daemons_place_nor_shows_that_it_lives() -> None:
    with (
        running_sink() as running,
        other_program(running.endpoint) as intruder,
        other_program(running.endpoint) as game,
        intruder.declare_queryable(
            "mocapd/**", lambda query: query.reply(query.key_expr, b"forged"), complete=True
        ),
        intruder.liveliness().declare_token("mocapd/v1/forged/alive"),
    ):
        running.sink.send_state(HEALTH)
        for key in ("mocapd/v1/pc/health", "mocapd/v1/*/health", "mocapd/v1/pc/rest_skeleton/0"):
            replies = list(game.get(key, target=zenoh.QueryTarget.ALL, timeout=GET_S))
            assert all(one.ok and one.ok.payload.to_bytes() != b"forged" for one in replies), key
        alive = game.liveliness().get("mocapd/v1/*/alive", timeout=GET_S)
        assert [str(one.ok.key_expr) for one in alive if one.ok] == ["mocapd/v1/pc/alive"]


def test_nobody_tells_others_of_the_daemons_state() -> None:
    key = "mocapd/v1/pc/health"
    with (
        running_sink(format="json") as running,
        other_program(running.endpoint) as intruder,
        other_program(running.endpoint) as game,
        game.declare_subscriber(key) as subscriber,
    ):
        heard: list[zenoh.Sample] = []

        def is_told() -> bool:  # as soon as the daemon knows of the subscription
            intruder.put(key, b"forged")
            intruder.delete(key)
            list(intruder.get(key, timeout=GET_S))  # by now both have arrived
            running.sink.send_state(HEALTH)
            heard.extend(iter(subscriber.try_recv, None))
            return len(heard) >= 3

        assert eventually(is_told)
        assert all(one.kind == zenoh.SampleKind.PUT for one in heard)
        assert all(b'"tracker":"colour"' in one.payload.to_bytes() for one in heard)
