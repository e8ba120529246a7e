"""The map over cameras of the numeric core: sequential, unless the caller supplies one with threads.

The numeric core starts no threads. The work on each item is independent, so results are bitwise equal in any order.
"""

from collections.abc import Callable, Iterable
from typing import Protocol, TypeVar

T = TypeVar("T")
R = TypeVar("R")


class Each(Protocol):
    """Maps `work` over items; results in order. Returns, or raises an exception of the work, when all items are done."""

    def __call__(self, work: Callable[[T], R], of: Iterable[T]) -> list[R]:
        """See Each."""
        ...


def in_turn(work: Callable[[T], R], of: Iterable[T]) -> list[R]:
    """See Each."""
    return [work(item) for item in of]
