"""USB devices of the video class through pyusb, also those for which no driver made a node.

`libusb-package` brings libusb itself, so no system library is needed.
"""

from dataclasses import dataclass

import libusb_package
import usb.core

from mocapd.capture.webcam.identity import WebcamIdentity

VIDEO_CLASS = 14
"""bInterfaceClass of a webcam; its bDeviceClass is 239 (several interfaces)."""


@dataclass(frozen=True, slots=True)
class UsbWebcam:
    """A USB device with a video interface. `has_serial` is False without permission to read it."""

    identity: WebcamIdentity
    product: str
    has_serial: bool


def usb_webcams() -> tuple[UsbWebcam, ...]:
    """Every video-class device of libusb; empty without access to USB."""
    backend = libusb_package.get_libusb1_backend()
    if backend is None:
        return ()
    try:
        devices = list(usb.core.find(find_all=True, backend=backend))
    except usb.core.USBError:  # no bus is mounted here, as in a container
        return ()
    webcams = (_webcam(device) for device in devices if _is_webcam(device))
    return tuple(sorted(webcams, key=lambda webcam: webcam.identity.port_path))


def _is_webcam(device: usb.core.Device) -> bool:
    try:
        return any(face.bInterfaceClass == VIDEO_CLASS for setup in device for face in setup)
    except usb.core.USBError:  # unplugged while we looked
        return False


def _webcam(device: usb.core.Device) -> UsbWebcam:
    # `address` changes at each plugging; the chain of port numbers belongs to the socket.
    ports = ".".join(str(port) for port in device.port_numbers or ())
    try:
        serial, product, has_serial = device.serial_number or "", device.product or "", True
    except (ValueError, usb.core.USBError):  # no right to write to the USB node: "no langid"
        serial, product, has_serial = "", "", False
    identity = WebcamIdentity(
        f"{device.bus}-{ports}", f"{device.idVendor:04x}", f"{device.idProduct:04x}", serial
    )
    return UsbWebcam(identity, product, has_serial)
