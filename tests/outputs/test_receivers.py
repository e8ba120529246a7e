"""The re-implemented receivers are as strict as their sources: what a careless sender would do to each of them."""

import math
import struct

import pytest

from tests.outputs.osc_packets import BONE, ROOT, bone, bundle, message
from tests.outputs.receivers.evmc4u import PACKET_LIMIT_MAX, Evmc4u
from tests.outputs.receivers.godot_xr_vmc_tracker import GodotXrVmcTracker
from tests.outputs.receivers.humanoid import PARENT_OF
from tests.outputs.receivers.slimevr import SlimevrInput
from tests.outputs.receivers.typed_osc import decoded
from tests.outputs.receivers.uosc import UoscServer
from tests.outputs.receivers.vmc4ue import Vmc4ue

Receiver = Evmc4u | GodotXrVmcTracker | Vmc4ue | SlimevrInput

EVERY = pytest.mark.parametrize("kind", [Evmc4u, GodotXrVmcTracker, Vmc4ue, SlimevrInput])
# Facing Unity's +Z, the left hand at -X: what an avatar in the T-pose is
HIPS = bone("Hips", -0.25, 1.0, 0.5, 0.0, 0.0, 0.0, 1.0)
LEFT_LEG = bone("LeftUpperLeg", -0.125, -0.0625, 0.0, 0.0, 0.0, 0.0, 1.0)


def fed(receiver: Receiver, *datagrams: bytes) -> Receiver:
    for datagram in datagrams:
        receiver.receive(datagram)
    if isinstance(receiver, Evmc4u):
        receiver.update()
    return receiver


@EVERY
def test_a_person_is_where_they_are_in_the_world_neither_mirrored_nor_backwards(
    kind: type[Receiver],
) -> None:
    joints = fed(kind(), bundle([HIPS, LEFT_LEG])).joints_m()
    assert joints["Hips"] == pytest.approx((0.25, 1.0, 0.5), abs=1e-6)
    assert joints["LeftUpperLeg"] == pytest.approx((0.375, 0.9375, 0.5), abs=1e-6)


@EVERY
def test_a_quarter_turn_to_the_left_takes_the_left_hip_backwards(kind: type[Receiver]) -> None:
    half = math.sqrt(0.5)  # about Unity's +Y by -90 degrees: seen from above counter-clockwise
    turned = bone("Hips", -0.25, 1.0, 0.5, 0.0, -half, 0.0, half)
    joints = fed(kind(), bundle([turned, LEFT_LEG])).joints_m()
    assert joints["LeftUpperLeg"] == pytest.approx((0.25, 0.9375, 0.375), abs=1e-6)


@EVERY
def test_two_messages_without_a_bundle_do_as_well(kind: type[Receiver]) -> None:
    joints = fed(kind(), HIPS.dgram, LEFT_LEG.dgram).joints_m()
    assert joints["LeftUpperLeg"] == pytest.approx((0.375, 0.9375, 0.5), abs=1e-6)


@pytest.mark.parametrize("kind", [Evmc4u, Vmc4ue, SlimevrInput])
def test_root_moves_and_turns_all_of_it(kind: type[Receiver]) -> None:
    root = message(ROOT, "sfffffff", "root", -1.0, 0.0, 2.0, 0.0, 1.0, 0.0, 0.0)  # by 180 degrees
    joints = fed(kind(), bundle([root, HIPS])).joints_m()
    assert joints["Hips"] == pytest.approx((1.0 - 0.25, 1.0, 2.0 - 0.5), abs=1e-6)


def test_uosc_does_not_move_on_over_an_unknown_tag() -> None:
    server = UoscServer()
    server.receive(message("/a", "dif", 0.5, 7, 0.25).dgram)
    (told,) = server.dequeue()
    # null, and then the double's own bytes are taken for the int and the float
    assert told.values == (None, 0x3FE00000, 0.0)
    assert server.complaints == ["inconsistent size: 20 / 28"]


