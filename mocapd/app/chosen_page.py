"""Which of this user's running processes a command is meant for."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mocapd.outputs.instance import chunk

if TYPE_CHECKING:
    from mocapd.config.sections import Config
    from mocapd.web.runtime_file import Running


def pages_meant(pages: "Sequence[Running]", config: "Config") -> "Sequence[Running]":
    """Of several those of this configuration: by its instance, then by its state directory."""
    if len(pages) > 1 and config.instance:
        named = [page for page in pages if page.instance == chunk(config.instance)]
        pages = named or pages
    if len(pages) > 1:
        own = str(config.state_dir.resolve())
        beside = [page for page in pages if page.state_dir == own]
        pages = beside or pages
    return pages
