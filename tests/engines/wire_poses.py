"""Poses out of the datagrams that went over the wire, by decoders that share nothing with the clients."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from mocapd.types import Floats
from tests.outputs.receivers.godot_xr_vmc_tracker import GodotXrVmcTracker
from tests.outputs.receivers.typed_osc import decoded

FRAME = "/mocapd/v1/frame"
JOINT = "/mocapd/v1/joint/"
NS_PER_S = 1_000_000_000

Pose = dict[str, Floats]  # joints' places [m] by name


def osc_poses(datagrams: Iterable[bytes]) -> dict[int, Pose]:
    """By capture time [Unix ns], of mocapd's own OSC; names as on the wire (VRM 1.0)."""
    poses: dict[int, Pose] = {}
    for datagram in datagrams:
        frame, *joints = decoded(datagram)
        seconds, ns = (int(value.value or 0) for value in frame.values[5:7])
        pose = poses.setdefault(seconds * NS_PER_S + ns, {})
        for joint in joints:
            pose[joint.address.removeprefix(JOINT)] = np.array(
                [value.value for value in joint.values[:3]], dtype=float
            )
    return poses


def vmc_poses(datagrams: Iterable[bytes]) -> list[Pose]:
    """After each datagram, in Godot's tracking space: joints by Unity's names."""
    receiver = GodotXrVmcTracker()
    poses = []
    for datagram in datagrams:
        receiver.receive(datagram)
        if receiver.has_tracking_data:
            poses.append({name: joint.origin_m for name, joint in receiver.tracker().items()})
    return poses


def greatest_error_m(pose: Mapping[str, Sequence[float]], truth: Mapping[str, Floats]) -> float:
    """Of the joints that both know [m]."""
    return max(
        float(np.linalg.norm(np.array(at_m) - truth[name]))
        for name, at_m in pose.items()
        if name in truth
    )
