"""The body of an HTTP answer of somebody who is not trusted, read by Python's own client."""

from http.client import HTTPException
from typing import Protocol


class _Answer(Protocol):
    def read(self, most: int, /) -> bytes:
        """At most so many bytes."""
        ...


def read_body(answer: _Answer, most: int) -> bytes:
    """At most so many bytes of it. Raises OSError or HTTPException."""
    try:
        return answer.read(most)
    except (ValueError, OverflowError) as error:
        # the client believes the length that a chunk says: fewer than no bytes, or more than can be asked for
        raise HTTPException(f"a chunk of a length that cannot be ({error})") from None
