"""The strict VRChat of the tests: what it refuses, and how it aligns the space it is sent."""

import struct

import numpy as np
import pytest
from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message_builder import OscMessageBuilder

from tests.outputs.receivers.vrchat import RefusedError, VRChatReceiver, unity_rotation


def sent(*elements: tuple[str, tuple[float, ...]], kinds: str = "fff") -> bytes:
    """A bundle by python-osc."""
    bundle = OscBundleBuilder(IMMEDIATELY)
    for address, values in elements:
        message = OscMessageBuilder(f"/tracking/trackers/{address}")
        for value, kind in zip(values, kinds, strict=True):
            message.add_arg(value, kind)
        bundle.add_content(message.build())
    return bytes(bundle.build().dgram)


HIP = ("1/position", (0.5, 1.0, 2.0))


def test_euler_angles_are_applied_z_x_y() -> None:
    # first about z: +x to +y; then about x: +y to +z; then about y: +z to +x
    assert unity_rotation(np.array([90.0, 90.0, 90.0])) @ [1, 0, 0] == pytest.approx([1, 0, 0])
    assert unity_rotation(np.array([0.0, 90.0, 0.0])) @ [0, 0, 1] == pytest.approx([1, 0, 0])
    assert unity_rotation(np.array([90.0, 0.0, 0.0])) @ [0, 0, 1] == pytest.approx([0, -1, 0])


@pytest.mark.parametrize(
    "datagram",
    [
        sent(("1/position", (1, 2, 3)), kinds="iii"),
        sent(("1/position", (1.0, 2.0, 3.0)), kinds="ddd"),
        sent(("1/position", (1.0, 2.0)), kinds="ff"),
        sent(("9/position", (0.0, 0.0, 0.0))),
        sent(("hip/position", (0.0, 0.0, 0.0))),
        sent(("1/turn", (0.0, 0.0, 0.0))),
        sent(("1/position", (float("nan"), 0.0, 0.0))),
        sent(HIP, HIP),
        sent(HIP).replace(b"\0\0\0\0\0\0\0\1", struct.pack(">Q", 1 << 40)),
        sent(HIP)[:-1],
        sent(HIP) + b"\0\0",
        sent(*[(f"{i}/position", (0.0, 0.0, 0.0)) for i in range(1, 9)] * 4),
        b"",
    ],
)
def test_what_it_would_not_read_is_refused(datagram: bytes) -> None:
    with pytest.raises(RefusedError):
        VRChatReceiver().take(datagram, 0.0)


def test_the_head_shifts_the_space_at_once() -> None:
    vrchat = VRChatReceiver(hmd_head_m=(3.0, 1.5, 0.0))
    for at_s, head in ((0.0, (0.0, 1.6, 0.0)), (0.02, (0.5, 1.7, 2.0))):
        bundle = sent(HIP, ("1/rotation", (0.0, 0.0, 0.0)), ("head/position", head))
        vrchat.take(bundle, at_s)
        assert vrchat.aligned(1).position_m == pytest.approx(
            np.array([0.5, 1.0, 2.0]) - head + [3.0, 1.5, 0.0]
        )


def test_the_heads_rotation_snaps_after_silence_and_else_creeps() -> None:
    vrchat = VRChatReceiver(hmd_yaw_deg=90.0)
    vrchat.take(sent(("head/rotation", (20.0, 30.0, 0.0))), 0.0)
    assert vrchat.yaw_deg == pytest.approx(60.0)
    vrchat.take(sent(("head/rotation", (0.0, 50.0, 0.0))), 0.2)
    assert vrchat.yaw_deg == pytest.approx(60.0)
    vrchat.take(sent(HIP), 0.4)
    assert 50.0 < vrchat.yaw_deg < 60.0
    vrchat.take(sent(("head/rotation", (0.0, 80.0, 0.0))), 0.51)
    assert vrchat.yaw_deg == pytest.approx(10.0)
    assert (vrchat.snaps, vrchat.slerps) == (2, 1)
