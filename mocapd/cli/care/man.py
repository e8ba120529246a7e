"""`mocapd man`"""

import typer


def add_to(app: typer.Typer) -> None:
    """Register the command."""

    @app.command("man")
    def man() -> None:
        """Print the manual page of mocapd, as man(1) reads it.

        Example: mocapd man > ~/.local/share/man/man1/mocapd.1
        """
        from mocapd.cli.care.man_page import man_page

        print(man_page(app), end="")
