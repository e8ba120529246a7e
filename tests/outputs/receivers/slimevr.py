"""SlimeVR's input of VMC: casts `as Float`, which throws for anything else.

Re-implements SlimeVR/SlimeVR-Server `osc/VMCHandler.kt` (handleReceivedMessage: names in any
case, `arguments[k] as Float`, z and w turned round) for what it takes, and `vmc/input-decoder.kt`
(vmcWorldTransforms) for the pose: locals chained from Hips, all of it turned and moved by
Root/Pos. JavaOSC's listening thread does not survive what a listener throws.

Of the releases with VMCHandler.kt only the rotations are used, in an armature
(`osc/UnityArmature.kt`) that turns lower arms about the axes of arms that hang down and takes the
upper chest's rotation twice; no sender can mend that, and it is not repeated here.
"""

from tests.outputs.receivers.humanoid import (
    ORIGIN,
    PARENT_OF,
    Transform,
    Vector,
    chained,
    combined,
)
from tests.outputs.receivers.typed_osc import TypedValue, decoded

_BONES = {bone.lower(): bone for bone in PARENT_OF}
# Without a place in SlimeVR's skeleton: told to nobody
_PASSED_OVER = {"LeftToes", "RightToes", "LeftEye", "RightEye", "Jaw"}


class SlimevrInput:
    """`receive` takes a datagram."""

    def __init__(self) -> None:
        self._bones: dict[str, Transform] = {}
        self._root: Transform = ORIGIN
        self.is_dead = False

    def receive(self, datagram: bytes) -> None:
        """One datagram; dead after the first message that throws."""
        for message in decoded(datagram):
            if self.is_dead:
                return
            try:
                self._take(message.address, message.values)
            except (TypeError, IndexError):  # ClassCastException, IndexOutOfBoundsException
                self.is_dead = True

    def joints_m(self) -> dict[str, Vector]:
        """Its joints in mocapd's world, without those that it passes over. In SlimeVR a person faces -Z."""
        locals_ = {bone: self._bones.get(bone, ORIGIN) for bone in PARENT_OF}
        world = {bone: combined(self._root, local) for bone, local in chained(locals_).items()}
        return {
            bone: (-x, y, -z) for bone, ((x, y, z), _) in world.items() if bone not in _PASSED_OVER
        }

    def _take(self, address: str, values: tuple[TypedValue, ...]) -> None:
        if address == "/VMC/Ext/Root/Pos":
            self._root = _transform(values)
        elif address == "/VMC/Ext/Bone/Pos":
            bone = _BONES.get(str(values[0].value).lower())
            if bone is not None and bone not in _PASSED_OVER:
                self._bones[bone] = _transform(values)


def _transform(values: tuple[TypedValue, ...]) -> Transform:
    px, py, pz, qx, qy, qz, qw = (_as_float(values[k]) for k in range(1, 8))
    return (px, py, -pz), (qx, qy, -qz, -qw)


def _as_float(one: TypedValue) -> float:
    if one.tag != "f" or not isinstance(one.value, float):
        raise TypeError(f"{one.tag} cannot be cast to Float")
    return one.value
