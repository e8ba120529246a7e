"""The extras of the package: libraries that only some commands need, and how a user adds one."""

import shlex
import sys
from importlib.util import find_spec
from pathlib import Path

from mocapd.errors import MissingExtraError

# By extra its library, on PyPI and in an import of one name. The base holds what the daemon, its page, `calibrate`, `watch`
# and `doctor` run on. Only `board` and `shirt` print, once and on any machine: the page needs no PDF.
EXTRAS = {"print": "reportlab", "plots": "matplotlib", "vrchat": "zeroconf"}


def has_extra(extra: str) -> bool:
    """Whether the library of this extra is installed."""
    return find_spec(EXTRAS[extra]) is not None


def require_extra(extra: str, where: str, otherwise: str = "") -> None:
    """`where`: the command or key that needs it; `otherwise`: what else a user may do.

    Raises MissingExtraError, which names the command that installs it.
    """
    if not has_extra(extra):
        raise MissingExtraError(
            f"needs {EXTRAS[extra]}, the extra mocapd[{extra}], which is not installed",
            where,
            f"install it: {install_command(extra)}{otherwise and f', or {otherwise}'}",
        )


def reinstall_command() -> str:
    """The command that reinstalls this mocapd, from the wheel that `make dist` builds in a checkout."""
    wheel, prefix = "dist/mocapd-*.whl", Path(sys.prefix)
    if (prefix / "pipx_metadata.json").is_file():
        return f"pipx install --force {wheel}"
    python = shlex.quote(sys.executable)
    if find_spec("pip") is None:
        return f"{_uv()} pip install --python {python} --reinstall {wheel}"
    return f"{python} -m pip install --force-reinstall {wheel}"


def install_command(extra: str) -> str:
    """The shell command that adds the library to the environment of this mocapd.

    It names the library: mocapd itself is in no package index, and may come from a wheel that is gone.
    """
    library, prefix = EXTRAS[extra], Path(sys.prefix)
    python = shlex.quote(sys.executable)
    if (prefix / "pipx_metadata.json").is_file():
        return f"pipx inject {shlex.quote(prefix.name)} {library}"
    if find_spec("pip") is None:
        return f"{_uv()} pip install --python {python} {library}"
    return f"{python} -m pip install {library}"


def _uv() -> str:
    """The command uv: of this environment, which `make env` makes with it, or the user's own."""
    return f"{shlex.quote(sys.executable)} -m uv" if find_spec("uv") is not None else "uv"
