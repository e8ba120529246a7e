"""The V4L2 source against a real uvcvideo driver: runs in the guest of ../shared/vm, not under pytest.

The guest's software webcams show a film whose frame number is in its top strip and follows the
wall clock, so that what a camera should see at an instant is known. docs/webcams.md has the
commands and a transcript. Needs root there (it plugs and unplugs), and no numba.

    python vm_proof.py list | usb | live | pause | yuyv | replug | stall | torn | controls | twins
    python vm_proof.py refusals
"""

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import logging
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from mocapd.capture.camera_thread.capture_status import CaptureState
from mocapd.capture.camera_thread.thread import CaptureThread
from mocapd.capture.webcam.controls import Controls
from mocapd.capture.webcam.identity import WebcamIdentity
from mocapd.capture.webcam.usb_devices import usb_webcams
from mocapd.capture.webcam.v4l2 import V4l2Source, WebcamSettings
from mocapd.capture.webcam.webcam_listing import list_cameras
from mocapd.capture.webcam.webcams import capture_nodes
from mocapd.clock import monotonic_ns
from mocapd.errors import MocapdError
from mocapd.types import Bytes, Frame

CAM = "/mnt/share/rig/cam.sh"
BEGAN_NS = monotonic_ns()
FILM = 300  # frames, at 30 Hz


def say(*words: object) -> None:
    print(f"[{(monotonic_ns() - BEGAN_NS) / 1e9:7.3f}]", *words, flush=True)


def rig(*words: str) -> None:
    """plug N [--port P --serial S] | unplug N | ctl N COMMAND"""
    done = subprocess.run(["bash", CAM, *words], capture_output=True, text=True, check=False)
    say(">>", *words, "->", (done.stdout + done.stderr).strip() or "done")


def number_of(pixels: Bytes) -> int:
    """The film's frame number: 16 blocks of 40 px, bit b white or black."""
    bits = pixels[16, 20:640:40].mean(axis=1) > 127
    return int((bits << np.arange(16)).sum())


class Record:
    """A mailbox that notes of each frame: its time, its age on arrival, its number."""

    def __init__(self) -> None:
        self.seen: list[tuple[int, int, int, int]] = []  # t_ns, arrival_ns, seq, number

    def put(self, item: Frame, /) -> None:
        arrival_ns = monotonic_ns()
        self.seen.append((item.t_ns, arrival_ns, item.seq, number_of(item.pixels)))


class Bench:
    """Every webcam that is plugged in, each with its thread."""

    def __init__(self, settings: WebcamSettings | None = None) -> None:
        self.identities = tuple(capture_nodes())
        self.sources = [
            V4l2Source(
                f"cam{n}",
                identity,
                settings,
                others=tuple(one for one in self.identities if one != identity),
            )
            for n, identity in enumerate(self.identities)
        ]
        self.records = [Record() for _ in self.sources]
        self.threads = [
            CaptureThread(source, record, died, expected_hz=30.0)
            for source, record in zip(self.sources, self.records, strict=True)
        ]
        for thread in self.threads:
            thread.start()
        until("all live", lambda: all(t.status().state is CaptureState.LIVE for t in self.threads))
        for source in self.sources:
            say(source.name, source.negotiated)

    def stop(self) -> None:
        for thread in self.threads:
            thread.let_go()
        for thread in self.threads:
            began_ns = monotonic_ns()
            joined = thread.stop()
            say("stop", thread.status().camera, "joined", joined, f"{ms(began_ns):.0f} ms")


def died(error: BaseException) -> None:
    say("DIED", repr(error))


def ms(began_ns: int) -> float:
    return (monotonic_ns() - began_ns) / 1e6


def until(what: str, condition: Callable[[], bool], timeout_s: float = 20.0) -> None:
    began_ns = monotonic_ns()
    while not condition():
        if ms(began_ns) > timeout_s * 1e3:
            say("NOT", what, f"within {timeout_s} s")
            return
        time.sleep(0.002)
    say(what, f"after {ms(began_ns):.0f} ms")


def show(bench: Bench) -> None:
    for thread in bench.threads:
        s = thread.status()
        say(
            f"  {s.camera}: {s.state}, {s.frames} frames, {s.torn} torn, {s.reopens} reopens, "
            f"{s.fps_hz:.2f} Hz {s.reason}"
        )


