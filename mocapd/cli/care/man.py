"""`mocapd man`"""

import typer


def man(context: typer.Context) -> None:
    """Print the manual page of mocapd, as man(1) reads it.

    Example: mocapd man > ~/.local/share/man/man1/mocapd.1
    """
    from mocapd.cli.care.man_page import man_page

    print(man_page(context.find_root().command), end="")
