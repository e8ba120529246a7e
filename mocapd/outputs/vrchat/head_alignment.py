"""When VRChat is sent the head's rotation: once after each wish, and after silence, so that it turns at once.

VRChat turns the space of the trackers so that the head that it is sent looks where the headset does: at once
after more than 300 ms without such a message, slowly while they come steadily. A head that is seen by cameras is
noisy, so it is told only when the wearer asks for it, as SlimeVR does. The same wish makes forward
what the person looks along, in the frame in which VRChat hears of it.
"""

from collections import deque

from mocapd.clock import NS_PER_S

SILENCE_NS = (
    4 * NS_PER_S // 10
)  # more than VRChat's 0.3 s, as the network may hurry a datagram [ns]


class HeadAlignment:
    """`ask` from any thread, the rest from the one that sends.

    turn_rad: what everything is turned by, about +Y; forward_rad: what is turned to look along that is forward.
    """

    def __init__(self, forward_rad: float = 0.0) -> None:
        self.forward_rad = self.turn_rad = forward_rad
        self._asked: deque[None] = deque(maxlen=1)  # the newest wish alone; its calls are atomic
        self._told_ns: int | None = None

    def ask(self) -> None:
        """The way the person faces is to be forward."""
        self._asked.append(None)

    def take(self, now_ns: int, facing_rad: float | None) -> bool:
        """Whether this frame has the head's rotation, which is then `forward_rad`: from it on, everything is turned
        so. A wish waits for the silence, and for a person of whom it is known where it faces."""
        is_silent = self._told_ns is None or now_ns - self._told_ns >= SILENCE_NS
        if not self._asked or facing_rad is None or not is_silent:
            return False
        self._asked.clear()
        self._told_ns = now_ns
        self.turn_rad = self.forward_rad - facing_rad
        return True
