"""A /sys and /dev as the kernel shows them with webcams plugged in, made of plain files."""

from pathlib import Path

from mocapd.capture.webcam.identity import WebcamIdentity

HOST = "devices/pci0000:00/0000:00:14.0"


class FakeMachine:
    """`sysfs` and `dev` are the roots; nodes are plain files (opening them for V4L2 says ENOTTY)."""

    def __init__(self, root: Path) -> None:
        self.sysfs = root / "sys"
        self.dev = root / "dev"
        (self.sysfs / "class" / "video4linux").mkdir(parents=True)
        self.dev.mkdir()

    def plug(
        self,
        identity: WebcamIdentity,
        name: str,
        first: int,
        nodes: int = 2,
        interface_class: str = "0e",
    ) -> None:
        """A UVC webcam with nodes /dev/video<first>...: one that captures, then metadata."""
        bus = identity.port_path.split("-")[0]
        device = self.sysfs / HOST / f"usb{bus}" / identity.port_path
        device.mkdir(parents=True)
        (device / "idVendor").write_text(f"{identity.vid}\n")
        (device / "idProduct").write_text(f"{identity.pid}\n")
        if identity.serial:
            (device / "serial").write_text(f"{identity.serial}\n")
        (device / "product").write_text(f"{name}\n")
        interface = device / f"{identity.port_path}:1.0"
        interface.mkdir()
        (interface / "bInterfaceClass").write_text(f"{interface_class}\n")
        bus_devices = self.sysfs / "bus" / "usb" / "devices"
        bus_devices.mkdir(parents=True, exist_ok=True)
        for folder in (device, interface):
            (bus_devices / folder.name).symlink_to(folder)
        for index in range(nodes):
            self._node(interface, first + index, name, index)

    def add_virtual(self, name: str, number: int) -> None:
        """A node that is not on USB, such as v4l2loopback's."""
        self._node(self.sysfs / "devices" / "virtual", number, name, 0, linked=False)

    def _node(self, parent: Path, number: int, name: str, index: int, linked: bool = True) -> None:
        folder = parent / "video4linux" / f"video{number}"
        folder.mkdir(parents=True)
        (folder / "name").write_text(f"{name}\n")
        (folder / "index").write_text(f"{index}\n")
        if linked:
            (folder / "device").symlink_to(parent)
        (self.sysfs / "class" / "video4linux" / folder.name).symlink_to(folder)
        (self.dev / folder.name).touch()
