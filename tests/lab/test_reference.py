"""The pages about commands and configuration are those of the code."""

from lab.reference import commands_page, configuration_page
from tests.conftest import ROOT

RENEW = "renew it: python -m lab.reference docs"


def test_the_page_of_commands_is_up_to_date() -> None:
    assert (ROOT / "docs" / "commands.md").read_text() == commands_page(), RENEW


def test_the_page_of_keys_is_up_to_date() -> None:
    assert (ROOT / "docs" / "configuration.md").read_text() == configuration_page(), RENEW