def test_uosc_loses_what_follows_a_message_with_an_unknown_tag() -> None:
    server = UoscServer()
    server.receive(bundle([message("/a", "h", 2**40), HIPS, LEFT_LEG]))
    assert BONE not in [told.address for told in server.dequeue()]
    assert server.complaints


def test_uosc_passes_over_an_element_whose_size_is_no_multiple_of_four() -> None:
    server = UoscServer()
    server.receive(b"#bundle\0" + bytes(7) + b"\x01" + b"\0\0\0\x02/a" + bundle([HIPS])[16:])
    assert [told.address for told in server.dequeue()] == [BONE]
    assert server.complaints == ["bundle size 2 is not a multiple of 4"]


def test_uosc_opens_bundles_in_bundles() -> None:
    inner = bundle([HIPS])
    outer = b"#bundle\0" + bytes(7) + b"\x01" + len(inner).to_bytes(4, "big") + inner
    server = UoscServer()
    server.receive(outer)
    assert [told.values[0] for told in server.dequeue()] == ["Hips"]
    assert server.complaints == []


@pytest.mark.parametrize("tags", ["sfffffff", "sfffffffffffff"])
def test_evmc4u_takes_a_complete_message_and_more(tags: str) -> None:
    numbers = (0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, *(1.0,) * 6)[: len(tags) - 1]
    receiver = fed(Evmc4u(), bone("Hips", *numbers, tags=tags).dgram)
    assert receiver.joints_m()["Hips"] == (0.0, 1.0, 0.0)


@pytest.mark.parametrize("place", range(1, 8))
def test_evmc4u_passes_over_a_bone_with_an_int_or_a_double(place: int) -> None:
    for tag in "id":
        tags = "sfffffff"[:place] + tag + "sfffffff"[place + 1 :]
        receiver = Evmc4u()
        fed(receiver, bone("Hips", *(1,) * 7, tags=tags).dgram)
        assert receiver.joints_m()["Hips"] == (0.0, 0.0, 0.0)
        assert not receiver.is_dead


@pytest.mark.parametrize(
    ("address", "tags"),
    [(BONE, "sffffff"), (BONE, "s"), (BONE, ""), (ROOT, "sfff"), ("/VMC/Ext/OK", ""), ("/VMC/Ext/T", "")],
)  # fmt: skip
def test_one_message_that_is_too_short_kills_evmc4u(address: str, tags: str) -> None:
    receiver = Evmc4u()
    short = message(address, tags, *("Hips" if tag == "s" else 0.0 for tag in tags))
    fed(receiver, short.dgram)
    assert receiver.is_dead
    fed(receiver, HIPS.dgram)
    assert receiver.joints_m()["Hips"] == (0.0, 0.0, 0.0)


def test_evmc4u_sets_bone_positions_unless_told_not_to() -> None:
    avatar = {
        "Hips": ((0.0, 0.8, 0.0), (0.0, 0.0, 0.0, 1.0)),
        "Spine": ((0.0, 0.1, 0.0), (0.0, 0.0, 0.0, 1.0)),
    }
    collapsed = bone("Spine", *(0.0,) * 6, 1.0).dgram
    joints = fed(Evmc4u(avatar), HIPS.dgram, collapsed).joints_m()
    assert joints["Spine"] == joints["Hips"]
    kept = fed(Evmc4u(avatar, bone_position_synchronize=False), HIPS.dgram, collapsed).joints_m()
    assert kept == {"Hips": (-0.0, 0.8, 0.0), "Spine": (-0.0, pytest.approx(0.9), 0.0)}


@pytest.mark.parametrize(("state", "shown"), [(3, True), (0, False), (2, False)])
def test_evmc4u_may_hide_who_is_not_calibrated(state: int, shown: bool) -> None:
    receiver = Evmc4u(hide_in_uncalibrated=True)
    fed(receiver, message("/VMC/Ext/OK", "iiii", 1, state, 0, 1).dgram)
    assert (receiver.is_shown, receiver.calibration_state, receiver.available) == (shown, state, 1)


