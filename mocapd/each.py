"""What is done with each of several things, one after the other unless who makes the tracker brings threads.

The numeric core starts none of its own. Whatever is done with one thing touches nothing of another's: the result is the same,
bit by bit, in whatever order.
"""

from collections.abc import Callable, Iterable
from typing import Protocol, TypeVar

T = TypeVar("T")
R = TypeVar("R")


class Each(Protocol):
    """The results of `work`, in order; it returns, or raises what one of them raised, when all are done."""

    def __call__(self, work: Callable[[T], R], of: Iterable[T]) -> list[R]:
        """See Each."""
        ...


def in_turn(work: Callable[[T], R], of: Iterable[T]) -> list[R]:
    """See Each."""
    return [work(one) for one in of]
