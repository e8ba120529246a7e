"""The service put in place and taken away: what is done to which file, and what is to be run next."""

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
    """What is installed for. `user`: a unit of this user alone; `root`: a package that is built there, whose
    units start `python`, this interpreter when None; `dry_run`: nothing is changed."""

    user: bool = False
    root: Path | None = None
    python: Path | None = None
    dry_run: bool = False

    def places(self) -> InstallPaths:
        """Where the files go."""
        if self.root is not None:
            return of_package(self.root)
        return of_user() if self.user else of_machine()


@dataclass(frozen=True, slots=True)
class InstallStep:
    """What became, or would become, of one file."""

    path: Path
    outcome: Outcome
    is_admins: bool


def install(target: InstallTarget, euid: int | None = None) -> list[InstallStep]:
    """Put everything in place. Raises ConfigError, UsageError, PermissionDeniedError or CannotCreateError."""
    _require_sense(target, os.geteuid() if euid is None else euid)
    python = target.python or interpreter.own()
    if target.root is None and not target.user:
        interpreter.require_visible(interpreter.needed(python))
    # all texts before the first file, so that what is refused leaves nothing half done
    wanted = list(files(target.places(), python))
    return [_done(one, _put(one, target.dry_run)) for one in wanted]


def uninstall(target: InstallTarget, euid: int | None = None) -> list[InstallStep]:
    """Take away what nobody has changed; the admin's own stays. Raises as `install`, ConfigError also while the
    service is enabled."""
    _require_sense(target, os.geteuid() if euid is None else euid)
    places = target.places()
    enabled = [*_enabled(places)]
    if enabled and target.root is None:
        flag = " --user" if target.user else ""
        units = " ".join(sorted({path.name for path in enabled}))
        raise ConfigError(
            "the service is enabled", str(enabled[0]), f"`systemctl{flag} disable --now {units}`"
        )
    # which interpreter they start does not matter here
    mine = [one for one in files(places, Path("/python")) if not one.is_admins]
    done = [_done(one, take_away(one.path, target.dry_run)) for one in mine]
    if places.examples is not None and not target.dry_run:
        _remove_empty(places.examples)
    return done


def next_steps(target: InstallTarget, done: list[InstallStep]) -> list[str]:
    """The commands that an installation is to be followed by, each with a word on it; none after one for a package."""
    if target.root is not None:
        return []
    news = {Outcome.MADE, Outcome.RENEWED}
    changed = {one.path.suffix for one in done if one.outcome in news}
    if target.user:
        steps = ["systemctl --user daemon-reload"] if changed else []
        return [
            *steps,
            "systemctl --user enable --now mocapd   # start it, now and whenever you log in",
            "loginctl enable-linger                 # only if it shall run without you",
            "journalctl --user -u mocapd -f         # what it says",
        ]
    steps = ["systemd-sysusers"] if ".conf" in changed else []
    if ".rules" in changed:
        steps.append("udevadm control --reload && udevadm trigger --subsystem-match=usb")
    steps += ["systemctl daemon-reload"] if ".service" in changed else []
    made = [one.path for one in done if one.is_admins and one.outcome is Outcome.MADE]
    if gid_of(SERVICE_GROUPS[0]) is None:  # systemd-sysusers makes it
        steps += [f"chgrp {SERVICE_GROUPS[0]} {path}" for path in made]
    return [
        *steps,
        "mocapd cameras                     # the names of the cameras, for /etc/mocapd/config.toml",
        "systemctl enable --now mocapd      # start it, now and at every boot",
        "journalctl -u mocapd -f            # what it says",
    ]


def steps_after(target: InstallTarget) -> list[str]:
    """What is to be run when the files are gone."""
    if target.root is not None:
        return []
    return [f"systemctl{' --user' if target.user else ''} daemon-reload"]


def what_stays(target: InstallTarget) -> list[Path]:
    """What an uninstallation leaves: it is the admin's, or cannot be made again."""
    if target.user or target.root is not None:
        return []
    stays = (
        *("/etc/mocapd", "/var/lib/mocapd", "/var/lib/mocapd-rigs"),
        *("/var/cache/mocapd", "/var/cache/mocapd-node"),
    )
    there = [path for path in map(Path, stays) if path.exists()]
    # what a service of a user made for it keeps is elsewhere, with a link to it
    return [*dict.fromkeys(one for path in there for one in (path, path.resolve()))]


def hidden_hint(target: InstallTarget, system: Path = Path("/")) -> str:
    """What to say of files of a package, below `system`, in whose place ours are read; empty when there are none."""
    if target.root is not None:
        return ""
    mine = {_way(one.path) for one in files(target.places(), Path("/python")) if not one.is_admins}
    theirs = [one.path for one in files(of_package(system), Path("/python"))]
    hidden = [path for path in theirs if _way(path) in mine and path.exists()]
    if not hidden:
        return ""
    flag, sudo = (" --user", "") if target.user else ("", "sudo ")
    return (
        f"a package has installed mocapd here too: what is put in place here hides {', '.join(map(str, hidden))}, and so"
        f" the package's updates; to run the package's: `{sudo}systemctl{flag} disable --now mocapd;"
        f" {sudo}mocapd uninstall-service{flag}; {sudo}systemctl{flag} daemon-reload;"
        f" {sudo}systemctl{flag} enable --now mocapd`"
    )


def _way(path: Path) -> tuple[str, str]:
    """What is the same of a file in /etc and of the one in /usr/lib that it hides."""
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


def _put(one: PlacedFile, dry_run: bool) -> Outcome:
    if one.is_admins:
        return put_once(one.path, one.text, dry_run, SERVICE_GROUPS[0])
    return put(one.path, one.text, dry_run)


def _done(one: PlacedFile, outcome: Outcome) -> InstallStep:
    return InstallStep(one.path, outcome, one.is_admins)


def _enabled(places: InstallPaths) -> Iterator[Path]:
    for folder in (places.units, places.user_units):
        if folder is not None:
            yield from folder.glob(_WANTS)


def _remove_empty(folder: Path) -> None:
    """A folder of drop-ins that was made for the example, unless it has others."""
    if folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()


def kept_hint(done: list[InstallStep]) -> str:
    """What to do about files that were changed by hand; empty when there are none."""
    kept = [one for one in done if one.outcome is Outcome.KEPT]
    if not kept:
        return ""
    return (
        f"changed by hand: {', '.join(str(one.path) for one in kept)}. What this version would have written is beside"
        f" it, as {NEW}: move your changes into a drop-in, and that file over this one"
    )
