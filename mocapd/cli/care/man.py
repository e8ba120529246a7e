"""`mocapd man`"""


def man() -> None:
    """Print the manual page of mocapd, as man(1) reads it.

    Example: mocapd man > ~/.local/share/man/man1/mocapd.1
    """
    from mocapd.cli.care.man_page import man_page
    from mocapd.cli.command_list import app

    print(man_page(app), end="")
