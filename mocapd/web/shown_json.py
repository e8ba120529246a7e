"""JSON that leaves the process: numbers as the steps compute them, addresses without their passwords."""

from typing import Any

import msgspec
import numpy as np

from mocapd.boundary.urls import without_passwords


def as_json(message: object) -> bytes:
    """JSON; NaN becomes null. Numbers may be numpy's: steps and metrics compute with them.

    A camera's address may be in any of its texts, as a name, a source or the words of an error.
    """
    encoded = msgspec.json.encode(message, enc_hook=_plain)
    if b"://" not in encoded:
        return encoded
    return msgspec.json.encode(_masked(msgspec.json.decode(encoded)))


def _plain(value: object) -> object:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"a {type(value).__name__} is no JSON")


def _masked(tree: Any) -> Any:
    if isinstance(tree, str):
        return without_passwords(tree)
    if isinstance(tree, list):
        return [_masked(one) for one in tree]
    if isinstance(tree, dict):
        return {without_passwords(name): _masked(one) for name, one in tree.items()}
    return tree
