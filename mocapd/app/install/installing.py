"""Installs and removes the service: steps for each file, and the commands that follow."""

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mocapd.app.install import interpreter
from mocapd.app.install.own_file import NEW, Outcome, gid_of, put, put_once, take_away
from mocapd.app.install.places import (
    InstallPaths,
    PlacedFile,
    files,
    of_machine,
    of_package,
    of_user,
)
from mocapd.boundary.secret_files import SERVICE_GROUPS
from mocapd.errors import ConfigError, PermissionDeniedError, UsageError

_WANTS = "*.wants/mocapd*.service"  # of an enabled unit


@dataclass(frozen=True, slots=True)
class InstallTarget:
    """Target of an installation. `user`: a unit of this user only; `root`: folder of a package build, whose units start
    `python`, this interpreter when None; `dry_run`: changes nothing."""

    user: bool = False
    root: Path | None = None
    python: Path | None = None
    dry_run: bool = False

    def places(self) -> InstallPaths:
        """The target folders."""
        if self.root is not None:
            return of_package(self.root)
        return of_user() if self.user else of_machine()


@dataclass(frozen=True, slots=True)
class InstallStep:
    """The outcome for one file."""

    path: Path
    outcome: Outcome
    is_admins: bool


def install(target: InstallTarget, euid: int | None = None) -> list[InstallStep]:
    """Installs all files. Raises ConfigError, UsageError, PermissionDeniedError or CannotCreateError."""
    _require_sense(target, os.geteuid() if euid is None else euid)
    python = target.python or interpreter.own()
    if target.root is None and not target.user:
        interpreter.require_visible(interpreter.required_paths(python))
    # render all texts first: an error then leaves no partial installation
    wanted = list(files(target.places(), python))
    return [_step_of(file, _put(file, target.dry_run)) for file in wanted]


def uninstall(target: InstallTarget, euid: int | None = None) -> list[InstallStep]:
    """Removes unchanged files; the admin's own stay. Raises as `install`, ConfigError also while the service is
    enabled."""
    _require_sense(target, os.geteuid() if euid is None else euid)
    places = target.places()
    enabled = [*_enabled_units(places)]
    if enabled and target.root is None:
        flag = " --user" if target.user else ""
        units = " ".join(sorted({path.name for path in enabled}))
        raise ConfigError(
            "the service is enabled", str(enabled[0]), f"`systemctl{flag} disable --now {units}`"
        )
    # the interpreter's path does not matter here
    mine = [file for file in files(places, Path("/python")) if not file.is_admins]
    done = [_step_of(file, take_away(file.path, target.dry_run)) for file in mine]
    if places.examples is not None and not target.dry_run:
        _remove_empty(places.examples)
    return done


def next_steps(target: InstallTarget, done: list[InstallStep]) -> list[str]:
    """The commands to run after an installation, with comments; none for a package."""
    if target.root is not None:
        return []
    news = {Outcome.MADE, Outcome.RENEWED}
    changed = {step.path.suffix for step in done if step.outcome in news}
    if target.user:
        steps = ["systemctl --user daemon-reload"] if changed else []
        return [
            *steps,
            "systemctl --user enable --now mocapd   # start it, now and whenever you log in",
            "loginctl enable-linger                 # only if it shall run without you",
            "journalctl --user -u mocapd -f         # what it says",
        ]
    steps = ["systemd-sysusers"] if ".conf" in changed else []
    steps += ["systemctl daemon-reload"] if ".service" in changed else []
    made = [step.path for step in done if step.is_admins and step.outcome is Outcome.MADE]
    if gid_of(SERVICE_GROUPS[0]) is None:  # systemd-sysusers makes it
        steps += [f"chgrp {SERVICE_GROUPS[0]} {path}" for path in made]
    return [
        *steps,
        "mocapd cameras                     # the names of the cameras, for /etc/mocapd/config.toml",
        "systemctl enable --now mocapd      # start it, now and at every boot",
        "journalctl -u mocapd -f            # what it says",
    ]


