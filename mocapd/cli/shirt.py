"""`mocapd shirt`"""

from pathlib import Path
from typing import Annotated

import typer

from mocapd.cli.options import ForceOption
from mocapd.errors import usage_errors


def shirt(
    out: Annotated[Path, typer.Option("--out", help="The PDF to write.")],
    size: Annotated[str, typer.Option(help="S, M, L, XL or XXL.")] = "M",
    paper: Annotated[str, typer.Option(help="A4, Letter, A3, A2 or A1.")] = "A4",
    layout: Annotated[
        str,
        typer.Option(
            help="sewing: pieces over pages of the paper; printing: one page a piece, for a printer"
            " of cloth."
        ),
    ] = "sewing",
    force: ForceOption = False,
) -> None:
    """Make the standard shirt's pattern at true size, with a swatch card.

    Example: mocapd shirt --out shirt.pdf --size L
    """
    from mocapd.extras import require_extra

    require_extra("print", "mocapd shirt")

    from mocapd.printing.pdf_document import write_pdf
    from mocapd.printing.shirt_pdf import shirt_pdf

    with usage_errors():
        content = shirt_pdf(size, paper, layout)
    write_pdf(out, content, force)
    typer.echo(f"{out}: print it at 100 %; how to sew it is on its first page", err=True)
