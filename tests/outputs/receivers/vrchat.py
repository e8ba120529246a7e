"""VRChat as a receiver of OSC trackers, re-implemented from what is documented; stricter than the real one.

Sources: docs.vrchat.com/docs/osc-trackers, docs.vrchat.com/docs/osc-overview, and how SlimeVR
(`VRCOSCHandler.kt`), which receives the same messages, aligns them. Written without mocapd's code, in plain
matrices: Unity is left-handed, +y up, +z forward, +x right; a person's left is -x.
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

MOST_BYTES = 1472  # of a datagram that is not fragmented
TRACKERS = "/tracking/trackers/"
NAMES = (*map(str, range(1, 9)), "head")
SNAPS_AFTER_S = 0.3  # of silence on the head's rotation [s]
SLERP_PER_S = 0.5  # as SlimeVR guesses it from watching VRChat
# mocapd's world and Unity's: a person at rest looks along +z in both, and left is +x in the one, -x in the other
MIRROR = np.diag([-1.0, 1.0, 1.0])


class RefusedError(AssertionError):
    """What VRChat would not read, or not as it was meant."""


@dataclass(frozen=True)
class TrackerPose:
    """position_m (3,) [m] and rotation (3,3)."""

    position_m: Floats
    rotation: Floats


class VRChatReceiver:
    """Takes datagrams; `hmd_head_m`, `hmd_yaw_deg`: where the wearer's head is by the headset, in Unity's axes."""

    def __init__(
        self, hmd_head_m: tuple[float, float, float] = (0.0, 1.6, 0.0), hmd_yaw_deg: float = 0.0
    ) -> None:
        self.hmd_head_m, self.hmd_yaw_deg = np.array(hmd_head_m), hmd_yaw_deg
        self.positions: dict[str, Floats] = {}
        self.degrees: dict[str, Floats] = {}
        self.yaw_deg = 0.0  # of the tracking space, in VRChat's
        self._goal_deg = 0.0
        self._turned_s = -np.inf
        self._now_s = -np.inf
        self.snaps = 0
        self.slerps = 0

    def take(self, datagram: bytes | bytearray, at_s: float) -> list[str]:
        """Read one datagram that came at a time [s]; the addresses in it. Raises RefusedError."""
        if len(datagram) > MOST_BYTES:
            raise RefusedError(f"{len(datagram)} bytes are fragmented")
        self._advance(at_s)
        seen = []
        for address, floats in messages(bytes(datagram)):
            name, _, kind = address.removeprefix(TRACKERS).partition("/")
            if not address.startswith(TRACKERS) or name not in NAMES:
                raise RefusedError(f"nothing listens at {address}")
            if kind == "position":
                self.positions[name] = np.array(floats)
            elif kind == "rotation":
                self.degrees[name] = np.array(floats)
                if name == "head":
                    self._align(at_s)
            else:
                raise RefusedError(f"nothing listens at {address}")
            seen.append(address)
        if len(set(seen)) != len(seen):
            raise RefusedError("one address twice in a bundle")
        return seen

    def _align(self, at_s: float) -> None:
        """The space turns so that the head that was sent looks where the headset does."""
        self._goal_deg = self.hmd_yaw_deg - _yaw_deg(unity_rotation(self.degrees["head"]))
        if at_s - self._turned_s > SNAPS_AFTER_S:
            self.yaw_deg = self._goal_deg
            self.snaps += 1
        else:
            self.slerps += 1
        self._turned_s = at_s

    def _advance(self, at_s: float) -> None:
        if np.isfinite(self._now_s):
            part = min(1.0, SLERP_PER_S * (at_s - self._now_s))
            self.yaw_deg += part * _wrapped(self._goal_deg - self.yaw_deg)
        self._now_s = at_s

    def tracker(self, index: int) -> TrackerPose:
        """As sent, in Unity's axes."""
        name = str(index)
        return TrackerPose(self.positions[name], unity_rotation(self.degrees[name]))

    def aligned(self, index: int) -> TrackerPose:
        """In VRChat's own space, where the avatar stands."""
        sent, turn = self.tracker(index), unity_rotation(np.array([0.0, self.yaw_deg, 0.0]))
        position_m = sent.position_m
        if "head" in self.positions:
            position_m = turn @ (position_m - self.positions["head"]) + self.hmd_head_m
        else:
            position_m = turn @ position_m
        return TrackerPose(position_m, turn @ sent.rotation)

    def in_world(self, index: int) -> TrackerPose:
        """As sent, in mocapd's world."""
        sent = self.tracker(index)
        return TrackerPose(MIRROR @ sent.position_m, MIRROR @ sent.rotation @ MIRROR)


def unity_rotation(degrees: Floats) -> Floats:
    """(3,3) of Unity's Euler angles x y z [deg]: first about z, then x, then y."""
    x, y, z = np.radians(degrees)
    about_x = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
    about_y = np.array([[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]])
    about_z = np.array([[np.cos(z), -np.sin(z), 0], [np.sin(z), np.cos(z), 0], [0, 0, 1]])
    out: Floats = about_y @ about_x @ about_z
    return out


def _yaw_deg(rotation: Floats) -> float:
    """Which way +z looks after it, seen from above [deg]; positive to the right, Unity's +x."""
    x, _, z = rotation @ np.array([0.0, 0.0, 1.0])
    return float(np.degrees(np.arctan2(x, z)))


def _wrapped(degrees: float) -> float:
    return float((degrees + 180.0) % 360.0 - 180.0)


def messages(packet: bytes) -> Iterator[tuple[str, tuple[float, ...]]]:
    """Address and three floats of each message of a bundle, or of one that stands alone. Raises RefusedError."""
    if not packet.startswith(b"#bundle\0"):
        yield _message(packet)
        return
    if packet[8:16] != b"\0\0\0\0\0\0\0\1":
        raise RefusedError("the time tag is not `immediately`: VRChat may hold the bundle back")
    at = 16
    while at < len(packet):
        if at + 4 > len(packet):
            raise RefusedError("bytes are left over")
        (size,) = struct.unpack_from(">i", packet, at)
        if size <= 0 or size % 4 or at + 4 + size > len(packet):
            raise RefusedError(f"an element of {size} bytes")
        yield _message(packet[at + 4 : at + 4 + size])
        at += 4 + size


def _message(element: bytes) -> tuple[str, tuple[float, ...]]:
    address, at = _string(element, 0)
    tags, at = _string(element, at)
    if tags != ",fff":
        raise RefusedError(f"{address} has {tags}, not three floats")
    if len(element) != at + 12:
        raise RefusedError(f"{address} has {len(element) - at} bytes of arguments")
    floats = struct.unpack_from(">3f", element, at)
    if not np.isfinite(floats).all():
        raise RefusedError(f"{address} has {floats}")
    return address, floats


def _string(element: bytes, at: int) -> tuple[str, int]:
    """A padded string and where it ends."""
    end = element.find(b"\0", at)
    if end < 0:
        raise RefusedError("a string without an end")
    padded = end + 4 - (end - at) % 4
    if element[end:padded].strip(b"\0") or padded > len(element):
        raise RefusedError("a string that is not padded with zeros")
    return element[at:end].decode("ascii"), padded
