"""Sends VRChat the head's rotation once for each recenter request, after a pause, so that it aligns at once.

VRChat rotates the tracker space until the received head rotation matches the headset: at once after more than 300 ms
without such a message, slowly while they arrive steadily. A head tracked by cameras is noisy, so mocapd sends its
rotation only at the wearer's request, as SlimeVR does. The same request makes the person's facing direction forward,
in the frame that carries the head rotation.
"""

from collections import deque

from mocapd.clock import NS_PER_S

SILENCE_NS = 4 * NS_PER_S // 10  # more than VRChat's 0.3 s, because of network jitter [ns]


class HeadAlignment:
    """`ask` from any thread, the rest from the sending one.

    turn_rad: rotation of the whole body about +Y; forward_rad: the yaw that counts as forward.
    """

    def __init__(self, forward_rad: float = 0.0) -> None:
        self.forward_rad = self.turn_rad = forward_rad
        # a pending recenter request; deque's calls are atomic
        self._asked: deque[None] = deque(maxlen=1)
        self._sent_ns: int | None = None

    def ask(self) -> None:
        """Request that the person's facing direction become forward."""
        self._asked.append(None)

    def take(self, now_ns: int, facing_rad: float | None) -> bool:
        """True if this frame carries the head's rotation, `forward_rad`; from it on `turn_rad` matches. A request waits
        for the pause, and for a frame with a facing direction."""
        is_silent = self._sent_ns is None or now_ns - self._sent_ns >= SILENCE_NS
        if not self._asked or facing_rad is None or not is_silent:
            return False
        self._asked.clear()
        self._sent_ns = now_ns
        self.turn_rad = self.forward_rad - facing_rad
        return True
