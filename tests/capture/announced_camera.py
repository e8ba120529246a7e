"""Says what is heard when udev announces a camera, in a network namespace of its own, where udev is ourselves.

    unshare --map-root-user --net python -m tests.capture.announced_camera

The message is as systemd's sd-device sends it: a header with a hash of the subsystem to filter by, then properties.
"""

import socket
import struct
import threading

from mocapd.capture.webcam.plug_events import PlugEvents

NETLINK_KOBJECT_UEVENT, UDEV_GROUP = 15, 2
_HEADER = struct.Struct("=8sI3I4I")
_M = 0x5BD1E995
MANY = 60_000  # no kernel keeps so many for one listener


def hash_of(text: bytes) -> int:
    """MurmurHash2 of 32 bits, whose last one to three bytes are taken together."""
    h = len(text)
    whole = len(text) // 4 * 4
    for (k,) in struct.iter_unpack("<I", text[:whole]):
        k = k * _M & 0xFFFFFFFF
        k = (k ^ k >> 24) * _M & 0xFFFFFFFF
        h = h * _M & 0xFFFFFFFF ^ k
    if rest := text[whole:]:
        h = (h ^ int.from_bytes(rest, "little")) * _M & 0xFFFFFFFF
    h = (h ^ h >> 13) * _M & 0xFFFFFFFF
    return h ^ h >> 15


def announce(action: str, subsystem: str, node: str) -> None:
    """As udev, once it has made a node."""
    properties = {
        "ACTION": action,
        "DEVPATH": f"/devices/virtual/{subsystem}/{node}",
        "SUBSYSTEM": subsystem,
        "DEVNAME": f"/dev/{node}",
        "SEQNUM": "7",
    }
    body = b"".join(f"{key}={value}\0".encode() for key, value in properties.items())
    filters = socket.htonl(hash_of(subsystem.encode())), 0, 0, 0
    magic = socket.htonl(0xFEEDCAFE)
    head = _HEADER.pack(b"libudev\0", magic, _HEADER.size, _HEADER.size, len(body), *filters)
    with socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, NETLINK_KOBJECT_UEVENT) as sender:
        sender.sendto(head + body, (0, UDEV_GROUP))


def main() -> None:
    """Two that are no news, then one that is, then far too many."""
    heard = threading.Semaphore(0)
    events = PlugEvents(heard.release)
    print("can hear", events.start())
    announce("add", "sound", "card1")
    announce("remove", "video4linux", "video9")
    print("of others", heard.acquire(timeout=0.3))
    announce("add", "video4linux", "video9")
    print("of a camera", heard.acquire(timeout=10.0))
    events.stop()
    events.stop()
    print("after more than is taken at once", hears_after_a_flood())


def hears_after_a_flood() -> bool:
    """Whether the next camera is heard still, when words were lost while nobody listened."""
    heard, listening = threading.Semaphore(0), threading.Event()

    def busy() -> None:
        listening.wait()
        heard.release()

    events = PlugEvents(busy)
    events.start()
    for _ in range(MANY):
        announce("add", "video4linux", "video9")
    listening.set()
    while heard.acquire(timeout=1.0):
        pass
    announce("add", "video4linux", "video9")
    hears = heard.acquire(timeout=10.0)
    events.stop()
    return hears


if __name__ == "__main__":
    main()
