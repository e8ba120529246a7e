"""What a folder of the user's holds, without the files that other systems leave in it and do not show."""

from pathlib import Path

from mocapd.boundary.files import is_folder
from mocapd.errors import InputError

# Beside names that begin with a dot: macOS leaves `._NAME` beside each file on a stick, and .DS_Store.
_LEFT_BY_SYSTEMS = frozenset(
    {
        *("thumbs.db", "ehthumbs.db", "desktop.ini", "$recycle.bin", "system volume information"),
        *("__macosx", "icon\r", "@eadir", "lost+found"),
    }
)


def is_shown(path: Path) -> bool:
    """Whether a file manager shows a file or folder of this name."""
    return not path.name.startswith(".") and path.name.lower() not in _LEFT_BY_SYSTEMS


def shown_in(folder: Path) -> list[Path]:
    """Files and folders of a folder, by name; none where it is no folder. Raises InputError where it may not be read."""
    try:
        return sorted(filter(is_shown, folder.iterdir())) if is_folder(folder) else []
    except OSError as error:
        raise InputError(
            f"cannot be listed ({error.strerror})", str(folder), "check its rights"
        ) from None
