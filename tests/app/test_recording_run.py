"""A recorder beside a daemon writes everything that is published."""

import signal
import threading
from functools import partial
from pathlib import Path

import pytest

from mocapd.app.recordings.published import PublishedStream
from mocapd.app.recordings.recording_run import Recorder, duration
from mocapd.app.terminal.status_line import StatusLine
from mocapd.boundary.mcap_records import McapAttachment, McapFile
from mocapd.capture.recording.mcap_origin import open_recording
from mocapd.capture.recording.recording_metadata import metadata_of
from mocapd.client import Link
from mocapd.errors import InputError, UnavailableError
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.outputs.mcap.recording_writer import RecordingParams, RecordingWriter
from mocapd.outputs.messages import RestSkeleton
from mocapd.outputs.wire import SkeletonFrame
from tests.cli.mocapd_process import mocapd_here, start
from tests.outputs.frames import eventually, free_port
from tests.outputs.recorded import cameras, frames, rest
from tests.outputs.zenoh_pair import Running, running_sink

PATIENCE_S = 30.0


def recorded(running: Running, path: Path) -> list[object]:
    """What the file holds after some frames were sent while it was made."""
    sent = frames(0.4)
    running.sink.send_state(rest())
    running.sink.send_state(cameras())
    with (
        PublishedStream(Link(running.endpoint)) as stream,
        RecordingWriter(path, RecordingParams(), 0) as writer,
        StatusLine() as line,
    ):
        recorder = Recorder(stream, writer, None, PATIENCE_S)

        def send() -> None:
            for number, frame in enumerate(sent, start=1):
                while writer.frames < number:  # the bus may drop some
                    running.sink.send(frame)
                    eventually(partial(has_come, number), 1.0)
            recorder.end()

        def has_come(number: int) -> bool:
            return writer.frames >= number

        running.heard()
        sender = threading.Thread(target=send)
        sender.start()
        recorder.run(line)
        sender.join()
    return list(RecordingReader(path).everything())


def test_frames_rest_skeleton_and_calibration_are_in_the_file(tmp_path: Path) -> None:
    with running_sink() as running:
        found = recorded(running, tmp_path / "a.mcap")
    assert {one.seq for one in found if isinstance(one, SkeletonFrame)} == set(range(24))
    assert [one for one in found if isinstance(one, RestSkeleton)] == [rest()]
    with pytest.raises(InputError, match="no pictures"):  # but it is read that far
        open_recording(tmp_path / "a.mcap")


def test_the_rig_is_attached_as_a_rig_file(tmp_path: Path) -> None:
    with running_sink() as running:
        recorded(running, tmp_path / "a.mcap")
    items = McapFile(tmp_path / "a.mcap").items(lambda _topic, _schema: False)
    known = metadata_of((one for one in items if isinstance(one, McapAttachment)), "here")
    assert known.rig is not None
    assert known.rig.names == ("cam0", "cam1")
    assert known.stature_m == 1.75


def test_nobody_there_is_named(tmp_path: Path) -> None:
    link = Link(f"tcp/127.0.0.1:{free_port()}", connect_timeout_s=0.2)
    with pytest.raises(UnavailableError, match="no mocapd"), PublishedStream(link):
        pass


def test_ctrl_c_ends_it_in_order(tmp_path: Path, clean_env: dict[str, str]) -> None:
    path = tmp_path / "a.mcap"
    with running_sink() as running:
        running.sink.send_state(rest())
        recorder = start(clean_env, "record", path, "--endpoint", running.endpoint)
        try:
            running.heard()
            assert eventually(path.exists)
            sent = iter(frames(300.0, 10.0))

            def is_written() -> bool:
                running.sink.send(next(sent))
                return path.stat().st_size > 1000

            assert eventually(is_written)
            recorder.send_signal(signal.SIGINT)
            _, told = recorder.communicate(timeout=PATIENCE_S)
        finally:
            recorder.kill()
    assert recorder.returncode == 0, told
    assert "a.mcap: 0:00:0" in told
    file = McapFile(path)
    assert list(file.items(lambda _topic, schema: schema.endswith("PackedSkeleton.v1")))
    assert file.ending == ""


def test_a_recording_without_a_frame_is_an_error(tmp_path: Path, clean_env: dict[str, str]) -> None:
    with running_sink() as running:
        words = ("record", tmp_path / "a.mcap", "--seconds", "0.2", "--endpoint", running.endpoint)
        done = mocapd_here(clean_env, *words)
    assert "0 frames" in done.err
    assert "no frame came, so nothing is recorded -- see `mocapd status`" in done.err
    assert done.code == UnavailableError.exit_code


def test_durations() -> None:
    assert duration(3725.9) == "1:02:05"
