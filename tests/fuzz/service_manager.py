"""The service manager: the variables by which it is found, and what it is told of cameras that call themselves anything.

udev has no row: of its events only the action is looked at, which is compared with one word.
"""

import socket
import string
from random import Random

from mocapd.app.daemon.notifier import Notifier
from tests.fuzz.mutations import damaged
from tests.fuzz.row import Attempt, Place, WrongError

_LIMITS = (
    "",
    "0",
    "-1",
    "4000000",
    "9" * 5000,
    "\u00b2",
    " 1",
    "1e9",
    "0x10",
    "\udcff",
    "18446744073709551616",
)
_PIDS = ("", "0", "1", "x", "-1", "9" * 5000)
_ODD = "\n\r\0\t\x1b\x85\u2028\u202e\ud800\udcff\U0001f600="


def variables(place: Place) -> Attempt:
    """NOTIFY_SOCKET and those of the watchdog: none of them is left, and what is no socket is a named error."""
    manager = _Manager(place)
    Notifier.of_environment({"NOTIFY_SOCKET": manager.address}).ready("")
    if manager.heard() != ["READY=1\nSTATUS="]:
        raise WrongError("a good socket is told nothing")

    def attempt(random: Random, number: int) -> bool:
        sound = manager.address.encode()
        address = (damaged(random, sound) if number % 2 else sound).decode(errors="surrogateescape")
        env = {
            "NOTIFY_SOCKET": address,
            "WATCHDOG_USEC": random.choice(_LIMITS),
            "WATCHDOG_PID": random.choice(_PIDS),
        }
        try:
            notifier = Notifier.of_environment(env)
        finally:
            if env:
                raise WrongError(f"{sorted(env)} are left for children")
        notifier.restore_watchdog()
        notifier.heartbeat()
        notifier.extend_watchdog(random.choice((0.0, 1.0, 1e6)))
        notifier.close()
        manager.heard()
        return True

    return attempt


def statuses(place: Place) -> Attempt:
    """Whatever a camera calls itself, the manager hears one line of it and no word that is not ours."""
    manager = _Manager(place)
    notifier = Notifier(manager.address)

    def attempt(random: Random, number: int) -> bool:
        alphabet = _ODD + string.ascii_letters
        text = "".join(random.choices(alphabet, k=random.randrange(60))) + "\nREADY=1\nMAINPID=1"
        notifier.status(text)
        for message in manager.heard():
            if "\n" in message or "\0" in message or not message.startswith("STATUS="):
                raise WrongError(f"the manager is told {message!r}")
        return True

    return attempt


class _Manager:
    """The other end of the socket."""

    def __init__(self, place: Place) -> None:
        self.address = str(place.folder / "notify")
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.bind(self.address)
        self._socket.setblocking(False)

    def heard(self) -> list[str]:
        """What came since."""
        messages = []
        while True:
            try:
                messages.append(self._socket.recv(1 << 16).decode())
            except BlockingIOError:
                return messages
