"""The answer to a refused request."""

from dataclasses import dataclass
from html import escape


@dataclass(frozen=True, slots=True)
class Refusal:
    """status: of HTTP; what: the reason, for display."""

    status: int
    what: str


def refusal_page(refusal: Refusal) -> str:
    """As HTML."""
    return (
        "<!doctype html><html lang=en><meta charset=utf-8>"
        "<meta name=viewport content='width=device-width'><title>mocapd</title>"
        f"<h1>Not let in</h1><p>{escape(refusal.what)}</p>"
        "<p>Open the whole address that <code>mocapd calibrate</code> printed in its terminal, "
        "on the machine where it runs.</p></html>"
    )
