"""Where solvers end on what a person drew, showed or typed: named, so that it is told and not deadly."""

import logging

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2
import numpy as np

from mocapd.errors import InputError, MocapdError

_log = logging.getLogger(__name__)

EXPECTED = (MocapdError, cv2.error, np.linalg.LinAlgError)
"""What a step may end in by what it is given; anything else is a bug of ours."""


def name_trouble(error: MocapdError | cv2.error | np.linalg.LinAlgError, where: str) -> MocapdError:
    """The error as people are told it. What has no name yet is logged with the place it came from."""
    if isinstance(error, MocapdError):
        return error
    _log.warning("in the step %s: %s", where, error, exc_info=error)
    return InputError(
        f"this cannot be worked out ({' '.join(str(error).split())[:200]})",
        where,
        "show, draw or type something else, or begin the step again",
    )
