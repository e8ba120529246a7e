"""A webcam through OpenCV and V4L2, opened by identity and released at the first failure."""

import logging
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import mocapd.capture.environment as environment  # isort: skip  before cv2

import cv2
import numpy as np
from cv2.typing import MatLike

from mocapd.capture.file import size_error
from mocapd.capture.guard import Openings
from mocapd.capture.jpeg_picture import JpegPicture, read_jpeg
from mocapd.capture.pixels import frozen_pixels
from mocapd.capture.webcam.camera_controls import NodeControls
from mocapd.capture.webcam.controls import (
    ControlResult,
    Controls,
    apply_controls,
)
from mocapd.capture.webcam.device_access import check_usable, opened_node
from mocapd.capture.webcam.frame_numbers import FrameNumbers
from mocapd.capture.webcam.identity import WebcamIdentity
from mocapd.capture.webcam.webcams import DEV, SYSFS, find_webcam
from mocapd.clock import NS_PER_S, monotonic_ns
from mocapd.errors import CameraClosed, CameraLost, MalformedError, UnavailableError
from mocapd.types import Bytes, Frame

_LOG = logging.getLogger(__name__)
_OLDEST_STAMP_NS = 5 * NS_PER_S  # a driver's stamp older than this is of another clock
_TORN_LIMIT_NS = 2 * NS_PER_S  # without one whole frame: the cable or the hub is bad
_MJPG = "MJPG"
_YUYV = "YUYV"


class HasProperties(Protocol):
    """The required part of cv2.VideoCapture."""

    def set(self, property_id: int, value: float) -> bool: ...
    def get(self, property_id: int) -> float: ...


@dataclass(frozen=True, slots=True)
class WebcamSettings:
    """Requested mode of a webcam. `size_px` (width, height) is mandatory: the calibration depends on it."""

    size_px: tuple[int, int] = (640, 480)
    fps_hz: float = 30.0
    controls: Controls = field(default_factory=Controls)


@dataclass(frozen=True, slots=True)
class NegotiatedFormat:
    """The actual mode after opening, all of it read back."""

    node: Path
    moved: bool  # found by vid:pid:serial in another socket than configured
    fourcc: str
    size_px: tuple[int, int]
    fps_hz: float