def steps_after(target: InstallTarget) -> list[str]:
    """The commands to run after an uninstallation."""
    if target.root is not None:
        return []
    return [f"systemctl{' --user' if target.user else ''} daemon-reload"]


def what_stays(target: InstallTarget) -> list[Path]:
    """Paths that an uninstallation leaves: the admin's, or irreplaceable."""
    if target.user or target.root is not None:
        return []
    stays = (
        *("/etc/mocapd", "/var/lib/mocapd", "/var/lib/mocapd-rigs"),
        *("/var/cache/mocapd", "/var/cache/mocapd-node"),
    )
    there = [path for path in map(Path, stays) if path.exists()]
    # systemd stores the state of a DynamicUser elsewhere, with a link to it
    return [*dict.fromkeys(p for path in there for p in (path, path.resolve()))]


def hidden_hint(target: InstallTarget, system: Path = Path("/")) -> str:
    """A hint about files of a package, below `system`, that ours hide; empty without such files."""
    if target.root is not None:
        return ""
    own_files = files(target.places(), Path("/python"))
    mine = {_unit_key(file.path) for file in own_files if not file.is_admins}
    theirs = [file.path for file in files(of_package(system), Path("/python"))]
    hidden = [path for path in theirs if _unit_key(path) in mine and path.exists()]
    if not hidden:
        return ""
    flag, sudo = (" --user", "") if target.user else ("", "sudo ")
    return (
        f"a package has installed mocapd here too: what is put in place here hides {', '.join(map(str, hidden))}, and so"
        f" the package's updates; to run the package's: `{sudo}systemctl{flag} disable --now mocapd;"
        f" {sudo}mocapd uninstall-service{flag}; {sudo}systemctl{flag} daemon-reload;"
        f" {sudo}systemctl{flag} enable --now mocapd`"
    )


def _unit_key(path: Path) -> tuple[str, str]:
    """The key that a file in /etc shares with the file in /usr/lib that it hides."""
    return path.parent.name, path.name


def _require_sense(target: InstallTarget, euid: int) -> None:
    if target.user and target.root is not None:
        raise UsageError(
            "--user and --root contradict each other",
            "command line",
            "a package (--root) has the unit for all users among its files",
        )
    if target.python is not None and target.root is None:
        raise UsageError(
            "--python is for packages, with --root",
            "command line",
            "run install-service by the mocapd that the service shall start",
        )
    if target.user and euid == 0 and os.environ.get("SUDO_USER"):
        raise UsageError(
            "under sudo, --user would make it root's own service",
            "command line",
            "run it as yourself, without sudo",
        )
    if not target.user and target.root is None and not target.dry_run and euid != 0:
        raise PermissionDeniedError(
            "only root may install a service for the machine",
            "/etc/systemd/system",
            "run it with sudo; or take --user for a service of your own, --dry-run to see what it would do",
        )


def _put(file: PlacedFile, dry_run: bool) -> Outcome:
    if file.is_admins:
        return put_once(file.path, file.text, dry_run, SERVICE_GROUPS[0])
    return put(file.path, file.text, dry_run)


def _step_of(file: PlacedFile, outcome: Outcome) -> InstallStep:
    return InstallStep(file.path, outcome, file.is_admins)


def _enabled_units(places: InstallPaths) -> Iterator[Path]:
    for folder in (places.units, places.user_units):
        if folder is not None:
            yield from folder.glob(_WANTS)


def _remove_empty(folder: Path) -> None:
    """Removes the folder of the example drop-in unless it has other files."""
    if folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()


def changed_files_hint(done: list[InstallStep]) -> str:
    """A hint about files that were changed by hand; empty without such files."""
    changed = [str(step.path) for step in done if step.outcome is Outcome.KEPT]
    if not changed:
        return ""
    return (
        f"changed by hand: {', '.join(changed)}. This version's file is in the same folder,"
        f" as {NEW}: move your changes into a drop-in, and that file over this one"
    )
