"""A page's text or plot, written with the folder that it is for."""

from pathlib import Path

from mocapd.errors import CannotCreateError, mend_of
from mocapd.output_file import PNG, OutputFile, kind_by_first_line


def write_out(path: Path, data: str | bytes, force: bool = False) -> None:
    """A page, in place of an earlier one with its title, or a PNG. Raises CannotCreateError."""
    kind = PNG if isinstance(data, bytes) else kind_by_first_line("this page", data)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CannotCreateError(
            f"cannot be written ({error.strerror})",
            str(path),
            mend_of(error, "choose another folder with --out"),
        ) from None
    with OutputFile(path, kind, force).writing() as partial:
        partial.write_bytes(data.encode() if isinstance(data, str) else data)
