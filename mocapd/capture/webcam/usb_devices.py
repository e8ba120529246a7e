"""USB devices of the video class from sysfs, also those for which no driver made a node."""

from dataclasses import dataclass
from pathlib import Path

from mocapd.capture.webcam.identity import WebcamIdentity
from mocapd.capture.webcam.webcams import SYSFS, attribute, usb_identity

VIDEO_CLASS = "0e"
"""bInterfaceClass of a webcam; its bDeviceClass is ef (several interfaces)."""


@dataclass(frozen=True, slots=True)
class UsbWebcam:
    """A USB device with a video interface. `product`: its name, empty where it has none."""

    identity: WebcamIdentity
    product: str


def usb_webcams(sysfs: Path = SYSFS) -> tuple[UsbWebcam, ...]:
    """Every video-class device on a USB bus; empty where there is no USB, as in a container."""
    devices = {
        interface.parent
        for interface in (sysfs / "bus" / "usb" / "devices").glob("*/*:*")
        if attribute(interface / "bInterfaceClass") == VIDEO_CLASS
    }
    webcams = (UsbWebcam(usb_identity(one), attribute(one / "product")) for one in devices)
    return tuple(sorted(webcams, key=lambda webcam: webcam.identity.port_path))
