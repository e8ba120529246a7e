"""Encodes JSON for the page: numpy numbers, and addresses without their passwords."""

from typing import Any

import msgspec
import numpy as np

from mocapd.boundary.urls import without_passwords


def as_json(message: object) -> bytes:
    """JSON; NaN becomes null. Numbers may be numpy's: steps and metrics compute with them.

    Any of its texts may hold a camera's address: a name, a source or an error message.
    """
    encoded = msgspec.json.encode(message, enc_hook=_plain)
    if b"://" not in encoded:
        return encoded
    return msgspec.json.encode(_mask_passwords(msgspec.json.decode(encoded)))


def _plain(value: object) -> object:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"a {type(value).__name__} is no JSON")


def _mask_passwords(tree: Any) -> Any:
    if isinstance(tree, str):
        return without_passwords(tree)
    if isinstance(tree, list):
        return [_mask_passwords(item) for item in tree]
    if isinstance(tree, dict):
        return {without_passwords(name): _mask_passwords(item) for name, item in tree.items()}
    return tree
