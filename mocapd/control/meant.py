"""Which of the running processes a command is meant for."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol, TypeVar

from mocapd.config.runtime_folder import folders_to_look_in
from mocapd.control.control_client import Found, RunningDaemon, running_daemons
from mocapd.errors import ConfigError, PermissionDeniedError, UnavailableError
from mocapd.outputs.instance import chunk

if TYPE_CHECKING:
    from mocapd.config.sections import Config


class Named(Protocol):
    """What processes are told apart by."""

    @property
    def instance(self) -> str: ...

    @property
    def state_dir(self) -> str: ...


N = TypeVar("N", bound=Named)


def meant(found: Sequence[N], config: "Config") -> Sequence[N]:
    """Of several those of this configuration: by its instance, then by its state directory."""
    if len(found) > 1 and config.instance:
        found = [one for one in found if one.instance == chunk(config.instance)] or found
    if len(found) > 1:
        own = str(config.state_dir.resolve())
        found = [one for one in found if one.state_dir == own] or found
    return found


def daemons_found(config: "Config") -> Found:
    """Every daemon that this user may ask."""
    return running_daemons(folders_to_look_in(config.state_dir))


def daemon_meant(config: "Config") -> RunningDaemon:
    """The one that a command is meant for. Raises MocapdError."""
    found = daemons_found(config)
    chosen = meant(found.daemons, config)
    if not chosen:
        raise why_none(found)
    if len(chosen) > 1:
        names = ", ".join(f"{one.instance} (pid {one.status.pid})" for one in chosen)
        raise ConfigError(
            f"several are running: {names}", "command line", "choose by --set instance=NAME"
        )
    return chosen[0]


def why_none(found: Found) -> UnavailableError | PermissionDeniedError:
    """What to say when nobody answers."""
    if found.silent:
        return UnavailableError(
            "runs, but does not answer", str(found.silent[0]), "see its log, or start it anew"
        )
    if found.foreign:
        return PermissionDeniedError(
            "a daemon of another user is running", str(found.foreign[0]), "ask with sudo"
        )
    return UnavailableError(
        "no mocapd of yours is running", "this machine", "start it: `mocapd run`"
    )
