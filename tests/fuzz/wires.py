"""What a subscriber decodes, and the file of users of the daemon's session."""

from random import Random

import msgspec

from mocapd.body.skeleton import standard_skeleton
from mocapd.outputs.from_skeleton import rest_skeleton
from mocapd.outputs.messages import REST_SKELETON, decode_rest_skeleton
from mocapd.outputs.wire import (
    JSON,
    JSON_MIME,
    MSGPACK,
    MSGPACK_MIME,
    decode,
    encode_json,
    encode_msgpack,
)
from mocapd.outputs.zenoh.zenoh_config import Params, session_config
from tests.fuzz.mutations import JSON_VALUES, damaged, mistyped
from tests.fuzz.row import Attempt, Place, WrongError
from tests.outputs.frames import small_frame, whole_frame

_ENCODINGS = (
    "", ";", "application/json", "application/msgpack", "application/msgpack;mocapd.Skeleton.v2", "text/plain",
    "application/json;", "\0", "\ud800", "é;é", "x" * 10_000,
)  # fmt: skip
_NESTED = (
    b"\x91" * 100_000, b"\x81\xa1a" * 50_000, b"\xdf\xff\xff\xff\xff", b"\xdd\xff\xff\xff\xff", b"\xc6\xff\xff\xff\xff",
    b"\x81\xa1x" + b"\x91" * 3000 + b"\x01", b"[" * 100_000, b'{"a":' * 50_000, b'{"x":' + b"[" * 600 + b"]" * 600 + b"}",
)  # fmt: skip
_USERS = b"game:secret\nviewer:Pa$$w0rd\n"
_USERS_WRONG = (
    b"", b"\n", b"  \n\n", b"game", b"game\nviewer\n", b":", b":secret", b"game:", b"\xef\xbb\xbfgame:secret\n", b"#\n",
    b"game secret\n", b"\0", b"\r\n\r\n", b"\xff\xfe", b"game\tsecret", b"game=secret\n", b" : \n", b"a:b:c\n",
)  # fmt: skip


def frames(place: Place) -> Attempt:
    """Payloads in msgpack and JSON, and encodings."""
    goods = [
        (encode(frame), encoding)
        for frame in (small_frame(), whole_frame())
        for encode, encoding in ((encode_msgpack, MSGPACK), (encode_json, JSON))
    ]
    for payload, encoding in goods:
        decode(payload, encoding)

    def attempt(random: Random, number: int) -> bool:
        payload, encoding = random.choice(goods)
        kind = random.random()
        if kind < 0.04:
            payload = random.choice(_NESTED)
        elif kind < 0.08:
            encoding = random.choice(_ENCODINGS)
        elif encoding == JSON:
            payload = mistyped(random, payload, JSON_VALUES)
        else:
            payload = damaged(random, payload)
        decode(payload, encoding)
        return True

    return attempt


def rest_skeletons(place: Place) -> Attempt:
    """What a client builds an avatar from: lists that are taken belong together."""
    rest = rest_skeleton(standard_skeleton(1.75), instance="pc", stature_m=1.75)
    goods = [
        (msgspec.msgpack.encode(rest), f"{MSGPACK_MIME};{REST_SKELETON}"),
        (msgspec.json.encode(rest), f"{JSON_MIME};{REST_SKELETON}"),
    ]
    for payload, encoding in goods:
        decode_rest_skeleton(payload, encoding)

    def attempt(random: Random, number: int) -> bool:
        payload, encoding = random.choice(goods)
        if random.random() < 0.04:
            payload = random.choice(_NESTED)
        elif encoding.startswith(JSON_MIME):
            payload = mistyped(random, payload, JSON_VALUES)
        else:
            payload = damaged(random, payload)
        read = decode_rest_skeleton(payload, encoding)
        for bone, parent in enumerate(read.parents):
            if not -1 <= parent < bone:
                raise WrongError("a bone before its parent is taken")
        return True

    return attempt


def users(place: Place) -> Attempt:
    """A password file: one that names no user must not be taken, as everybody would be let in."""
    path = place.folder / "users"
    path.write_bytes(_USERS)
    session_config(Params(password_file=str(path)))

    def attempt(random: Random, number: int) -> bool:
        data = _USERS_WRONG[number] if number < len(_USERS_WRONG) else damaged(random, _USERS)
        path.write_bytes(data)
        session_config(Params(password_file=str(path)))
        if not any(_is_login(line) for line in data.splitlines()):
            raise WrongError("a file without any user:password is taken: everybody is let in")
        return True

    return attempt


def _is_login(line: bytes) -> bool:
    user, colon, password = line.partition(b":")
    return bool(user.strip() and colon and password.strip())
