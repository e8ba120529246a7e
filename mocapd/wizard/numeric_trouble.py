"""Converts solver errors on the user's input to named errors, which the user sees instead of a crash."""

import logging

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2
import numpy as np

from mocapd.errors import InputError, MocapdError

_log = logging.getLogger(__name__)

EXPECTED = (MocapdError, cv2.error, np.linalg.LinAlgError)
"""Expected exceptions of a step on bad input; any other one is a bug."""


def name_trouble(error: MocapdError | cv2.error | np.linalg.LinAlgError, where: str) -> MocapdError:
    """The error for the user. An exception without a name is logged with its origin."""
    if isinstance(error, MocapdError):
        return error
    _log.warning("in the step %s: %s", where, error, exc_info=error)
    return InputError(
        f"this cannot be worked out ({' '.join(str(error).split())[:200]})",
        where,
        "show, draw or type something else, or begin the step again",
    )