def show_list() -> None:
    for row in list_cameras():
        say(row.node, repr(row.name), row.usb_id, "port", row.port_path, "->", row.spec)
        for one in row.formats:
            say("     ", one.fourcc, one.size_px, one.rates_hz)
        say("      usable", row.usable, "|", row.problem, "|", row.fix, "|", row.note)


def step_list() -> None:
    show_list()


def step_usb() -> None:
    for one in usb_webcams():
        say("pyusb", one.identity, repr(one.product), "serial known:", one.has_serial)
    for identity, node in capture_nodes().items():
        say("sysfs", identity, node.node)


def step_live() -> None:
    bench = Bench()
    time.sleep(10.0)
    show(bench)
    bench.stop()
    for source, record in zip(bench.sources, bench.records, strict=True):
        seen = np.array(record.seen)
        gaps = np.diff(seen[:, 0]) / 1e6
        ages = (seen[:, 1] - seen[:, 0]) / 1e6
        steps = np.diff(seen[:, 3]) % FILM
        say(
            f"{source.name}: {len(seen)} frames, {1e3 / gaps.mean():.3f} Hz, gaps ms p5 "
            f"{np.percentile(gaps, 5):.1f} p95 {np.percentile(gaps, 95):.1f}, age on arrival ms "
            f"median {np.median(ages):.1f} p95 {np.percentile(ages, 95):.1f}, film steps "
            f"!= 1: {int((steps != 1).sum())}, seq gaps {int((np.diff(seen[:, 2]) != 1).sum())}"
        )
    a, b = (np.array(record.seen) for record in bench.records)
    nearest = np.abs(a[:, 0, None] - b[None, :, 0]).argmin(axis=1)
    apart = (a[:, 3] - b[nearest, 3] + FILM // 2) % FILM - FILM // 2
    say(
        f"paired by time: median distance {np.median(np.abs(a[:, 0] - b[nearest, 0])) / 1e6:.2f} ms,"
        f" film frames apart: {(apart == 0).sum()} of {len(apart)} none, at most {abs(apart).max()}"
    )


def step_pause() -> None:
    """How old the frames are that wait in the driver after the reader paused."""
    source = V4l2Source("cam0", next(iter(capture_nodes())))
    source.open()
    for _ in range(10):
        source.read()
    time.sleep(1.0)
    ages = [f"{(monotonic_ns() - source.read().t_ns) / 1e6:.0f}" for _ in range(5)]
    source.close()
    say("ages of the frames after a pause of 1 s [ms]:", ages)


def step_yuyv() -> None:
    """A webcam that has no MJPG: camera 2 of the rig, which has no film."""
    rig("plug", "2")
    show_list()
    identity = next(one for one in capture_nodes() if one.serial == "CAM0002")
    source = V4l2Source("raw", identity)
    source.open()
    frames = [source.read() for _ in range(30)]
    source.close()
    seconds = (frames[-1].t_ns - frames[0].t_ns) / 1e9
    say(source.negotiated, frames[-1].pixels.shape, f"{29 / seconds:.1f} Hz, torn {source.torn}")
    rig("unplug", "2")


def step_replug() -> None:
    bench = Bench()
    time.sleep(1.0)
    lost, stays = bench.threads
    for port in ("0", "4", "0"):
        rig("unplug", "0")
        until("lost", lambda: lost.status().state is CaptureState.LOST)
        show(bench)
        time.sleep(1.5)
        before = stays.status().frames
        say("nodes", sorted(path.name for path in Path("/dev").glob("video*")))
        plugging = threading.Thread(target=rig, args=("plug", "0", "--port", port))
        plugging.start()
        until("the node is back", lambda: any(one.serial == "CAM0000" for one in capture_nodes()))
        until("live again", lambda: lost.status().state is CaptureState.LIVE)
        plugging.join()
        say(bench.sources[0].negotiated)
        time.sleep(1.0)
        show(bench)
        say("the other went on:", stays.status().frames - before, "frames meanwhile")
    bench.stop()


def step_stall() -> None:
    bench = Bench()
    time.sleep(1.0)
    stalled = bench.threads[0]
    rig("ctl", "0", "freeze")
    began_ns = monotonic_ns()
    status = stalled.status()
    answered_ms = ms(began_ns)
    age_ms = (monotonic_ns() - (status.last_frame_ns or 0)) / 1e6
    say(
        f"status answers in {answered_ms:.3f} ms while the read blocks: newest is {age_ms:.0f} ms old"
    )
    until("lost", lambda: stalled.status().state is CaptureState.LOST)
    show(bench)
    time.sleep(3.0)
    show(bench)
    rig("ctl", "0", "thaw")
    until("live again", lambda: stalled.status().state is CaptureState.LIVE)
    time.sleep(1.0)
    show(bench)
    rig("ctl", "0", "freeze")
    time.sleep(0.2)
    bench.stop()
    rig("ctl", "0", "thaw")


def step_torn() -> None:
    bench = Bench()
    time.sleep(1.0)
    rig("ctl", "0", "corrupt", "10")
    time.sleep(2.0)
    show(bench)
    bench.stop()
    seen = np.array(bench.records[0].seen)
    behind = np.diff(seen[:, 3]) % FILM
    say("film steps != 1 of cam0:", behind[behind != 1], "its seq gaps:", np.diff(seen[:, 2]).max())


def step_controls() -> None:
    wanted = Controls(exposure=100, gain=20, wb_temperature=5000, focus=30)
    held = "v4l2-ctl -d {} -C auto_exposure,exposure_time_absolute,white_balance_automatic,"
    held += "white_balance_temperature,gain,focus_automatic_continuous,focus_absolute"
    bench = Bench(WebcamSettings(controls=wanted))
    for again in (False, True):
        if again:
            rig("unplug", "0")
            time.sleep(0.5)
            rig("plug", "0")
            until("live", lambda: bench.threads[0].status().state is CaptureState.LIVE)
        negotiated = bench.sources[0].negotiated
        command = held.format(negotiated.node if negotiated else "").split()
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        say("after a replug" if again else "at first", "|", done.stdout.replace("\n", " | "))
    bench.stop()
    bench = Bench(WebcamSettings(fps_hz=60.0, controls=Controls(gain=999)))
    bench.stop()


def step_twins() -> None:
    for n in ("0", "1"):
        rig("unplug", n)
    for n in ("0", "1"):
        rig("plug", n, "--serial", "SAME")
    links = sorted(Path("/dev/v4l/by-id").glob("*index0"))
    say("by-id links:", [(link.name, link.resolve().name) for link in links])
    show_list()
    bench = Bench()
    rig("unplug", "0")
    until("lost", lambda: bench.threads[0].status().state is CaptureState.LOST)
    time.sleep(2.0)
    show(bench)
    rig("plug", "0", "--serial", "SAME", "--port", "5")
    until("live", lambda: bench.threads[0].status().state is CaptureState.LIVE)
    say(bench.sources[0].negotiated)
    bench.stop()
    for n in ("0", "1"):
        rig("unplug", n)
        rig("plug", n)


def step_refusals() -> None:
    bench = Bench()
    identity = bench.identities[0]
    subprocess.run([sys.executable, __file__, "list"], check=True)  # as another process sees it
    nodes = capture_nodes()
    metadata = Path(f"/dev/video{int(nodes[identity].node.name.removeprefix('video')) + 1}")
    other = WebcamIdentity("1-7", "dead", "beef", "")
    too_big = WebcamSettings(size_px=(1280, 720))
    tried = [
        V4l2Source("again", identity),
        V4l2Source("metadata", metadata),
        V4l2Source("absent", other),
        V4l2Source("none", Path("/dev/video33")),
        V4l2Source("null", Path("/dev/null")),
    ]
    for source in tried:
        attempt(source)
    bench.stop()
    attempt(V4l2Source("size", identity, too_big))


def attempt(source: V4l2Source) -> None:
    began_ns = monotonic_ns()
    try:
        source.open()
        say(source.name, "opened?!")
    except MocapdError as error:
        say(f"{source.name}: {type(error).__name__}: {error}  ({ms(began_ns):.1f} ms)")
    source.close()


STEPS: dict[str, Callable[[], None]] = {
    name.removeprefix("step_"): value
    for name, value in globals().copy().items()
    if name.startswith("step_")
}

if __name__ == "__main__":
    logging.basicConfig(level=logging.INFO, format="            log %(levelname)s %(message)s")
    say(sys.argv[1], "-", threading.active_count(), "thread")
    STEPS[sys.argv[1]]()
