"""`mocapd install-service` and `mocapd uninstall-service`"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from mocapd.app.install.installing import InstallStep

UserOption = Annotated[
    bool, typer.Option("--user", help="A service of your own, which runs while you are logged in.")
]
DryRunOption = Annotated[
    bool, typer.Option("--dry-run", help="Change nothing, only say what would be done.")
]
RootOption = Annotated[
    Path | None,
    typer.Option(
        "--root",
        help="Put a package's files below this folder, into usr/lib and etc.",
        metavar="DIR",
    ),
]


def install_service(
    user: UserOption = False,
    dry_run: DryRunOption = False,
    root: RootOption = None,
    python: Annotated[
        Path | None,
        typer.Option(
            "--python", help="With --root: the interpreter that the units start.", metavar="PATH"
        ),
    ] = None,
) -> None:
    """Have systemd run mocapd: put its units and its user in place.

    Says what was done and what to run next; starts nothing by itself. Files that you have changed stay as they are,
    and so does your configuration.

    Example: sudo /opt/mocapd/bin/mocapd install-service
    """
    from mocapd.app.install.installing import (
        InstallTarget,
        changed_files_hint,
        hidden_hint,
        install,
        next_steps,
    )

    target = InstallTarget(user, root, python, dry_run)
    done = install(target)
    _print(done, dry_run)
    _print_hint(changed_files_hint(done))
    _print_hint(hidden_hint(target))
    steps = next_steps(target, done)
    if steps:
        print("\nnext:")
        for step in steps:
            print(f"  {step}")


def uninstall_service(
    user: UserOption = False, dry_run: DryRunOption = False, root: RootOption = None
) -> None:
    """Take away what install-service has put in place, unless it was changed since.

    The configuration and the calibration stay; it says where they are.

    Example: sudo /opt/mocapd/bin/mocapd uninstall-service
    """
    from mocapd.app.install.installing import (
        InstallTarget,
        steps_after,
        uninstall,
        what_stays,
    )

    target = InstallTarget(user, root, None, dry_run)
    _print(uninstall(target), dry_run)
    stays = what_stays(target)
    if stays:
        print(f"left, to be removed by hand: {' '.join(map(str, stays))}")
    for step in steps_after(target):
        print(f"\nnext:\n  {step}")


def _print(done: "list[InstallStep]", dry_run: bool) -> None:
    width = max(len(str(one.path)) for one in done)
    if dry_run:
        print("nothing is changed; it would be:")
    for one in done:
        print(f"{one.path!s:<{width}}  {_outcome(one)}")


def _outcome(one: "InstallStep") -> str:
    from mocapd.app.install.own_file import Outcome

    if one.is_admins and one.outcome is Outcome.UNCHANGED:
        return "yours, left alone"
    return one.outcome.value


def _print_hint(hint: str) -> None:
    if hint:
        typer.echo(f"mocapd: {hint}", err=True)
