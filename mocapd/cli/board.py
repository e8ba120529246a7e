"""`mocapd board`"""

from pathlib import Path
from typing import Annotated

import typer

from mocapd.cli.options import ForceOption
from mocapd.errors import usage_errors


def board(
    out: Annotated[Path, typer.Option("--out", help="The PDF to write.")],
    paper: Annotated[str, typer.Option(help="A4, Letter, A3, A2 or A1.")] = "A4",
    board_size: Annotated[
        str, typer.Option(help="Squares across and down.", metavar="COLUMNSxROWS")
    ] = "5x7",
    square: Annotated[
        float | None, typer.Option(help="Side of a square [m] [default: as large as fits]")
    ] = None,
    marker: Annotated[
        float | None, typer.Option(help="Side of a marker [m] [default: 3/4 of the square]")
    ] = None,
    dictionary: Annotated[
        str, typer.Option(help="OpenCV's name of the markers.")
    ] = "DICT_4X4_1000",
    inverted: Annotated[bool, typer.Option("--inverted", help="Light on dark.")] = False,
    two_sided: Annotated[
        bool,
        typer.Option(
            "--two-sided",
            help="A second page, mirrored, for the back: cameras on both sides of the board see it at once.",
        ),
    ] = False,
    force: ForceOption = False,
) -> None:
    """Make a ChArUco calibration board to print.

    Print it at 100 % and measure its rulers. Says with which flags `mocapd calibrate` reads it.

    Example: mocapd board --out board.pdf --paper A4
    """
    from mocapd.calibration.board_spec import board_size as counts_of
    from mocapd.extras import require_extra

    require_extra("print", "mocapd board")

    from mocapd.printing.board_layout import fitted_board
    from mocapd.printing.board_pdf import board_pdf, flags_of
    from mocapd.printing.pdf_document import write_pdf

    with usage_errors():
        columns, rows = counts_of(board_size)
        made = fitted_board(
            paper, columns, rows, dictionary,
            inverted=inverted, two_sided=two_sided, square_m=square, marker_m=marker,
        )  # fmt: skip
    write_pdf(out, board_pdf(made, paper), force)
    print(flags_of(made))
    instructions = f"{out}: print it at 100 % and glue it flat onto something stiff"
    if two_sided:
        instructions += (
            ", the page BACK on its other side: pins through the crosses of FRONT show where, each cross "
            "on the one of its own letter"
        )
    typer.echo(instructions, err=True)
