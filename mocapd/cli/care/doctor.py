"""`mocapd doctor`"""

import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated

import typer

from mocapd.cli.options import ConfigOption, SetOption, config_to_look_after
from mocapd.errors import Problem, one_line

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mocapd.doctor.finding import Finding


def doctor(
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object a line.")] = False,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Find what keeps mocapd from tracking on this machine, and the remedy.

    Checks permissions, webcams, USB bandwidth, calibration, ports, folders and their free space, processor, clock and
    libraries. Each check prints a line: `ok`, `warn` or `bad`. It changes nothing and takes no picture. Exit code 1 if
    a check is bad.

    Example: mocapd doctor | grep -v ^ok
    """
    effective, error = config_to_look_after(config, settings)

    from mocapd.doctor.examination import examine
    from mocapd.doctor.finding import Verdict
    from mocapd.doctor.gathering.gathering import gather_facts

    trouble = None
    if error is not None:
        where = f"{error.where}: " if error.where else ""
        trouble = Problem(f"{where}{error.what}", fix=error.fix)
    findings = examine(gather_facts(effective, trouble))
    print("\n".join(map(_as_json, findings)) if as_json else _as_text(findings))
    raise typer.Exit(int(any(one.verdict is Verdict.BAD for one in findings)))


def _as_json(finding: "Finding") -> str:
    return json.dumps(asdict(finding))


def _as_text(findings: "Sequence[Finding]") -> str:
    width = max(len(one.about) for one in findings)
    lines = (
        f"{one.verdict:<4}  {one.about:<{width}}  {one.what}"
        + (f" -- {one.fix}" if one.fix else "")
        for one in findings
    )
    return "\n".join(map(one_line, lines))
