"""Reads the body of an HTTP answer from an untrusted server, with Python's own client."""

from http.client import HTTPException
from typing import Protocol


class _Answer(Protocol):
    def read(self, most: int, /) -> bytes:
        """At most `most` bytes."""
        ...


def read_body(answer: _Answer, most: int) -> bytes:
    """At most `most` bytes of the body. Raises OSError or HTTPException."""
    try:
        return answer.read(most)
    except (ValueError, OverflowError) as error:
        # the client trusts the length of a chunk, which may be negative or too large for `read`
        raise HTTPException(f"a chunk has an impossible length ({error})") from None
