"""Finding webcams in sysfs, and what the listing says of each node."""

import grp
import os
from pathlib import Path

import pytest

from mocapd.capture.webcam.device_access import holders, how_to_be_let_in
from mocapd.capture.webcam.identity import WebcamIdentity
from mocapd.capture.webcam.usb_devices import UsbWebcam, usb_webcams
from mocapd.capture.webcam.v4l2 import V4l2Source
from mocapd.capture.webcam.webcam_listing import list_cameras
from mocapd.capture.webcam.webcams import capture_nodes, find_webcam, video_nodes
from mocapd.errors import UnavailableError
from tests.capture.fake_sysfs import FakeMachine

LEFT = WebcamIdentity("1-3", "046d", "0825", "AA:01")
RIGHT = WebcamIdentity("1-4.2", "1bcf", "28c4", "")


@pytest.fixture
def machine(tmp_path: Path) -> FakeMachine:
    machine = FakeMachine(tmp_path)
    machine.plug(RIGHT, "HD Camera", 0)
    machine.plug(LEFT, "Webcam C270", 10)  # a text sort would put video10 before video2
    machine.add_virtual("Loopback", 2)
    return machine


def test_nodes_come_in_the_order_of_their_numbers(machine: FakeMachine) -> None:
    nodes = video_nodes(machine.sysfs, machine.dev)
    assert [node.node.name for node in nodes] == [
        "video0",
        "video1",
        "video2",
        "video10",
        "video11",
    ]
    assert [node.identity for node in nodes] == [RIGHT, RIGHT, None, LEFT, LEFT]
    assert nodes[3].name == "Webcam C270"
    assert nodes[3].interface == "1-3:1.0"


def test_only_the_node_that_captures_is_offered(machine: FakeMachine) -> None:
    nodes = capture_nodes(machine.sysfs, machine.dev)
    assert {str(one): node.node.name for one, node in nodes.items()} == {
        str(LEFT): "video10",
        str(RIGHT): "video0",
    }


def test_an_identity_is_resolved_again_after_each_plugging(tmp_path: Path) -> None:
    before, after = FakeMachine(tmp_path / "a"), FakeMachine(tmp_path / "b")
    before.plug(LEFT, "C270", 0)
    after.plug(WebcamIdentity("2-1.4", *LEFT.model), "C270", 6)
    match, node = find_webcam(LEFT, sysfs=before.sysfs, dev=before.dev)
    assert (match.moved, node.name) == (False, "video0")
    match, node = find_webcam(LEFT, sysfs=after.sysfs, dev=after.dev)
    assert (match.moved, node.name) == (True, "video6")


def test_an_absent_webcam_is_unavailable_and_says_where_it_belongs(machine: FakeMachine) -> None:
    source = V4l2Source(
        "left", WebcamIdentity("1-9", "dead", "beef", ""), sysfs=machine.sysfs, dev=machine.dev
    )
    with pytest.raises(UnavailableError, match=r"usb:1-9:dead:beef:.*not plugged in.*port 1-9"):
        source.open()


def test_a_node_that_udev_has_not_made_yet_is_unavailable(machine: FakeMachine) -> None:
    (machine.dev / "video10").unlink()
    with pytest.raises(UnavailableError, match="not made yet"):
        find_webcam(LEFT, sysfs=machine.sysfs, dev=machine.dev)


def test_a_machine_without_video_has_no_cameras(tmp_path: Path) -> None:
    assert list_cameras(tmp_path, tmp_path, usb=lambda: ()) == ()


def test_the_listing_gives_each_node_its_reason(machine: FakeMachine) -> None:
    rows = list_cameras(machine.sysfs, machine.dev, usb=lambda: ())
    by_name = {row.node.name: row for row in rows if row.node}
    assert by_name["video10"].spec == str(LEFT)
    assert by_name["video10"].usb_id == "046d:0825:AA:01"
    assert by_name["video10"].port_path == "1-3"
    assert by_name["video2"].spec == str(machine.dev / "video2")
    assert all(row.problem == "not a video node" for row in rows)  # plain files
    assert not any(row.usable for row in rows)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may open everything")
def test_a_node_without_permission_says_how_to_get_it(machine: FakeMachine) -> None:
    (machine.dev / "video10").chmod(0)
    rows = list_cameras(machine.sysfs, machine.dev, usb=lambda: ())
    row = next(row for row in rows if row.node and row.node.name == "video10")
    assert row.problem == "no permission"
    assert "usermod -aG" in row.fix


def test_nobody_is_told_to_join_the_group_of_root() -> None:
    node = Path("/dev/video0")
    assert "usermod" not in how_to_be_let_in(node, 0)
    assert "sudo chgrp video /dev/video0" in how_to_be_let_in(node, 0)
    assert "usermod -aG" in how_to_be_let_in(node, max(one.gr_gid for one in grp.getgrall()))


def test_a_webcam_without_a_driver_is_listed_with_the_mend(machine: FakeMachine) -> None:
    lone = UsbWebcam(WebcamIdentity("1-5", "0c45", "6366", "SN1"), "USB Camera")
    twice = UsbWebcam(LEFT, "Webcam C270")
    rows = list_cameras(machine.sysfs, machine.dev, usb=lambda: (twice, lone))
    without = [row for row in rows if row.node is None]
    assert [row.spec for row in without] == ["usb:1-5:0c45:6366:SN1"]
    assert "modprobe uvcvideo" in without[0].fix


def test_usb_webcams_are_found_also_where_no_driver_made_a_node(tmp_path: Path) -> None:
    machine = FakeMachine(tmp_path)
    machine.plug(LEFT, "Webcam C270", 0)
    machine.plug(RIGHT, "HD Camera", 2, nodes=0)
    machine.plug(WebcamIdentity("1-6", "046d", "c077"), "Mouse", 4, nodes=0, interface_class="03")
    assert usb_webcams(machine.sysfs) == (
        UsbWebcam(LEFT, "Webcam C270"),
        UsbWebcam(RIGHT, "HD Camera"),
    )
    rows = list_cameras(machine.sysfs, machine.dev, lambda: usb_webcams(machine.sysfs))
    assert [row.spec for row in rows if row.node is None] == [str(RIGHT)]


def test_a_machine_without_usb_has_no_usb_webcams(tmp_path: Path) -> None:
    assert usb_webcams(tmp_path) == ()


def test_who_holds_a_node_is_found_in_proc(tmp_path: Path) -> None:
    node = Path("/dev/video7")
    for pid, target in ((4711, node), (4712, Path("/dev/null"))):
        (tmp_path / str(pid) / "fd").mkdir(parents=True)
        (tmp_path / str(pid) / "fd" / "3").symlink_to(target)
        (tmp_path / str(pid) / "comm").write_text("cheese\n")
    assert holders(node, tmp_path) == ((4711, "cheese"),)


def test_each_plugging_in_is_another_word_and_another_port_is_told(tmp_path: Path) -> None:
    machine = FakeMachine(tmp_path)
    source = V4l2Source("left", LEFT, sysfs=machine.sysfs, dev=machine.dev)
    assert source.plugging() == ""
    machine.plug(LEFT, "Webcam C270", 4)
    first = source.plugging()
    assert "video4" in first
    assert source.plugging() == first
    node = machine.dev / "video4"
    node.rename(tmp_path / "kept")  # else the next file may get its inode
    node.touch()
    assert source.plugging() not in ("", first)
    assert source.identity == LEFT
    assert source.place == ""