def test_evmc4u_drops_what_comes_too_fast() -> None:
    receiver = Evmc4u()
    time = message("/VMC/Ext/T", "f", 0.5).dgram
    fed(receiver, *[time] * (PACKET_LIMIT_MAX + 1))
    fed(receiver, HIPS.dgram)
    assert receiver.dropped == 1
    assert receiver.joints_m()["Hips"] == (0.0, 0.0, 0.0)


def test_evmc4u_knows_names_by_case() -> None:
    receiver = fed(Evmc4u(), bone("hips", 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0).dgram)
    assert receiver.joints_m()["Hips"] == (0.0, 0.0, 0.0)


def test_godot_ignores_root_and_leaves_untold_bones_at_zero() -> None:
    root = message(ROOT, "sfffffff", "root", 5.0, 0.0, 5.0, 0.0, 1.0, 0.0, 0.0)
    joints = fed(GodotXrVmcTracker(), bundle([root, HIPS])).joints_m()
    assert joints["Head"] == joints["Hips"] == pytest.approx((0.25, 1.0, 0.5))


def test_godot_hears_the_newest_port_only() -> None:
    receiver = GodotXrVmcTracker()
    receiver.receive(HIPS.dgram, ("127.0.0.1", 1000))
    receiver.receive(bone("Hips", *(0.0,) * 6, 1.0).dgram, ("127.0.0.1", 2000))
    receiver.receive(HIPS.dgram, ("127.0.0.1", 1000))
    assert receiver.joints_m()["Hips"] == (0.0, 0.0, 0.0)
    assert receiver.poses == 2


def test_godot_poses_once_for_each_datagram() -> None:
    receiver = fed(GodotXrVmcTracker(), bundle([HIPS, LEFT_LEG]))
    assert isinstance(receiver, GodotXrVmcTracker)
    assert receiver.poses == 1


def test_godot_loses_a_value_with_an_unknown_tag_and_does_not_move_on() -> None:
    receiver = fed(GodotXrVmcTracker(), bone("Hips", *(1.0,) * 7, tags="sdffffff").dgram)
    assert receiver.joints_m()["Hips"] == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("tag", "id")
def test_vmc4ue_reads_another_type_as_zero(tag: str) -> None:
    receiver = fed(Vmc4ue(), bone("Hips", 1, 1, 1, 0, 0, 0, 1, tags=f"sf{tag}fffff").dgram)
    assert receiver.joints_m()["Hips"] == (1.0 * -1.0, 0.0, 1.0)


def test_vmc4ue_passes_over_short_bones_and_dies_of_a_root_of_seven() -> None:
    receiver = Vmc4ue()
    fed(receiver, bone("Hips", *(1.0,) * 6, tags="sffffff").dgram)
    assert receiver.joints_m()["Hips"] == (0.0, 0.0, 0.0)
    assert not receiver.is_dead
    fed(receiver, message(ROOT, "sffffff", "root", *(1.0,) * 6).dgram)
    assert receiver.is_dead


@pytest.mark.parametrize("tags", ["sffffffi", "sdffffff", "sffffff"])
def test_slimevr_dies_of_a_cast(tags: str) -> None:
    receiver = SlimevrInput()
    fed(receiver, bone("Hips", *(1,) * (len(tags) - 1), tags=tags).dgram)
    assert receiver.is_dead


def test_the_typed_decoder_refuses_what_is_no_osc() -> None:
    for damaged in (b"", b"/a\0\0", HIPS.dgram[:-4], HIPS.dgram + b"\0\0\0\0", bundle([HIPS])[:-4]):
        with pytest.raises((ValueError, struct.error)):
            decoded(bytes(damaged))


def test_every_bone_of_unity_has_its_place() -> None:
    assert len(PARENT_OF) == 55  # HumanBodyBones without LastBone
    seen: set[str | None] = {None}
    for name, above in PARENT_OF.items():
        assert above in seen
        seen.add(name)
