"""Selects the running process that a command addresses."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol, TypeVar

from mocapd.config.runtime_folder import folders_to_look_in
from mocapd.control.control_client import FoundDaemons, RunningDaemon, running_daemons
from mocapd.errors import ConfigError, PermissionDeniedError, UnavailableError
from mocapd.outputs.instance import chunk

if TYPE_CHECKING:
    from mocapd.config.effective import Effective
    from mocapd.config.sections import Config


class Addressable(Protocol):
    """The identification of a process."""

    @property
    def instance(self) -> str: ...

    @property
    def state_dir(self) -> str: ...


P = TypeVar("P", bound=Addressable)


def select_targets(processes: Sequence[P], effective: "Effective") -> Sequence[P]:
    """Those with the instance of the command line; else of several processes those of this configuration: by instance,
    then by state directory."""
    config = effective.config
    if config.instance and (len(processes) > 1 or effective.chosen_instance):
        instance = chunk(config.instance)
        named = [p for p in processes if p.instance == instance]
        processes = named if named or effective.chosen_instance else processes
    if len(processes) > 1:
        state_dir = str(config.state_dir.resolve())
        processes = [p for p in processes if p.state_dir == state_dir] or processes
    return processes


def find_daemons(config: "Config") -> FoundDaemons:
    """Finds the daemons that this user may command."""
    return running_daemons(folders_to_look_in(config.state_dir))


def target_daemon(effective: "Effective") -> RunningDaemon:
    """The daemon that a command addresses. Raises MocapdError."""
    config = effective.config
    search = find_daemons(config)
    chosen = select_targets(search.daemons, effective)
    # that of this configuration may be the one that does not answer: a hung one of several services
    if not chosen or (search.silent and not any(_is_of(config, daemon) for daemon in chosen)):
        raise no_daemon_error(search, config)
    if len(chosen) > 1:
        names = ", ".join(f"{daemon.instance} (pid {daemon.status.pid})" for daemon in chosen)
        raise ConfigError(
            f"several are running: {names}", "command line", "choose by --set instance=NAME"
        )
    return chosen[0]


def _is_of(config: "Config", process: Addressable) -> bool:
    """Whether the process has the instance or the state directory of this configuration."""
    is_named = bool(config.instance) and process.instance == chunk(config.instance)
    return is_named or process.state_dir == str(config.state_dir.resolve())


def no_daemon_error(
    search: FoundDaemons, config: "Config"
) -> UnavailableError | PermissionDeniedError:
    """The error when no addressed daemon answers."""
    if search.silent:
        return UnavailableError(
            "runs, but does not answer", str(search.silent[0]), "see its log, or restart it"
        )
    if search.foreign:
        return PermissionDeniedError(
            "a daemon of another user is running", str(search.foreign[0]), "ask with sudo"
        )
    if search.daemons:
        return other_name_error(config.instance, search.daemons)
    return UnavailableError(
        "no mocapd of yours is running", "this machine", "start it: `mocapd run`"
    )


def other_name_error(instance: str, running: Sequence[Addressable]) -> UnavailableError:
    """The error when the named process is not among those that are running."""
    names = ", ".join(process.instance or "a setup without a name" for process in running)
    return UnavailableError(
        f"no mocapd of yours named {instance!r} is running",
        "command line",
        f"choose one that is: {names}",
    )
