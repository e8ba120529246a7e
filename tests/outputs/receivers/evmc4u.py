"""EVMC4U, the Unity receiver of VMC: strict about types, and dead after one message that is too short.

Re-implements gpsnmeajp/EasyVirtualMotionCaptureForUnity `EVMC4U/ExternalReceiver.cs` on uOSC:
every argument is tested with `is float`, `is int`, `is string`; a missing one throws, which sets
`shutdown` for good; bones keep what they were told last; `BonePositionSynchronize` is on, so that
the avatar's own offsets are replaced; with `HideInUncalibrated` the avatar is shown only in
calibration state 3; more than 30 `/VMC/Ext/T` in one Unity frame and what follows is dropped.
"""

from collections.abc import Callable, Mapping

from tests.outputs.receivers.humanoid import ORIGIN, PARENT_OF, Transform, Vector, chained
from tests.outputs.receivers.uosc import Message, UoscServer, Value

PACKET_LIMIT_MAX = 30
_FLOATS = (float,) * 7


class Evmc4u:
    """avatar: the bones it has, with their local rest transforms; by default all, at zero.

    `receive` takes a datagram, `update` is one frame of Unity: then the messages are handled.
    """

    def __init__(
        self,
        avatar: Mapping[str, Transform] | None = None,
        bone_position_synchronize: bool = True,
        hide_in_uncalibrated: bool = False,
    ) -> None:
        self._server = UoscServer()
        self._avatar = dict(avatar or dict.fromkeys(PARENT_OF, ORIGIN))
        self._bone_position_synchronize = bone_position_synchronize
        self._hide_in_uncalibrated = hide_in_uncalibrated
        self._bones: dict[str, Transform] = {}
        self._root: Transform = ORIGIN
        self._times_in_frame = self._times_in_last_frame = 0
        self.is_dead = False
        self.is_shown = True
        self.available = 0
        self.calibration_state: int | None = None
        self.time_s = 0.0
        self.dropped = 0

    def receive(self, datagram: bytes) -> None:
        """uOSC's thread."""
        self._server.receive(datagram)

    def update(self) -> None:
        """uOscServer.Update, then ExternalReceiver.Process."""
        for message in self._server.dequeue():
            self._take(message)
        self._times_in_last_frame, self._times_in_frame = self._times_in_frame, 0

    def joints_m(self) -> dict[str, Vector]:
        """Where its avatar's bones are, in mocapd's world: Unity's x turned round."""
        locals_ = dict(self._avatar)
        for bone, (at, turn) in self._bones.items():
            if bone in locals_:
                locals_[bone] = (at if self._bone_position_synchronize else locals_[bone][0], turn)
        bones = [bone for bone in PARENT_OF if bone in locals_]
        world = chained(locals_, self._root, bones)
        return {bone: (-x, y, z) for bone, ((x, y, z), _) in world.items()}

    def _take(self, message: Message) -> None:
        if self.is_dead:
            return
        if self._times_in_last_frame > PACKET_LIMIT_MAX:
            self.dropped += 1
            return
        try:
            self._process(message)
        except IndexError:  # ExternalReceiver catches all: "Communication Error", shutdown = true
            self.is_dead = True

    def _process(self, message: Message) -> None:
        handlers: dict[str, tuple[tuple[type, ...], Callable[[tuple[Value, ...]], None]]] = {
            "/VMC/Ext/OK": ((int,), self._ok),
            "/VMC/Ext/T": ((float,), self._time),
            "/VMC/Ext/Root/Pos": ((str, *_FLOATS), self._root_pose),
            "/VMC/Ext/Bone/Pos": ((str, *_FLOATS), self._bone_pose),
        }
        found = handlers.get(message.address)
        if found is None:
            return
        kinds, handle = found
        # `values[k] is float && ...`: in order, ending at the first that is not; a missing one throws
        if all(type(message.values[k]) is kind for k, kind in enumerate(kinds)):
            handle(message.values)

    def _ok(self, values: tuple[Value, ...]) -> None:
        self.available = _whole(values[0])
        if len(values) >= 3 and type(values[1]) is int and type(values[2]) is int:
            self.calibration_state = values[1]
            if self._hide_in_uncalibrated:
                self.is_shown = values[1] == 3

    def _time(self, values: tuple[Value, ...]) -> None:
        self.time_s = _floats(values)[0]
        self._times_in_frame += 1

    def _root_pose(self, values: tuple[Value, ...]) -> None:
        self._root = _transform(values[1:8])

    def _bone_pose(self, values: tuple[Value, ...]) -> None:
        if values[0] in PARENT_OF:  # Enum.TryParse: case matters
            self._bones[str(values[0])] = _transform(values[1:8])


def _whole(value: Value) -> int:
    assert isinstance(value, int)
    return value


def _floats(values: tuple[Value, ...]) -> list[float]:
    return [value for value in values if isinstance(value, float)]


def _transform(values: tuple[Value, ...]) -> Transform:
    px, py, pz, qx, qy, qz, qw = _floats(values)
    return (px, py, pz), (qx, qy, qz, qw)
