"""Every strict receiver, fed datagrams, and where it puts the joints."""

from collections.abc import Iterable, Mapping

import numpy as np

from mocapd.outputs.vmc.bone_names import unity_name
from mocapd.types import Floats
from tests.outputs.receivers.evmc4u import Evmc4u
from tests.outputs.receivers.godot_xr_vmc_tracker import GodotXrVmcTracker
from tests.outputs.receivers.slimevr import SlimevrInput
from tests.outputs.receivers.vmc4ue import Vmc4ue

Receiver = Evmc4u | GodotXrVmcTracker | Vmc4ue | SlimevrInput
KINDS: tuple[type[Receiver], ...] = (Evmc4u, GodotXrVmcTracker, Vmc4ue, SlimevrInput)
READS_ROOT: tuple[type[Receiver], ...] = (Evmc4u, Vmc4ue, SlimevrInput)


def posed(receiver: Receiver, datagrams: Iterable[bytes | bytearray]) -> dict[str, Floats]:
    """Joints by Unity's name in mocapd's world [m]; the receiver must have survived."""
    for datagram in datagrams:
        receiver.receive(bytes(datagram))
    if isinstance(receiver, Evmc4u):
        receiver.update()
    if not isinstance(receiver, GodotXrVmcTracker):
        assert not receiver.is_dead
    return {bone: np.array(at_m) for bone, at_m in receiver.joints_m().items()}


def greatest_error_m(joints: Mapping[str, Floats], expected: Mapping[str, Floats]) -> float:
    """Of all expected joints, by VRM 1.0 name, that the receiver has."""
    errors = [
        float(np.linalg.norm(joints[unity_name(name)] - at_m))
        for name, at_m in expected.items()
        if unity_name(name) in joints
    ]
    assert len(errors) >= 20  # SlimeVR has no toes
    return max(errors)
