"""Only containers of video reach FFmpeg, whatever a file is called."""

import os
from pathlib import Path

import cv2
import pytest

from mocapd.capture.file import probe_video
from mocapd.capture.video_container import require_video
from mocapd.errors import InputError
from tests.capture.films import SIZE_PX, picture

# name and codec of what this OpenCV writes: of recorders, cameras and OBS
WRITTEN = (
    ("a.mp4", "mp4v"),
    ("a.mov", "mp4v"),
    ("a.mkv", "mp4v"),
    ("a.avi", "MJPG"),
    ("a.webm", "VP80"),
    ("a.ts", "mpg2"),
    ("a.m2ts", "mpg2"),
    ("a.mpg", "mpg1"),
    ("a.m2v", "mpg2"),
    ("a.flv", "FLV1"),
    ("a.wmv", "WMV2"),
    ("a.mjpeg", "MJPG"),
    ("a.y4m", "I420"),
)
BEGINNINGS = {
    "h264": b"\0\0\0\x01\x67\x64\0\x1f",
    "h265": b"\0\0\0\x01\x40\x01\x0c\x01",
    "ogg": b"OggS\0\x02" + bytes(20),
    "fragmented mp4": b"\0\0\0\x18styp" + b"msdh",
    "mdat first": b"\0\0\0\x01mdat" + bytes(8),
    "within a packet": b"x" * 100 + (b"\x47" + b"y" * 187) * 4,
    "dv": b"\x1f\x07\0\x3f",
}
TEXTS = {
    "concat": b"ffconcat version 1.0\nfile other.mp4\n",
    "hls": b"#EXTM3U\n#EXT-X-TARGETDURATION:9\n#EXTINF:9,\nother.ts\n",
    "dash": b'<?xml version="1.0"?><MPD xmlns="urn:mpeg:dash:schema:mpd:2011"></MPD>',
    "sdp": b"v=0\nc=IN IP4 127.0.0.1\nm=video 5004 RTP/AVP 96\n",
    "asf list": b"[Reference]\nRef1=http://127.0.0.1/\n",
    "multipart": b"--boundary\r\nContent-Type: image/jpeg\r\n\r\n",
    "letters": b"G" + b"g" * 187 + b"G is a letter",
    "wave": b"RIFF\0\0\0\0WAVEfmt ",
    "png": b"\x89PNG\r\n\x1a\n" + bytes(20),
    "zeros": bytes(1000),
}


@pytest.mark.parametrize(("name", "codec"), WRITTEN)
def test_a_video_is_taken(tmp_path: Path, name: str, codec: str) -> None:
    path = tmp_path / name
    writer = cv2.VideoWriter(
        str(path), cv2.CAP_FFMPEG, cv2.VideoWriter.fourcc(*codec), 25.0, SIZE_PX
    )
    if not writer.isOpened():
        pytest.skip("this OpenCV does not write it")
    for index in range(10):
        writer.write(picture(index))
    writer.release()
    assert probe_video(path).size_px == SIZE_PX


@pytest.mark.parametrize("head", BEGINNINGS.values(), ids=BEGINNINGS)
def test_streams_of_cameras_are_taken(tmp_path: Path, head: bytes) -> None:
    (tmp_path / "a").write_bytes(head)
    require_video(tmp_path / "a")


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
@pytest.mark.parametrize("name", ["a.mp4", "a.ts", "a.m3u8"])
def test_what_is_no_video_is_refused_before_it_is_opened(
    tmp_path: Path, text: bytes, name: str
) -> None:
    (tmp_path / name).write_bytes(text)
    with pytest.raises(InputError, match="not a video"):
        probe_video(tmp_path / name)


def test_a_list_that_names_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    path = tmp_path / "x.mp4"
    path.write_text("ffconcat version 1.0\nfile pipe\n")
    with pytest.raises(InputError, match="not a video"):
        probe_video(path)


def test_the_name_of_a_file_is_no_protocol(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    writer = cv2.VideoWriter("b.avi", cv2.VideoWriter.fourcc(*"MJPG"), 25.0, SIZE_PX)
    for index in range(3):
        writer.write(picture(index))
    writer.release()
    Path("b.avi").rename("concat:c.avi")
    assert probe_video(Path("concat:c.avi")).frames == 3


def test_numbered_pictures_are_no_video(tmp_path: Path) -> None:
    (tmp_path / "a%d.jpg").write_bytes(bytes(cv2.imencode(".jpg", picture(1))[1]))
    with pytest.raises(InputError, match="not a video"):
        probe_video(tmp_path / "a%d.jpg")
