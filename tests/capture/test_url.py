"""Network cameras: a real HTTP server on this machine sends Motion JPEG."""

import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import cv2
import pytest

from mocapd.capture.url import UrlSource
from mocapd.clock import monotonic_ns
from mocapd.errors import CameraLost, ConfigError, UnavailableError
from tests.capture.films import SIZE_PX, number_of, picture, write_film

FRAMES = 40


def jpeg(index: int) -> bytes:
    return cv2.imencode(".jpg", picture(index))[1].tobytes()


class NetworkCamera(BaseHTTPRequestHandler):
    """Sends FRAMES numbered pictures at about 50 Hz, then hangs up; from /torn every third is cut short, and
    from /codec a film of a codec that cannot be read."""

    film: bytes

    def do_GET(self) -> None:
        self.send_response(200)
        if self.path.startswith("/codec"):
            self.send_header("Content-Length", str(len(self.film)))
            self.end_headers()
            self.wfile.write(self.film)
            return
        self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=frame")
        self.end_headers()
        pause = threading.Event()
        for index in range(FRAMES):
            data = jpeg(index)
            if self.path.startswith("/torn") and index % 3 == 2:
                data = data[: len(data) // 2]
            head = f"--frame\r\nContent-Type: image/jpeg\r\nContent-Length: {len(data)}\r\n\r\n"
            try:
                self.wfile.write(head.encode() + data + b"\r\n")
            except OSError:  # the reader has seen enough
                return
            pause.wait(0.02)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002
        pass


@pytest.fixture
def camera_url() -> Iterator[str]:
    server = ThreadingHTTPServer(("127.0.0.1", 0), NetworkCamera)
    server.daemon_threads = True
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{server.server_address[1]}/video.mjpg"
    server.shutdown()
    server.server_close()
    thread.join()


def test_frames_arrive_in_order_with_the_time_of_arrival(camera_url: str) -> None:
    source = UrlSource("net", camera_url, size_px=SIZE_PX)
    began_ns = monotonic_ns()
    source.open()
    frames = [source.read() for _ in range(5)]
    source.close()
    assert [frame.seq for frame in frames] == list(range(5))
    numbers = [number_of(frame.pixels) for frame in frames]
    assert numbers == sorted(set(numbers))
    times = [began_ns, *(frame.t_ns for frame in frames), monotonic_ns()]
    assert times == sorted(times)
    assert not frames[0].pixels.flags.writeable


def test_motion_jpeg_is_handed_on_as_it_came(camera_url: str) -> None:
    source = UrlSource("net", camera_url)
    source.open()
    frames = [source.read() for _ in range(3)]
    source.close()
    for frame in frames:
        assert frame.encoded == jpeg(number_of(frame.pixels))


def test_damaged_pictures_are_left_out_and_counted(camera_url: str) -> None:
    source = UrlSource("net", camera_url.replace("/video", "/torn"))
    source.open()
    frames = [source.read() for _ in range(8)]
    source.close()
    assert all(number_of(frame.pixels) % 3 != 2 for frame in frames)
    assert source.torn == frames[-1].seq - frames[0].seq + 1 - len(frames) > 0


def test_the_end_of_the_stream_is_a_lost_camera(camera_url: str) -> None:
    source = UrlSource("net", camera_url)
    source.open()
    for _ in range(FRAMES):
        try:
            source.read()
        except CameraLost:
            break  # FFmpeg keeps the last pictures to itself
    with pytest.raises(CameraLost):
        source.read()
    source.close()


def test_a_codec_that_cannot_be_read_is_named(
    camera_url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    film = write_film(tmp_path / "a.avi", 5).read_bytes().replace(b"MJPG", b"VVC1")
    monkeypatch.setattr(NetworkCamera, "film", film, raising=False)
    source = UrlSource("net", camera_url.replace("/video.mjpg", "/codec.avi"))
    source.open()
    with pytest.raises(CameraLost, match=r"sends H\.266 \(VVC\), which cannot be read here"):
        source.read()
    source.close()


def test_another_size_than_the_calibration_names_both(camera_url: str) -> None:
    with pytest.raises(ConfigError, match=r"64x48.*1280x720"):
        UrlSource("net", camera_url, size_px=(1280, 720)).open()


def test_nobody_there_is_unavailable_and_the_password_is_not_told() -> None:
    source = UrlSource("net", "rtsp://me:secret@127.0.0.1:9/live", open_timeout_s=0.5)
    with pytest.raises(UnavailableError, match="does not answer") as caught:
        source.open()
    assert "secret" not in str(caught.value)
    assert "rtsp://me:***@127.0.0.1:9/live" in str(caught.value)
