"""Checks by its first bytes that a file is a video container, before FFmpeg opens it.

FFmpeg guesses formats by content, and some formats are texts that name other files and addresses: a list
`x.mp4` of concatenated films reads whatever it names, and waits for a pipe without end.
"""

from pathlib import Path

from mocapd.boundary.files import read_beginning
from mocapd.errors import InputError

_HEAD_BYTES = 1024
# ISO base media and QuickTime: the kind of the first box, behind its length
_BOXES = (
    *(b"ftyp", b"styp", b"moov", b"moof", b"mdat", b"sidx"),
    *(b"free", b"skip", b"wide", b"pnot", b"uuid"),
)
_MAGIC = (
    b"\x1a\x45\xdf\xa3",  # EBML: Matroska, WebM
    b"YUV4MPEG2 ",
    b"FLV\x01",
    b"OggS\0",
    b"\x30\x26\xb2\x75\x8e\x66\xcf\x11",  # ASF: WMV
    b"\x06\x0e\x2b\x34",  # MXF
    b"DKIF",  # IVF
    b"\x1f\x07\0",  # DV
    b"nut/multimedia container\0",
    b".RMF\0",
    b"GIF8",
    b"\0\0\x01",  # MPEG program streams, and elementary streams of MPEG, H.264, H.265
    b"\0\0\0\x01",
    b"\x12\0\x0a",  # AV1
)
_RIFF = (b"AVI ", b"AVIX", b"AMV ")
_JPEG = b"\xff\xd8\xff"  # one JPEG after another
_SYNC, _PACKETS_BYTES = (
    0x47,
    (188, 192, 204),
)  # MPEG transport streams, perhaps begun within a packet
_FIX = "give a video that a camera or a recorder wrote (MP4, MOV, MKV, WebM, AVI, TS), or convert it with ffmpeg"


def require_video(path: Path) -> None:
    """Raises InputError for a file that is no video container or cannot be read."""
    head = read_beginning(path, _HEAD_BYTES)
    if not head:
        raise InputError("the video is empty", str(path), "record it again")
    # behind a pattern such as %d FFmpeg looks for numbered pictures of other names
    is_jpegs = head.startswith(_JPEG) and "%" not in path.name
    if not (is_jpegs or _is_container(head)):
        raise InputError(
            "not a video, or damaged: its first bytes are of no format of video", str(path), _FIX
        )


def _is_container(head: bytes) -> bool:
    if head.startswith(_MAGIC) or head[4:8] in _BOXES:
        return True
    if head.startswith(b"RIFF"):
        return head[8:12] in _RIFF
    return any(_is_transport_stream(head, length) for length in _PACKETS_BYTES)


def _is_transport_stream(head: bytes, length: int) -> bool:
    """True if four consecutive packets of this length begin within the first packet's length."""
    last = 3 * length
    return any(
        all(at + k < len(head) and head[at + k] == _SYNC for k in range(0, last + 1, length))
        for at in range(length)
    )
