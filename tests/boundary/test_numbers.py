"""Numbers from outside are in range or refused, however they are written."""

import math

import pytest

from mocapd.boundary import numbers
from mocapd.errors import MalformedError


@pytest.mark.parametrize(
    "value",
    [10**400, -(10**5000), math.nan, math.inf, True, None, "1.8", [], {}, 0.79, 2.51],
    ids=range(11),  # pytest would write the numbers out
)
def test_what_is_no_number_in_range_is_refused(value: object) -> None:
    with pytest.raises(MalformedError) as told:
        numbers.finite_number(value, 0.8, 2.5)
    assert len(str(told.value)) < 200


@pytest.mark.parametrize("value", [0.8, 1, 2.5])
def test_a_number_in_range_is_itself(value: float) -> None:
    assert numbers.finite_number(value, 0.8, 2.5) == value


def test_whole_numbers() -> None:
    assert numbers.whole_number(3.0, 0, 5) == 3
    with pytest.raises(MalformedError):
        numbers.whole_number(3.5, 0, 5)


@pytest.mark.parametrize("text", ["", "-1", "1e3", "²", "9" * 5000, "11", "1_0"])
def test_text_that_is_no_number_in_range_is_refused(text: str) -> None:
    with pytest.raises(MalformedError):
        numbers.whole_number_of_text(text, 0, 10)


def test_digits_are_a_number() -> None:
    assert numbers.whole_number_of_text(" 10 ", 0, 10) == 10


@pytest.mark.parametrize(
    ("tree", "message"),
    [
        ({"a": [{"b": float("nan")}]}, r"'a\[0\]\.b' is not finite"),
        ([1.0, float("-inf")], r"'\[1\]' is not finite"),
        ({"a": 10**12}, "'a' is far too large"),
        ({"a": -1e300}, "'a' is far too large"),
        ({"a": 1 << 100_000}, "'a' is far too large"),  # hexadecimal: more digits than print
    ],
)
def test_a_number_that_would_overflow_is_named_by_its_key(tree: object, message: str) -> None:
    with pytest.raises(MalformedError, match=message):
        numbers.check_numbers(tree)


def test_numbers_of_a_usual_size_are_let_through() -> None:
    numbers.check_numbers({"a": [1, 2.5, True, None, "1e400"], "b": {"c": -(2**31) + 1}})
