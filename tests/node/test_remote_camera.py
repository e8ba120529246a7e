"""A camera at a node is used like a webcam: its pictures, their times, and what is told when it goes."""

from itertools import pairwise

import cv2
import numpy as np
import pytest

from mocapd.capture.camera_thread.capture_status import CaptureState
from mocapd.capture.camera_thread.reopening import RestartBudget
from mocapd.capture.camera_thread.thread import CaptureThread
from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.arrival_limit import ArrivalLimit
from mocapd.capture.remote.remote_address import parse_remote
from mocapd.capture.remote.remote_link import RemoteLink
from mocapd.capture.remote.remote_source import RemoteSource
from mocapd.capture.simulated.sim import SimSource
from mocapd.clock import monotonic_ns
from mocapd.config.node_params import Params
from mocapd.errors import CameraLost, ConfigError, UnavailableError
from mocapd.node.network_emulation import Imperfections
from mocapd.node.node_service import CameraNode
from mocapd.outputs.zenoh import zenoh_config
from mocapd.pipeline.latest import Latest
from mocapd.session.camera_inputs import CameraInput
from mocapd.types import Frame
from tests.attacks.node_kinds import KINDS
from tests.attacks.rogue_node import RogueNode
from tests.capture.films import numbered_sim_film
from tests.node.node_pair import Pluggable, next_frame, opened, running_node
from tests.outputs.frames import eventually, free_port
from tests.outputs.zenoh_pair import other_program


def test_pictures_come_as_the_camera_delivered_them() -> None:
    film = numbered_sim_film()
    with running_node(SimSource(film, "cam0")) as running:
        source = opened(running.source())
        frames = [next_frame(source) for _ in range(5)]
        source.close()
    for frame in frames:
        assert frame.camera == "left"
        assert frame.encoded in film.frames["cam0"]
        decoded = cv2.imdecode(np.frombuffer(frame.encoded or b"", np.uint8), cv2.IMREAD_COLOR)
        np.testing.assert_array_equal(frame.pixels, decoded)
        assert not frame.pixels.flags.writeable
    assert all(a.seq < b.seq and a.t_ns < b.t_ns for a, b in pairwise(frames))


def test_their_times_are_of_our_clock_whatever_the_nodes_shows() -> None:
    camera = Pluggable("cam0")
    faults = Imperfections(offset_s=3.0, drift_ppm=50.0)
    with running_node(camera, imperfections=faults) as running:
        source = opened(running.source())
        frames = [next_frame(source) for _ in range(20)]
        line = source.clock
        source.close()
    assert line is not None
    assert line.offset_ns == pytest.approx(
        faults.node_ns(line.reference_ns) - line.reference_ns, abs=2e7
    )
    # told: how far off a time may be
    told_ns = 6 * line.uncertainty_ns + line.asymmetry_ns
    for frame in frames:
        true_ns = camera.exposures_ns[frame.seq - 1]
        assert abs(frame.t_ns - true_ns) < told_ns + 1_000_000
        assert frame.t_ns <= monotonic_ns()


def test_a_node_whose_clock_runs_away_is_said_to_have_uncertain_times() -> None:
    with running_node(
        Pluggable("cam0"), imperfections=Imperfections(drift_ppm=300_000.0)
    ) as running:
        capture = CaptureThread(running.source(), Latest[Frame](), _died)
        capture.start()
        assert eventually(lambda: "its node" in capture.status().notice)
        assert capture.stop()


def test_of_a_node_that_sends_ten_times_the_rate_no_more_is_decoded_than_of_others() -> None:
    port, frames = free_port(), 60
    node = RogueNode(port, "attic", KINDS["300-hz"])
    node.start()
    try:
        source = opened(RemoteSource("left", parse_remote(f"zenoh://127.0.0.1:{port}/attic/cam0")))
        next_frame(source)
        began_ns = monotonic_ns()
        for _ in range(frames):
            next_frame(source)
        took_s = (monotonic_ns() - began_ns) / 1e9
        source.close()
    finally:
        node.stop()
    assert took_s > (frames - 5) / 45.0


def test_a_picture_that_is_no_jpeg_yet_is_encoded() -> None:
    with running_node(Pluggable("cam0")) as running:
        source = opened(running.source())
        frame = next_frame(source)
        source.close()
    assert frame.encoded is not None
    assert frame.encoded[:2] == b"\xff\xd8"
    assert abs(int(frame.pixels.mean()) - 90) < 3


def test_a_camera_unplugged_at_its_node_is_lost_with_the_nodes_reason_and_comes_back() -> None:
    camera = Pluggable("cam0")
    box: Latest[Frame] = Latest()
    with running_node(camera) as running:
        capture = CaptureThread(running.source(), box, _died)
        capture.start()
        assert eventually(lambda: capture.status().state is CaptureState.LIVE)
        camera.plugged = False
        assert eventually(lambda: "plugged" in _reason_when_lost(capture))
        camera.plugged = True
        assert eventually(lambda: capture.status().state is CaptureState.LIVE)
        assert capture.status().reopens == 1
        capture.stop()


