"""Identifies the codec of a video, and how to convert one that cannot be decoded here.

OpenCV's wheels decode by the FFmpeg that they carry, which has no decoder for AV1 but those of graphics cards. An
unsupported codec yields a stream without frames, as damage does; its code distinguishes the two.
"""

import shlex
from pathlib import Path

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2

# Codes of codecs that OpenCV's FFmpeg knows by name, and does not decode, or not everywhere.
_NOT_DECODED = {
    "av01": "AV1",
    "vvc1": "H.266 (VVC)",
    "vvi1": "H.266 (VVC)",
    "evc1": "EVC",
    "apv1": "APV",
}
# Of those that cameras and recorders usually write: with them it is the file that is damaged.
_DECODED = {
    *("h264", "avc1", "avc3", "h263", "s263", "hevc", "hvc1", "hev1", "mp4v", "fmp4", "xvid"),
    *("divx", "dx50", "mpg1", "mpg2", "mpeg", "vp80", "vp90", "vp08", "vp09", "mjpg", "jpeg"),
    *("theo", "wmv1", "wmv2", "wmv3", "wvc1", "flv1", "apch", "apcn", "apcs", "apco", "ap4h"),
    *("ffv1", "hfyu", "ffvh", "mjp2", "avdn", "avdh", "cfhd", "rle", "png", "gif", "cvid", "dvsd"),
}


def undecodable_codec(capture: cv2.VideoCapture) -> str:
    """The name of the codec of an open stream that yields no frame, where the codec may be why; else ""."""
    code = int(capture.get(cv2.CAP_PROP_FOURCC)) & 0xFFFFFFFF
    text = code.to_bytes(4, "little").decode("latin-1").strip(" \0")
    if text.lower() in _NOT_DECODED:
        return _NOT_DECODED[text.lower()]
    if not text or not text.isprintable() or not text.isascii() or text.lower() in _DECODED:
        return ""
    return f"the codec {text!r}"


def conversion(path: Path) -> str:
    """Advice for converting an unsupported video, with the times of its frames."""
    made = shlex.quote(f"{path.stem}-h264.mp4")
    return (
        "convert it to H.264 and put that in its place: "
        f"ffmpeg -i {shlex.quote(path.name)} -c:v libx264 -crf 18 -fps_mode passthrough {made}"
    )
