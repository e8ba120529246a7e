"""What a check of an engine or a platform found, and the table of all."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Result:
    """good: None where it was left out; `measured` then says why."""

    where: str
    what: str
    measured: str
    wanted: str
    good: bool | None


def at_most(where: str, what: str, value: float, limit: float, unit: str) -> Result:
    """A measured value that must not be above the limit."""
    return Result(where, what, f"{value:.4g} {unit}", f"≤ {limit:g} {unit}", value <= limit)


def left_out(where: str, what: str, why: str) -> Result:
    """A check that cannot be made here."""
    return Result(where, what, f"skipped: {why}", "", None)


def table(results: list[Result]) -> str:
    """As Markdown."""
    words = {True: "ok", False: "**fails**", None: "-"}
    rows = [
        f"| {r.where} | {r.what} | {r.measured} | {r.wanted} | {words[r.good]} |" for r in results
    ]
    return "\n".join(["| where | what | measured | wanted | |", "|---|---|---|---|---|", *rows])


def exit_code(results: list[Result]) -> int:
    """1 where a check that was made failed."""
    return int(any(result.good is False for result in results))
