"""Avatars' files that a user names: `.vrm`."""

import json
import struct
from collections.abc import Callable
from random import Random

import numpy as np

from mocapd.outputs.vmc.vmc_space import local_rotations, vmc_heading, vmc_poses
from mocapd.outputs.vmc.vrm_file import read_vrm
from tests.fuzz.mutations import JSON_VALUES, damaged, mistyped
from tests.fuzz.row import Attempt, Place, WrongError
from tests.outputs.vmc.vrm_models import Model, Node, glb, model

_HEADER = 20  # bytes before the JSON
_MOST = 1e12  # of a number of a pose; beyond, a float32 would soon be infinite


def with_json(whole: bytes, change: Callable[[bytes], bytes]) -> bytes:
    """An avatar's file with its JSON changed, and nothing behind it."""
    (length,) = struct.unpack_from("<I", whole, 12)
    return _with_text(whole, change(whole[_HEADER : _HEADER + length]))


def _with_text(whole: bytes, text: bytes) -> bytes:
    return whole[:12] + struct.pack("<I", len(text)) + whole[16:_HEADER] + text


def vrms(place: Place) -> Attempt:
    """Damaged in the JSON, which is then whole glTF again, or anywhere; one that is taken poses an avatar."""
    path = place.folder / "avatar.vrm"
    top = Node(None, (0.0, 0.1, 0.0), (0.7071, 0.0, 0.0, 0.7071), 0.01)
    models: tuple[Model, ...] = (model(0), model(1), model(0, top=top), model(1, between=("head",)))
    goods = [(glb(one.document()), json.dumps(one.document()).encode()) for one in models]
    for whole, _ in goods:
        path.write_bytes(whole)
        read_vrm(path)

    def attempt(random: Random, number: int) -> bool:
        whole, text = random.choice(goods)
        if random.random() < 0.8:
            text = mistyped(random, text, JSON_VALUES)
            whole = _with_text(whole, text)
        else:
            whole = damaged(random, whole)
        path.write_bytes(whole)
        avatar = read_vrm(path)
        where = vmc_heading(0.0, 0.0, by_root=False)
        upright = local_rotations(avatar, where, [(0.0, 0.0, 0.0, 1.0)] * len(avatar.names))
        pose = vmc_poses(avatar, where, (0.3, 1.0, 0.2), upright, avatar.hips_height_m)
        if not np.abs(pose).max() < _MOST:
            raise WrongError("an avatar is taken whose pose is no number")
        return True

    return attempt
