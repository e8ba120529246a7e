"""The skeleton as a message: a receiver builds the person from it, and hears of it when it has changed."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from mocapd import client
from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.body.skeleton import INDEX, standard_skeleton
from mocapd.errors import InputError
from mocapd.geometry import rotations
from mocapd.outputs import wire
from mocapd.outputs.from_skeleton import NOTICEABLE_M, is_noticeable, rest_skeleton
from mocapd.outputs.messages import RestSkeleton, decode_rest_skeleton
from tests.outputs.frames import left_hand_up, whole_frame
from tests.outputs.zenoh_pair import running_sink

ENCODING = "application/msgpack;mocapd.Skeleton.Rest.v1"


def told() -> RestSkeleton:
    _, skeleton = left_hand_up()
    return rest_skeleton(skeleton, instance="pc", stature_m=1.75)


def posed(rest: RestSkeleton, frame: wire.SkeletonFrame) -> dict[str, np.ndarray]:
    """A game's own forward kinematics: one pass over the lists."""
    joints: list[np.ndarray] = []
    for name, parent, offset in zip(rest.names, rest.parents, rest.offsets_m, strict=True):
        if parent < 0:
            joints.append(np.array(frame.joints[name].p))
            continue
        turn = np.array(frame.joints[rest.names[parent]].r)
        joints.append(joints[parent] + rotations.rotate(turn, np.array(offset)))
    return dict(zip(rest.names, joints, strict=True))


def test_its_offsets_and_a_frames_rotations_give_the_frames_joints() -> None:
    frame = whole_frame()
    for name, at_m in posed(told(), frame).items():
        np.testing.assert_allclose(at_m, frame.joints[name].p, atol=1e-12)


def test_the_person_stands_on_the_floor_facing_z_with_the_left_hand_at_x() -> None:
    rest = told()
    assert rest.names[0] == "hips"
    assert rest.parents[0] == -1
    assert 0.8 < rest.offsets_m[0][1] < 1.1
    assert rest.offsets_m[rest.names.index("leftLowerArm")][0] > 0.2
    assert rest.offsets_m[rest.names.index("leftToes")][2] > 0.05
    assert rest.stature_m == 1.75


def test_it_survives_the_wire() -> None:
    assert decode_rest_skeleton(msgspec.msgpack.encode(told()), ENCODING) == told()


@pytest.mark.parametrize(
    "damaged",
    [
        {"parents": (-1,)},
        {"parents": tuple(range(22))},  # a bone before its parent would have no place yet
        {"schema": "mocapd.Skeleton.Rest.v2"},
        {"names": ("hips",)},
    ],
)
def test_lists_that_do_not_belong_together_are_refused(damaged: dict[str, object]) -> None:
    payload = msgspec.msgpack.encode(msgspec.structs.replace(told(), **damaged))
    with pytest.raises(InputError):
        decode_rest_skeleton(payload, ENCODING)


def test_a_client_asks_for_it_whenever_it_wants() -> None:
    with running_sink() as running, client.Client(client.Link(running.endpoint)) as game:
        assert game.rest() is None
        running.sink.send_state(told())
        assert game.rest() == told()
        taller = msgspec.structs.replace(told(), stature_m=1.9)
        running.sink.send_state(taller)
        assert game.rest() == taller


def test_a_change_is_noticeable_by_what_moves() -> None:
    was = standard_skeleton(1.75)
    moved = was.rest_m.copy()
    moved[INDEX["leftHand"], 0] += 0.9 * NOTICEABLE_M
    assert not is_noticeable(was, was)
    assert not is_noticeable(was, replace(was, rest_m=moved))
    moved[INDEX["leftHand"], 0] += 0.2 * NOTICEABLE_M
    assert is_noticeable(was, replace(was, rest_m=moved))
    assert is_noticeable(was, skeleton_of(BodyShape(1.75, np.full(7, 1.05))))
    assert is_noticeable(was, replace(was, names=was.names[::-1]))
