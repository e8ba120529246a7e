"""VMC4UE, the VMC plug-in of Unreal Engine: reads without looking at types.

Re-implements HAL9HARUKU/VMC4UE `VMC4UEBlueprintFunctionLibrary.cpp` (OnReceivedVMC) and
`AnimNode_ModifyVMC4UEBones.cpp`: each argument is an element with a FloatValue and a StringValue
of which the decoder sets one, so that an int or a double reads as 0; a Bone/Pos of fewer than 8
arguments is passed over; a Root/Pos of 7 is let through and then read beyond its end, which ends
the engine. Positions are taken as sent, times 100, in Unreal's axes (-x, z, y). Bones are chained
from the root bone, above which is Root/Pos.
"""

from collections.abc import Mapping

from tests.outputs.receivers.humanoid import ORIGIN, PARENT_OF, Transform, Vector, chained
from tests.outputs.receivers.typed_osc import TypedValue, decoded

_CM_PER_M = 100.0


class Vmc4ue:
    """skeleton: the mesh's bones with their reference transforms [cm]; by default all, at zero."""

    def __init__(self, skeleton: Mapping[str, Transform] | None = None) -> None:
        self._skeleton = dict(skeleton or dict.fromkeys(PARENT_OF, ORIGIN))
        self._streamed: dict[str, Transform] = {}
        self._root: Transform = ORIGIN
        self.is_dead = False

    def receive(self, datagram: bytes) -> None:
        """One datagram."""
        for message in decoded(datagram):
            if not self.is_dead:
                self._take(message.address, message.values)

    def joints_m(self) -> dict[str, Vector]:
        """Where the mesh's bones are, in mocapd's world: a mesh faces +Y in Unreal, its left is +X."""
        locals_ = {bone: self._streamed.get(bone, rest) for bone, rest in self._skeleton.items()}
        bones = [bone for bone in PARENT_OF if bone in locals_]
        world = chained(locals_, self._root, bones)
        return {
            bone: (x / _CM_PER_M, z / _CM_PER_M, y / _CM_PER_M)
            for bone, ((x, y, z), _) in world.items()
        }

    def _take(self, address: str, values: tuple[TypedValue, ...]) -> None:
        if address == "/VMC/Ext/Root/Pos" and len(values) >= 7:
            self.is_dead = len(values) == 7  # Data[7]: TArray's range check
            if not self.is_dead:
                self._root = _transform(values)
        elif address == "/VMC/Ext/Bone/Pos" and len(values) >= 8:
            name = values[0].value if values[0].tag == "s" else ""
            self._streamed[str(name)] = _transform(values)


def _transform(values: tuple[TypedValue, ...]) -> Transform:
    px, py, pz, qx, qy, qz, qw = (_float_value(one) for one in values[1:8])
    return (-px * _CM_PER_M, pz * _CM_PER_M, py * _CM_PER_M), (-qx, qz, qy, qw)


def _float_value(one: TypedValue) -> float:
    """FUEOSCElement.FloatValue: 0 unless the element is a float."""
    return one.value if one.tag == "f" and isinstance(one.value, float) else 0.0