class V4l2Source:
    """One webcam, addressed by its USB identity or (off USB) by its node.

    `others`: identities of the other configured webcams, which are never taken for this one.
    `torn` counts frames that came damaged and were left out; each is a gap in `seq`, as are frames that never came
    (see FrameNumbers).
    """

    recorded = False

    def __init__(
        self,
        name: str,
        where: WebcamIdentity | Path,
        settings: WebcamSettings | None = None,
        others: tuple[WebcamIdentity, ...] = (),
        sysfs: Path = SYSFS,
        dev: Path = DEV,
        reduced_by: int = 1,
    ) -> None:
        """reduced_by: see SourceRequest."""
        self.name = name
        self.torn = 0
        self.negotiated: NegotiatedFormat | None = None
        self._where = where
        self._settings = settings if settings is not None else WebcamSettings()
        self._others = others
        self._sysfs, self._dev, self._reduced_by = sysfs, dev, reduced_by
        self._numbers = FrameNumbers()
        self._openings = Openings()
        self._delivered = False  # since it was opened

    @property
    def settings(self) -> WebcamSettings:
        """See Lockable."""
        return self._settings

    def device(self) -> NodeControls | None:
        """See Lockable."""
        negotiated = self.negotiated
        if negotiated is None or self._openings.current is None:
            return None
        return NodeControls(negotiated.node)

    def change(self, settings: WebcamSettings) -> None:
        """See Lockable. From any thread."""
        before, self._settings = self._settings, settings
        if _other_mode(before, settings):
            self.close()

    def open(self) -> None:
        """Find the webcam, open it and set it up.

        Raises UnavailableError (absent, busy, metadata node), PermissionDeniedError, or ConfigError
        when it does not deliver the size of its calibration.
        """
        number = self._openings.begin()
        node, moved = self._resolve()
        with opened_node(node) as fd:  # OpenCV only says "no": ask for the reason first
            check_usable(node, fd)
        with ExitStack() as undo:
            capture = cv2.VideoCapture(str(node), cv2.CAP_V4L2)
            undo.callback(capture.release)
            if not capture.isOpened():
                raise UnavailableError("OpenCV cannot open it", str(node), "see `mocapd cameras`")
            settings = self._settings
            negotiated = negotiate(capture, settings, self.name, node, moved)
            controls = apply_controls(NodeControls(node), settings.controls)
            undo.pop_all()
        if not self._openings.take(
            number, capture
        ):  # another mode may have been asked for meanwhile
            raise CameraClosed(
                "was closed while it was opened", self.name, "it is opened again by itself"
            )
        self.negotiated = negotiated
        self._delivered = False
        self._numbers.restart()
        self._warn(negotiated, controls)

    def read(self) -> Frame:
        """The next whole frame; damaged ones are counted and skipped.

        Raises CameraLost when the webcam was unplugged, stalls, or sends only damage; it is let go
        of by then, so that the same node can come back.
        """
        guarded, negotiated = self._openings.current, self.negotiated
        if guarded is None or negotiated is None:
            raise CameraClosed("is closed", self.name, "it is opened again by itself")
        began_ns = monotonic_ns()
        while True:
            with guarded as capture:
                if guarded.closing or not capture.grab():
                    break
                grabbed_ns = monotonic_ns()
                stamp_ns = _stamp_ns(capture.get(cv2.CAP_PROP_POS_MSEC), grabbed_ns)
                good, raw = capture.retrieve()  # gives the buffer back
            seq = self._numbers.number(stamp_ns, monotonic_ns())
            fourcc = negotiated.fourcc
            picture = decode(raw, fourcc, negotiated.size_px, self._reduced_by) if good else None
            if picture is not None:
                self._delivered = True
                t_ns = grabbed_ns if stamp_ns is None else stamp_ns
                return Frame(self.name, seq, t_ns, picture)
            self.torn += 1
            if grabbed_ns - began_ns > _TORN_LIMIT_NS:
                guarded.close()
                raise CameraLost(
                    "only damaged frames arrive", str(negotiated.node), "check cable and hub"
                )
        closed = guarded.closing
        guarded.close()  # and no later one
        waited_s = (monotonic_ns() - began_ns) / NS_PER_S
        where = f"{self.name} ({self._where})"
        if closed:
            raise CameraClosed("was closed", where, "it is opened again by itself")
        if waited_s > 0.5:
            raise CameraLost(f"sent nothing for {waited_s:.1f} s", where, "unplug and replug it")
        if not self._delivered and negotiated.node.exists():  # ENOSPC, which OpenCV swallows
            raise CameraLost(
                "cannot start: its USB bus has no room left, or another program was faster",
                where,
                "plug it into a port of another USB controller, or ask for a smaller size or rate",
            )
        raise CameraLost("was unplugged", where, "plug it in again")

    def close(self) -> None:
        """Closes the webcam; a blocked `read` ends after the stall timeout of `environment` at the latest."""
        self._openings.close()

    def plugging(self) -> str:
        """See Pluggable: the node and its inode, which is another one after each plugging in."""
        try:
            node, _ = self._resolve()
            return f"{node} {node.stat().st_ino}"
        except (UnavailableError, OSError):
            return ""

    @property
    def identity(self) -> WebcamIdentity | None:
        """See Pluggable."""
        return self._where if isinstance(self._where, WebcamIdentity) else None

    @property
    def place(self) -> str:
        """See Pluggable."""
        negotiated = self.negotiated
        moved = negotiated is not None and negotiated.moved
        return (
            f"in another USB port than configured ({negotiated.node})"
            if negotiated and moved
            else ""
        )

    def _resolve(self) -> tuple[Path, bool]:
        if isinstance(self._where, Path):
            return self._where, False
        match, node = find_webcam(self._where, self._others, self._sysfs, self._dev)
        return node, match.moved

    def _warn(self, got: NegotiatedFormat, controls: tuple[ControlResult, ...]) -> None:
        if environment.CV2_CAME_FIRST:
            _LOG.warning("%s: cv2 was imported before mocapd: a stall takes 10 s to see", self.name)
        if got.moved:
            _LOG.warning("%s: found in another USB port than configured (%s)", self.name, got.node)
        if got.fourcc != _MJPG:
            _LOG.warning("%s: has no MJPG, uses %s: expect low rates", self.name, got.fourcc)
        if abs(got.fps_hz - self._settings.fps_hz) > 0.5:
            _LOG.warning(
                "%s: asked for %g Hz, was given %g Hz", self.name, self._settings.fps_hz, got.fps_hz
            )
        for c in controls:
            if not c.is_applied:
                now = "absent or silent" if c.got is None else c.got
                _LOG.warning("%s: %s is %s, asked for %d", self.name, c.control, now, c.asked)


