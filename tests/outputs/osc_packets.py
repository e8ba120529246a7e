"""Datagrams with any tags, built by python-osc: what a careless sender would send."""

from collections.abc import Sequence

from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message import OscMessage
from pythonosc.osc_message_builder import OscMessageBuilder

BONE = "/VMC/Ext/Bone/Pos"
ROOT = "/VMC/Ext/Root/Pos"


def message(address: str, tags: str, *values: str | float) -> OscMessage:
    """A message whose arguments have these tags."""
    builder = OscMessageBuilder(address)
    for tag, value in zip(tags, values, strict=True):
        builder.add_arg(value, tag)
    return builder.build()


def bone(name: str, *numbers: float, tags: str = "sfffffff") -> OscMessage:
    """A Bone/Pos: position and quaternion, by default complete and of the right types."""
    return message(BONE, tags, name, *numbers)


def bundle(messages: Sequence[OscMessage]) -> bytes:
    """One bundle of them."""
    builder = OscBundleBuilder(IMMEDIATELY)
    for one in messages:
        builder.add_content(one)
    return bytes(builder.build().dgram)
