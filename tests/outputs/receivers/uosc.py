"""uOSC, the OSC library under EVMC4U and many other Unity receivers, with its weaknesses.

Re-implements hecomi/uOSC `Assets/uOSC/Runtime/Core/Parser.cs`,
`.../Scripts/Core/{Reader,Util}.cs` and `Runtime/uOscServer.cs`: an unknown type tag (d, h, t, N,
...) gives null and does NOT move on, so that all that follows in the datagram is garbage; an
element of a bundle whose size is no multiple of 4 is skipped; what runs out of the datagram
raises, which loses the rest of it (the server's thread logs it and goes on).
"""

import struct
from collections import deque
from dataclasses import dataclass

Value = int | float | str | bytes | bool | None


@dataclass(frozen=True)
class Message:
    """values: C#'s boxed objects: int, float, str, bytes, bool, or None for a tag that uOSC does not know."""

    address: str
    values: tuple[Value, ...]


class UoscServer:
    """`receive` is its thread, `dequeue` its Update."""

    def __init__(self) -> None:
        self._messages: deque[Message] = deque()
        self.complaints: list[str] = []  # Debug.LogError

    def receive(self, datagram: bytes) -> None:
        """One datagram."""
        try:
            _Parser(datagram, self._messages, self.complaints).parse(len(datagram))
        except (IndexError, struct.error) as error:  # IndexOutOfRangeException, ArgumentException
            self.complaints.append(f"exception: {error}")

    def dequeue(self) -> list[Message]:
        """What has come since the last call."""
        messages = list(self._messages)
        self._messages.clear()
        return messages


class _Parser:
    def __init__(self, data: bytes, messages: deque[Message], complaints: list[str]) -> None:
        self._data, self._messages, self._complaints = data, messages, complaints
        self._at = 0

    def parse(self, end: int) -> None:
        first = self._string()
        if first == "#bundle":
            self._bundle(end)
        else:
            self._messages.append(Message(first, self._values()))
        if self._at != end:
            self._complaints.append(f"inconsistent size: {self._at} / {end}")

    def _bundle(self, end: int) -> None:
        self._number(">Q")
        while self._at < end:
            size = int(self._number(">i"))
            if size % 4 == 0:
                self.parse(self._at + size)
            else:
                self._complaints.append(f"bundle size {size} is not a multiple of 4")
                self._at += size

    def _values(self) -> tuple[Value, ...]:
        return tuple(self._value(tag) for tag in self._string()[1:])

    def _value(self, tag: str) -> Value:
        match tag:
            case "i":
                return int(self._number(">i"))
            case "f":
                return self._number(">f")
            case "s":
                return self._string()
            case "b":
                return self._blob()
            case "T" | "F":
                return tag == "T"
            case _:
                return None  # and the position stays where it is

    def _string(self) -> str:
        size = 0
        while self._data[self._at + size]:
            size += 1
        text = self._data[self._at : self._at + size].decode(errors="replace")
        self._at += (size + 4) & ~3
        return text

    def _number(self, form: str) -> float:
        (value,) = struct.unpack_from(form, self._data, self._at)
        self._at += struct.calcsize(form)
        return value  # type: ignore[no-any-return]

    def _blob(self) -> bytes:
        size = int(self._number(">i"))
        value = self._data[self._at : self._at + size]
        self._at += (size + 3) & ~3
        return value