def _other_mode(one: WebcamSettings, other: WebcamSettings) -> bool:
    return (one.size_px, one.fps_hz) != (other.size_px, other.fps_hz)


def negotiate(
    capture: HasProperties, asked: WebcamSettings, name: str, node: Path, moved: bool
) -> NegotiatedFormat:
    """Set format, size and rate, and read them back; one buffer.

    Raises UnavailableError (unplugged meanwhile, no usable format) or ConfigError (another size).
    """
    # In this order: the format decides which sizes there are, the size which rates. Left alone
    # OpenCV takes YUYV, which fills the bus at a third of the rate.
    capture.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*_MJPG))
    capture.set(cv2.CAP_PROP_FRAME_WIDTH, asked.size_px[0])
    capture.set(cv2.CAP_PROP_FRAME_HEIGHT, asked.size_px[1])
    capture.set(cv2.CAP_PROP_FPS, asked.fps_hz)
    capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)  # of 4, four would be stale after a pause
    capture.set(cv2.CAP_PROP_CONVERT_RGB, 0)  # we decode: OpenCV hides torn frames
    code, width, height = (
        int(capture.get(number))
        for number in (cv2.CAP_PROP_FOURCC, cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT)
    )
    if min(code, width, height) < 0:  # what a dead handle says of everything
        raise UnavailableError("was unplugged while it was opened", str(node), "plug it in again")
    if (width, height) != asked.size_px:
        raise size_error(str(node), name, (width, height), asked.size_px)
    fourcc = code.to_bytes(4, "little").decode("latin-1")
    if fourcc not in (_MJPG, _YUYV):
        raise UnavailableError(
            f"delivers {fourcc!r}, neither MJPG nor YUYV", str(node), "use another camera"
        )
    return NegotiatedFormat(
        node=node,
        moved=moved,
        fourcc=fourcc,
        size_px=(width, height),
        fps_hz=capture.get(cv2.CAP_PROP_FPS),
    )


def decode(
    raw: MatLike, fourcc: str, size_px: tuple[int, int], reduced_by: int = 1
) -> Bytes | JpegPicture | None:
    """A buffer of the driver as the picture of a `Frame`; None when it is torn.

    MJPG: a JPEG file, of which a cut one is refused here, not half decoded, and one of another size
    before it takes memory. YUYV: two bytes a pixel.
    """
    width, height = size_px
    if fourcc == _YUYV:
        if raw.size != width * height * 2:
            return None
        return frozen_pixels(cv2.cvtColor(raw.reshape(height, width, 2), cv2.COLOR_YUV2BGR_YUY2))
    try:
        picture = read_jpeg(np.asarray(raw, dtype=np.uint8), size_px, reduced_by)
    except MalformedError:
        return None
    # one that says it was taken upright is turned by the decoder
    decoded_px = picture.size_px if isinstance(picture, JpegPicture) else picture.shape[1::-1]
    return picture if decoded_px == size_px else None


def _stamp_ns(driver_ms: float, grabbed_ns: int) -> int | None:
    """The driver's time of capture, if it is of CLOCK_MONOTONIC and not absurd."""
    t_ns = round(driver_ms * 1e6)
    return t_ns if 0 <= grabbed_ns - t_ns < _OLDEST_STAMP_NS else None
