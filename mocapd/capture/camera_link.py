"""What lies between a camera and this program, where its frames can be lost."""

from enum import StrEnum


class CameraLink(StrEnum):
    """usb: a webcam with a USB identity; device: a node without one, such as a laptop's own camera; network: a URL, or a
    camera of a camera node; player: this machine makes the pictures, of a simulated or a recorded camera."""

    USB = "usb"
    DEVICE = "device"
    NETWORK = "network"
    PLAYER = "player"
