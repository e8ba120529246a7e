"""Controls of a webcam at a node: set by the paired daemon as if it were plugged in there, by nobody else."""

from pathlib import Path

import pytest
import zenoh

from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.camera_wire import Done, Order
from mocapd.capture.webcam.camera_controls import Control
from mocapd.config.node_params import Params
from mocapd.errors import ConfigError
from mocapd.wizard.cameras.camera_locks import CameraLocks
from tests.node.node_pair import Running, StreamingWebcam, next_frame, opened, running_node
from tests.outputs.zenoh_pair import other_program

PAIRED = Params(paired_user="pc")


@pytest.fixture
def users(tmp_path: Path) -> str:
    path = tmp_path / "users"
    path.write_text("pc:secret\nviewer:look\n")
    path.chmod(0o600)
    return str(path)


def test_the_wizard_locks_a_remote_camera_like_one_of_its_own(users: str) -> None:
    webcam = StreamingWebcam("cam0")
    before = dict(webcam.values)
    with running_node(webcam, params=PAIRED, password_file=users) as running:
        source = opened(running.source(login="pc:secret@"))
        locks = CameraLocks([source])
        assert locks.can_lock("left")
        locks.set_free("left")
        locks.lock("left", 30.0, None)
        assert webcam.values[Control.AUTO_EXPOSURE] == 1
        locks.write("left", Control.GAIN, 99)
        assert webcam.values[Control.GAIN] == 99
        assert locks.range("left", Control.EXPOSURE) is not None
        controls = locks.keep("left", None)
        assert controls.gain == 99
        # the node holds it, so also when the camera comes back there
        assert webcam.settings.controls.gain == 99
        locks.restore()
        source.close()
    assert {key: webcam.values[key] for key in before if key is not Control.EXPOSURE} == {
        key: value for key, value in before.items() if key is not Control.EXPOSURE
    }


def test_what_was_locked_is_held_by_a_node_that_was_started_anew(users: str) -> None:
    webcam = StreamingWebcam("cam0")
    with running_node(webcam, params=PAIRED, password_file=users) as running:
        source = opened(running.source(login="pc:secret@"))
        locks = CameraLocks([source])
        locks.set_free("left")
        locks.lock("left", 30.0, None)
        locks.write("left", Control.GAIN, 77)
        locks.keep("left", None)
    source.close()
    another = StreamingWebcam("cam0")
    with running_node(another, port=running.port, params=PAIRED, password_file=users):
        opened(source)
        assert another.values[Control.GAIN] == 77
        source.close()


@pytest.mark.parametrize("login", ["viewer:look@", ""])
def test_others_see_pictures_at_most(users: str, login: str) -> None:
    webcam = StreamingWebcam("cam0")
    if not login:  # nobody needs to log in, so nobody can be the paired one
        with running_node(webcam) as running:
            source = opened(running.source())
            assert not CameraLocks([source]).can_lock("left")
            assert next_frame(source).pixels.shape == (48, 64, 3)
            source.close()
        return
    with running_node(webcam, params=PAIRED, password_file=users) as running:
        source = opened(running.source(login=login))
        assert not source.takes_orders
        assert next_frame(source).pixels.shape == (48, 64, 3)
        source.close()
        assert _answers(running, login, Order("write", Control.GAIN, 200)) == []
    assert webcam.values[Control.GAIN] == 64


def test_orders_that_are_nonsense_are_refused_and_told(users: str) -> None:
    webcam = StreamingWebcam("cam0")
    with running_node(webcam, params=PAIRED, password_file=users) as running:
        opened(running.source(login="pc:secret@")).close()
        for order, trouble in (
            (Order("write", Control.GAIN, 256), "takes 0 to 255"),
            (Order("write"), "no control"),
            (b"\x00nonsense", "not understood"),
            (b"x" * 20_000, "not understood"),
        ):
            (done,) = _answers(running, "pc:secret@", order)
            assert trouble in done.trouble
    assert webcam.values[Control.GAIN] == 64


def test_nobody_writes_where_a_node_writes(users: str) -> None:
    with running_node(StreamingWebcam("cam0"), params=PAIRED, password_file=users) as running:
        source = opened(running.source(login="pc:secret@"))
        with _session(running, "viewer:look@") as session:
            stamp = camera_wire.encode(camera_wire.PictureStamp(1, 1, 1))
            for _ in range(20):
                session.put(camera_wire.picture("attic", "cam0"), b"forged", attachment=stamp)
            frames = [next_frame(source) for _ in range(10)]
        assert source.torn == 0
        assert len(frames) == 10
        source.close()


def test_nobody_answers_where_a_node_answers(users: str) -> None:
    webcam = StreamingWebcam("cam0")
    with (
        running_node(webcam, params=PAIRED, password_file=users) as running,
        _session(running, "viewer:look@") as viewer,
        viewer.declare_queryable(
            "mocapd-camera/**", lambda query: query.reply(query.key_expr, b"forged"), complete=True
        ),
    ):
        source = opened(running.source(login="pc:secret@"))
        (done,) = _answers(running, "pc:secret@", Order("write", Control.GAIN, 99))
        assert (done.value, done.trouble) == (99, "")
        with _session(running, "pc:secret@") as session:
            for key in (camera_wire.state("*", "*"), camera_wire.clock("attic")):
                replies = list(session.get(key, target=zenoh.QueryTarget.ALL, timeout=5.0))
                assert replies
                assert all(one.ok and one.ok.payload.to_bytes() != b"forged" for one in replies)
        source.close()
    assert webcam.values[Control.GAIN] == 99


@pytest.mark.parametrize(
    ("params", "zenoh_params", "message"),
    [
        (PAIRED, {}, "no client can authenticate as 'pc'"),
        (PAIRED, {"connect": ("tcp/127.0.0.1:9",)}, "behind a router"),
        (Params(router_decides=True), {}, "no router to decide"),
    ],
)
def test_a_pairing_that_would_protect_nothing_is_refused(
    params: Params, zenoh_params: dict[str, object], message: str
) -> None:
    with (
        pytest.raises(ConfigError, match=message),
        running_node(StreamingWebcam("cam0"), params=params, **zenoh_params),  # type: ignore[arg-type]
    ):
        pass


def _session(running: Running, login: str) -> zenoh.Session:
    user, _, password = login.removesuffix("@").partition(":")
    return other_program(
        f"tcp/127.0.0.1:{running.port}",
        transport={"auth": {"usrpwd": {"user": user, "password": password}}},
    )


def _answers(running: Running, login: str, order: Order | bytes) -> list[Done]:
    data = order if isinstance(order, bytes) else camera_wire.encode(order)
    with _session(running, login) as session:
        replies = session.get(camera_wire.control("attic", "cam0"), payload=data, timeout=5.0)
        return [camera_wire.decode(r.ok.payload.to_bytes(), Done) for r in replies if r.ok]
