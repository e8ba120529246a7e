"""The tests that docs/security.md names are there, and the page's limits are those of the code."""

import re
from pathlib import Path

import pytest

from mocapd.web.access import LONGEST_ADDRESS
from mocapd.web.answers import LONGEST_BODY
from mocapd.web.connections import REQUEST_S

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs/security.md").read_text()
NAMED = re.findall(r"`(tests/[\w/]+\.py)(?:::(\w+))?`", PAGE)


@pytest.mark.parametrize(("file", "test"), NAMED)
def test_a_test_that_the_page_names_is_there(file: str, test: str) -> None:
    text = (ROOT / file).read_text()
    assert not test or re.search(rf"def {test}\b", text)


def test_the_limits_of_a_request_are_told() -> None:
    body, address = LONGEST_BODY >> 10, LONGEST_ADDRESS >> 10
    assert f"complete within {REQUEST_S:g} s, body {body} KiB, address {address} KiB" in PAGE
