"""A page's text or plot, written with the folder that it is for."""

from pathlib import Path

from mocapd.errors import CannotCreateError


def write_out(path: Path, data: bytes) -> None:
    """In place of what was there. Raises CannotCreateError."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    except OSError as error:
        raise CannotCreateError(
            f"cannot be written ({error.strerror})", str(path), "choose another folder with --out"
        ) from None
