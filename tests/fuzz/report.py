"""What came of the rows: a table, and for each kind of unnamed error how to see it again."""

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

from tests.fuzz.child import SLOW_S
from tests.fuzz.runner import Found, Outcome

MOST_MB = 200.0  # that a parser may need beyond what it has at the start
_SHOWN = 12  # kinds of unnamed errors of a row


def is_good(outcome: Outcome) -> bool:
    """No unnamed error, no slow input, no large one."""
    return not (outcome.found or outcome.slowest_s > SLOW_S or outcome.more_mb > MOST_MB)


def show(outcomes: Sequence[Outcome], seed: int, console: Console) -> None:
    """The table, then what is wrong."""
    table = Table()
    table.add_column("parser")
    for name in ("inputs", "accepted", "named", "unnamed", "slowest s", "more MB"):
        table.add_column(name, justify="right")
    for one in outcomes:
        table.add_row(
            one.row.name,
            f"{one.inputs}",
            f"{one.taken}",
            f"{one.refused}",
            _marked(f"{one.unnamed}", one.unnamed > 0),
            _marked(f"{one.slowest_s:.3f}", one.slowest_s > SLOW_S),
            _marked(f"{one.more_mb:.0f}", one.more_mb > MOST_MB),
        )
    table.add_section()
    table.add_row(
        "all",
        f"{sum(one.inputs for one in outcomes)}",
        f"{sum(one.taken for one in outcomes)}",
        f"{sum(one.refused for one in outcomes)}",
        f"{sum(one.unnamed for one in outcomes)}",
        f"{max(one.slowest_s for one in outcomes):.3f}",
        f"{max(one.more_mb for one in outcomes):.0f}",
    )
    console.print(table)
    for one in outcomes:
        for line in _troubles(one, seed):
            console.print(line, markup=False, highlight=False, soft_wrap=True)


def _marked(text: str, bad: bool) -> str:
    return f"[bold red]{text}[/]" if bad else text


def _troubles(one: Outcome, seed: int) -> list[str]:
    def again(number: int) -> str:
        return f"python -m tests.fuzz --seed {seed} --only {one.row.name} --input {number}"

    lines = []
    kinds: dict[str, list[Found]] = {}
    for found in one.found:
        kinds.setdefault(found.kind, []).append(found)
    for kind, alike in sorted(kinds.items(), key=lambda item: -len(item[1]))[:_SHOWN]:
        first = alike[0]
        what = first.what.splitlines()[-1] if first.what else ""
        lines.append(f"{one.row.name}: {len(alike)} x {kind}: {what}\n    {again(first.number)}")
    if len(kinds) > _SHOWN:
        lines.append(f"{one.row.name}: {len(kinds) - _SHOWN} kinds more")
    if one.slowest_s > SLOW_S:
        lines.append(f"{one.row.name}: {one.slowest_s:.1f} s\n    {again(one.slowest)}")
    if one.more_mb > MOST_MB:
        lines.append(f"{one.row.name}: {one.more_mb:.0f} MB more\n    {again(one.largest)}")
    return lines
