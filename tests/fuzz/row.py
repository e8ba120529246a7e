"""A row of the table: a parser, how many inputs it gets, and how one of them is made and handed in."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import TypeVar

from mocapd.errors import MocapdError

T = TypeVar("T")

# One input, made from `random` and handed to the parser; the number of the input is for those that go
# through a list. True: taken; False: answered with what is documented for "no", such as None. A
# MocapdError is a named error; whatever else is raised is what the fuzzers look for.
Attempt = Callable[[Random, int], bool]

_STRIDE = 7919  # a prime: every case once, and any beginning of a run is spread over all of them


class WrongError(AssertionError):
    """A parser took what it must not take, or let out what it must not."""


class DeadlyError(AssertionError):
    """Input ended a thread that only our own bugs may end."""

    def __init__(self, death: BaseException) -> None:
        super().__init__(f"ended by {type(death).__name__}: {death}"[:300])
        self.__cause__ = death


@dataclass(frozen=True, slots=True)
class Place:
    """folder: the row's own, empty; cache: where what takes long to make is kept from run to run."""

    folder: Path
    cache: Path


@dataclass(frozen=True, slots=True)
class Row:
    """`prepare` is called once in a process of its own, and hands a good input in to see that it is
    taken; inputs: at scale 1; is_slow: whether each takes so long that --inputs takes no more of them than that."""

    name: str
    inputs: int
    prepare: Callable[[Place], Attempt]
    is_slow: bool = False


def each_of(cases: Sequence[T], take: Callable[[T], bool]) -> Attempt:
    """Case after case."""

    def attempt(_random: Random, number: int) -> bool:
        return take(one_of(cases, number))

    return attempt


def one_of(cases: Sequence[T], number: int) -> T:
    """The case of this number."""
    return cases[number * _STRIDE % len(cases)]


def taken(parse: Callable[[], object]) -> bool:
    """Whether a parser took it; raises whatever it raises."""
    parse()
    return True


def named(parse: Callable[[], object]) -> bool:
    """The same, of one of several tries of one input: a named error is a no."""
    try:
        parse()
    except MocapdError:
        return False
    return True
