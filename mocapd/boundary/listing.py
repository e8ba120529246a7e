"""Lists a user's folder without hidden files and those that operating systems add."""

from pathlib import Path

from mocapd.boundary.files import is_folder
from mocapd.errors import InputError

# In addition to names with a leading dot: macOS leaves `._NAME` beside each file on a stick, and .DS_Store.
_LEFT_BY_SYSTEMS = frozenset(
    {
        *("thumbs.db", "ehthumbs.db", "desktop.ini", "$recycle.bin", "system volume information"),
        *("__macosx", "icon\r", "@eadir", "lost+found"),
    }
)


def is_shown(path: Path) -> bool:
    """True if a file manager would show this name."""
    return not path.name.startswith(".") and path.name.lower() not in _LEFT_BY_SYSTEMS


def shown_in(folder: Path) -> list[Path]:
    """Visible files and folders of a folder, by name; empty for anything else. Raises InputError without permission."""
    try:
        return sorted(filter(is_shown, folder.iterdir())) if is_folder(folder) else []
    except OSError as error:
        raise InputError(
            f"cannot be listed ({error.strerror})", str(folder), "check its rights"
        ) from None
