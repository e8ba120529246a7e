"""Diagnoses why cameras do not see the board, in a job, for cameras without a sighting for a while."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from mocapd.calibrate.board.board_detection import (
    BoardDetector,
    DetectionFailure,
    Reason,
    settle_variant,
)
from mocapd.calibrate.board.board_instant import BoardInstant
from mocapd.calibrate.board.detection_diagnostics import (
    FIX,
    TELLING,
    diagnose_detection,
    most_telling,
)
from mocapd.calibration.board_spec import BoardSpec
from mocapd.errors import Problem
from mocapd.types import Frame
from mocapd.wizard.context import Context
from mocapd.wizard.step import Tell

_BLIND_NS = 2_000_000_000  # without the board, before a diagnosis
_PAUSE_NS = 1_500_000_000  # between two diagnoses
_FORGET_NS = 6_000_000_000  # a diagnosis expires after this time
_REMEMBER_NS = 15_000_000_000  # or this, if it names another object in the picture
_FORM = "set the board above as it was printed"
_LIVE_FIX = {
    **FIX,
    Reason.OTHER_SIZE: f"{_FORM}: its numbers of columns and rows count squares",
    Reason.OTHER_DICTIONARY: f"{_FORM}: another dictionary of markers",
    Reason.OTHER_KIND: f"{_FORM}: the kind of board",
    Reason.MIRRORED: "switch mirroring off in the camera, then go on; if it is the mirrored back of a board "
    "printed on both sides, say so in its form above",
    Reason.NOTHING: "show the board to this camera",
}


@dataclass(frozen=True, slots=True)
class _Diagnosis:
    answer: DetectionFailure
    t_ns: int


class BoardAdvice:
    """Holds the time of each camera's last sighting, and the last diagnosis of each camera without one."""

    def __init__(self, context: Context, changed: Callable[[BoardSpec], None]) -> None:
        """`changed`: called when the pictures show another variant of the board."""
        self._context, self._changed = context, changed
        self._saw_ns: dict[str, int] = {}
        self._asked_ns: dict[str, int] = {}
        self._diagnoses: dict[str, _Diagnosis] = {}
        self._begun_ns: int | None = None
        self._free_ns = 0

    def take(self, instant: BoardInstant) -> None:
        """Note the cameras that see the board."""
        for name in instant.observations:
            self._saw_ns[name] = instant.t_ns
            self._diagnoses.pop(name, None)

    def forget(self) -> None:
        """Reset for another board."""
        self._diagnoses = {}
        self._asked_ns = {}

    def ask(self, now_ns: int, frames: Mapping[str, Frame], spec: BoardSpec) -> None:
        """Start a job for the blind camera with the oldest diagnosis, when it is due."""
        if self._begun_ns is None:
            self._begun_ns = now_ns
        begun_ns = self._begun_ns
        blind = [name for name in frames if now_ns - self._saw_ns.get(name, begun_ns) > _BLIND_NS]
        if not blind or self._context.job is not None or now_ns < self._free_ns:
            return
        name = min(blind, key=lambda camera: self._asked_ns.get(camera, 0))
        self._asked_ns[name] = now_ns
        self._free_ns = now_ns + _PAUSE_NS
        # try every variant only while no camera sees the board as given
        unseen = not self._saw_ns
        pixels = frames[name].pixels

        def answer(_report: Tell) -> tuple[BoardSpec, DetectionFailure | None]:
            settled = settle_variant(spec, [pixels]) if unseen else spec
            detector = BoardDetector(settled)
            if settled != spec or detector.find(pixels) is not None:
                return settled, None
            return spec, diagnose_detection(detector, np.ascontiguousarray(pixels))

        def done(result: tuple[BoardSpec, DetectionFailure | None]) -> None:
            settled, failure = result
            if settled != spec:
                self._changed(settled)
            elif failure is not None:
                self._keep(name, _Diagnosis(failure, now_ns))

        self._context.start_job(answer, done)

    def _keep(self, name: str, diagnosis: _Diagnosis) -> None:
        """Replace the last diagnosis, unless that one said more and has not expired."""
        before = self._diagnoses.get(name)
        if before is not None and diagnosis.t_ns - before.t_ns <= _longest_ns(before):
            answers = (diagnosis.answer, before.answer)
            if most_telling(answers) is before.answer and before.answer.reason in TELLING:
                return
        self._diagnoses[name] = diagnosis

    def problems(self, now_ns: int, wanted: Mapping[str, bool]) -> Iterator[Problem]:
        """Of cameras that are `wanted` to see the board and do not.

        No problem while another camera sees it.
        """
        anyone = any(now_ns - t_ns < _BLIND_NS for t_ns in self._saw_ns.values())
        for name, diagnosis in self._diagnoses.items():
            reason = diagnosis.answer.reason
            if not wanted.get(name, False) or now_ns - diagnosis.t_ns > _longest_ns(diagnosis):
                continue
            if reason is Reason.NOTHING and anyone:
                continue
            detail = diagnosis.answer.detail
            what = f"{reason}" + (f": {detail}" if detail else "")
            yield Problem(what, name, _LIVE_FIX[reason])


def _longest_ns(diagnosis: _Diagnosis) -> int:
    """Lifetime of a diagnosis."""
    return _REMEMBER_NS if diagnosis.answer.reason in TELLING else _FORGET_NS
