"""`mocapd completion`, and the answers to a shell's completion requests."""

import os
from enum import StrEnum
from typing import Annotated

import typer
from typer._completion_classes import completion_init
from typer._completion_shared import get_completion_script

VARIABLE = "_MOCAPD_COMPLETE"  # set by the shell's script; typer then prints completions and exits


Shell = StrEnum("Shell", ["bash", "zsh", "fish"])  # those that load completions from a file


def completion(shell: Annotated[Shell, typer.Argument(help="Which shell.")]) -> None:
    """Print the completion script of a shell.

    Save it for bash as ~/.local/share/bash-completion/completions/mocapd, for zsh as _mocapd in a folder of $fpath, for
    fish as ~/.config/fish/completions/mocapd.fish.

    Example: mocapd completion bash > ~/.local/share/bash-completion/completions/mocapd
    """
    print(get_completion_script(prog_name="mocapd", complete_var=VARIABLE, shell=shell.value))


def ready_to_complete() -> None:
    """Answer a shell's completion request in typer's formats."""
    if VARIABLE in os.environ:
        completion_init()
