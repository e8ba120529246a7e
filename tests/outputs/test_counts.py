"""Counters that have no limit within the daemon fit their messages."""

from typing import Any

import msgspec
import pytest

from mocapd.outputs import messages
from mocapd.outputs.messages import MOST_COUNT, CameraStatus, Health, OutputHealth
from mocapd.outputs.zenoh.zenoh_state import ZenohState
from tests.outputs.test_zenoh_sink import CAMERA, HEALTH

OUTPUT = OutputHealth("zenoh", sent=1, refused=0, listeners=-1, detail="")
GAUGES = {"pid", "started_unix_ns", "now_unix_ns", "listeners"}


@pytest.mark.parametrize("message_format", ["msgpack", "json"])
@pytest.mark.parametrize("good", [CAMERA, HEALTH, OUTPUT], ids=lambda one: type(one).__name__)
@pytest.mark.parametrize("value", [-1, MOST_COUNT, 2**64, 10**400])
def test_whatever_a_counter_holds_its_message_is_sent(
    good: CameraStatus | Health | OutputHealth, message_format: str, value: int
) -> None:
    whole = [name for name in good.__struct_fields__ if type(getattr(good, name)) is int]
    counters: dict[str, Any] = {name: value for name in whole if name not in GAUGES}
    assert counters
    made = type(good)(**{**msgspec.structs.asdict(good), **counters})
    assert all(getattr(made, name) == max(0, min(value, MOST_COUNT)) for name in counters)
    health = made if isinstance(made, Health) else HEALTH
    if isinstance(made, OutputHealth):
        health = msgspec.structs.replace(HEALTH, outputs=(made,))
    state = ZenohState("pc", message_format)
    state.set(made if isinstance(made, CameraStatus) else health)
    encode = msgspec.msgpack if message_format == "msgpack" else msgspec.json
    assert encode.decode(encode.encode(made), type=type(made)) == made


def test_the_schemas_say_the_limit() -> None:
    described = msgspec.json.schema(messages.CameraStatus)["$defs"]["CameraStatus"]["properties"]
    assert described["lost_frames"]["minimum"] == 0
    assert described["lost_frames"]["maximum"] == MOST_COUNT