def test_what_its_node_counts_is_not_counted_again() -> None:
    """Else whoever pulls its plug now and then has it left out for minutes, though its node has it back at once."""
    camera, box = Pluggable("cam0"), Latest[Frame]()
    with running_node(camera) as running:
        budget = RestartBudget(most=1, within_s=600.0, rest_s=600.0)
        capture = CaptureThread(running.source(), box, _died, budget=budget)
        capture.start()
        for _ in range(3):
            assert eventually(lambda: capture.status().state is CaptureState.LIVE)
            camera.plugged = False
            assert eventually(lambda: capture.status().state is CaptureState.LOST)
            camera.plugged = True
        assert eventually(lambda: capture.status().state is CaptureState.LIVE)
        capture.stop()


def test_the_node_says_at_once_that_a_camera_went_and_is_back() -> None:
    camera = Pluggable("cam0")
    with running_node(camera) as running:
        token = camera_wire.alive("attic", "cam0")
        with other_program(f"tcp/127.0.0.1:{running.port}") as session:
            assert eventually(lambda: any(session.liveliness().get(token, timeout=5.0)))
        link = RemoteLink(parse_remote(running.address()))
        link.listen(ArrivalLimit(100.0))
        camera.plugged = False
        assert eventually(lambda: link.is_gone)
        camera.plugged = True
        assert eventually(lambda: not link.is_gone)
        link.close()


def test_a_node_that_is_started_anew_is_found_again_with_its_new_clock() -> None:
    box: Latest[Frame] = Latest()
    port = free_port()
    with running_node(Pluggable("cam0"), port=port) as running:
        source = running.source()
        capture = CaptureThread(source, box, _died)
        capture.start()
        assert eventually(lambda: capture.status().state is CaptureState.LIVE)
    assert eventually(lambda: capture.status().state is CaptureState.LOST)
    with running_node(Pluggable("cam0"), port=port, imperfections=Imperfections(offset_s=-500.0)):
        assert eventually(lambda: capture.status().state is CaptureState.LIVE)
        box.get()
        frame = box.get(30.0)
        assert frame is not None
        assert 0 <= monotonic_ns() - frame.t_ns < 2_000_000_000
        capture.stop()


def test_late_and_lost_pictures_are_survived() -> None:
    faults = Imperfections(jitter_ms=20.0, loss=0.2)
    with running_node(Pluggable("cam0"), imperfections=faults) as running:
        source = opened(running.source())
        frames = [next_frame(source) for _ in range(40)]
        source.close()
    gaps = sum(b.seq - a.seq - 1 for a, b in pairwise(frames))
    assert gaps > 0
    assert all(a.t_ns < b.t_ns for a, b in pairwise(frames))


def test_what_does_not_fit_is_told() -> None:
    with running_node(Pluggable("cam0")) as running:
        # the node needs a picture before it knows its size
        opened(running.source()).close()
        with pytest.raises(ConfigError, match="64x48, but camera 'left' was calibrated at 640x480"):
            running.source(size_px=(640, 480)).open()
        with pytest.raises(UnavailableError, match="no camera 'cam7' of a node 'attic'"):
            running.source("cam7").open()
    with pytest.raises(UnavailableError, match="no camera node and no router answers"):
        running.source().open()


@pytest.mark.parametrize(
    ("names", "told"),
    [
        (("left/1", "left_1"), "'left/1' and 'left_1' are both 'left_1' in the keys"),
        (("left", "x" * 65), "is too long"),
    ],
)
def test_cameras_that_no_daemon_could_tell_apart_are_refused(
    names: tuple[str, str], told: str
) -> None:
    """Else each would get the pictures of both."""
    with (
        pytest.raises(ConfigError, match=told),
        running_node(*(Pluggable(name) for name in names)),
    ):
        pass


@pytest.mark.parametrize("options", ["#iface=lo", "?rel=1", "?rel=1#iface=lo"])
def test_an_address_has_no_options_of_the_nodes_own_endpoint(options: str) -> None:
    camera = CameraInput(Pluggable("cam0"), "/dev/video0")
    own = zenoh_config.Params(listen=(f"tcp/127.0.0.1:7447{options}",))
    (address,) = CameraNode("attic", own, Params(), [camera]).addresses()
    assert address == "zenoh://127.0.0.1:7447/attic/cam0"


def test_a_reader_is_woken_by_close() -> None:
    with running_node(Pluggable("cam0")) as running:
        source = opened(running.source())
        source.read()
        source.close()
        with pytest.raises(CameraLost):
            source.read()


def _died(error: BaseException) -> None:
    raise AssertionError from error


def _reason_when_lost(capture: CaptureThread) -> str:
    status = capture.status()
    return status.reason if status.state is CaptureState.LOST else ""
