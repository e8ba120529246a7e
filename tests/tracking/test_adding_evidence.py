"""The page that shows how to add a term, a hypothesis, an initialiser and a cue: what it says runs."""

import re

import pytest

from tests.conftest import ROOT

pytestmark = pytest.mark.kernels


def test_the_code_of_the_page_runs_block_after_block() -> None:
    page = (ROOT / "docs" / "adding-evidence.md").read_text()
    blocks = re.findall(r"^```python\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    assert len(blocks) == 5
    names: dict[str, object] = {}
    for block in blocks:
        exec(block, names)
