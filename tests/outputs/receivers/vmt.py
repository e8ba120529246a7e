"""The driver VMT as a receiver, re-implemented from its source; stricter than the real one.

Sources: gpsnmeajp/VirtualMotionTracker, vmt_driver/{CommunicationManager,TrackedDeviceServerDriver,Config}.cpp, and
oscpack, which it reads OSC with: `>>` throws at another type, and at more or fewer arguments than are read. Written without
mocapd's code, in plain matrices. SteamVR is right-handed, +y up, who looks forward looks along -z.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tests.outputs.receivers.typed_osc import TypedMessage, decoded

Floats = NDArray[np.float64]

PORT = 39570
DEVICES = 58  # VMT_0 to VMT_57
MOST_BYTES = 1472
_UNITY = np.diag([1.0, 1.0, -1.0])  # what an address that ends so negates


class VmtRefusedError(AssertionError):
    """What VMT would not read, or not as it was meant."""


@dataclass
class VmtDevice:
    """As SteamVR sees it: position_m (3,) [m], rotation (3,3) in the room."""

    is_registered: bool = False
    is_connected: bool = False
    position_m: Floats = field(default_factory=lambda: np.zeros(3))
    rotation: Floats = field(default_factory=lambda: np.eye(3))


class VmtReceiver:
    """Takes datagrams. hmd_m: where the headset is in the room; has_room_matrix: set by VMT's manager beforehand."""

    def __init__(
        self, hmd_m: tuple[float, float, float] = (0.0, 1.6, 0.0), has_room_matrix: bool = True
    ) -> None:
        self.hmd_m, self._has_room_matrix = np.array(hmd_m), has_room_matrix
        self.devices = [VmtDevice() for _ in range(DEVICES)]

    def take(self, datagram: bytes | bytearray) -> list[TypedMessage]:
        """Read one datagram; the messages in it. Raises VmtRefusedError."""
        if len(datagram) > MOST_BYTES:
            raise VmtRefusedError(f"{len(datagram)} bytes are fragmented")
        messages = decoded(bytes(datagram))
        for message in messages:
            self._take(message)
        return messages

    @property
    def on(self) -> list[int]:
        """Numbers of the trackers that SteamVR shows as tracked."""
        return [number for number, one in enumerate(self.devices) if one.is_connected]

    def _take(self, message: TypedMessage) -> None:
        _, space, axes = message.address.removeprefix("/").split("/")
        if space not in ("Room", "Follow") or axes not in ("Unity", "Driver"):
            raise VmtRefusedError(f"nothing reads {message.address}")
        tags = "".join(value.tag for value in message.values)
        if tags != "ii" + "f" * 8 + ("s" if space == "Follow" else ""):
            raise VmtRefusedError(f"{message.address} with {tags}")
        index, enable, offset_s, *numbers = (value.value for value in message.values)
        if not (isinstance(index, int) and 0 <= index < DEVICES):
            raise VmtRefusedError(f"no tracker has the index {index!r}")
        if space == "Follow" and numbers.pop() != "HMD":
            raise VmtRefusedError("no such device")
        if enable not in (0, 1) or offset_s != 0.0:
            raise VmtRefusedError(f"enable {enable!r}, time offset {offset_s!r}")
        values = np.array(numbers, dtype=float)
        if abs(np.linalg.norm(values[3:]) - 1.0) > 1e-5:
            raise VmtRefusedError("no rotation")
        mirror = _UNITY if axes == "Unity" else np.eye(3)
        origin_m = self.hmd_m if space == "Follow" else np.zeros(3)
        device = self.devices[index]
        device.is_registered |= enable == 1
        device.is_connected = enable == 1 and device.is_registered and self._has_room_matrix
        device.position_m = origin_m + mirror @ values[:3]
        device.rotation = mirror @ _matrix(values[3:]) @ mirror


def _matrix(xyzw: Floats) -> Floats:
    x, y, z, w = xyzw
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
