"""Grades of a result by two limits."""

from enum import StrEnum


class Grade(StrEnum):
    """How reliable a result is."""

    GOOD = "good"
    DOUBTFUL = "doubtful"
    BAD = "bad"


def grade(value: float, good: float, bad: float) -> Grade:
    """GOOD up to `good`, DOUBTFUL up to `bad`, BAD beyond and for NaN."""
    if value <= good:
        return Grade.GOOD
    return Grade.DOUBTFUL if value <= bad else Grade.BAD
