"""The page of the docs about the cues: what interrupts, which of them carried the body then, and how far joints went."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from lab.pages.plots import Spans, cues_plot
from lab.studies.cue_changes import APPROACH_S, Interruptions
from mocapd.evaluate.plots import save
from mocapd.evaluate.tables import number, table
from mocapd.evaluate.write_out import write_out
from mocapd.sim.scenario import Scenario

PAGE = "cues.md"
PLOT = "images/cues.png"
LIMIT_CM = 10.0  # a joint may go beyond its motion in a frame at a change of cues
_WANTED_PERCENT = 98.0

_PAGE = """\
# When something interrupts

Written by this command, which makes everything below anew; do not edit by hand:

```sh
{command}
```

A simulated recording of 24 s, two cameras: somebody in the shirt puts a jacket on over it and takes it off, the lamps go out,
one camera is unplugged and comes back, the person leaves the room and returns. Each frame says which cues carried the body:
`shirt` (trunk and arms alone), `clothes` (all of it), or `shirt+clothes` (trunk and arms by the shirt, legs and head by the
clothes). How far a cue is believed is in [the tracker's README](../mocapd/tracking/README.md).

{figures}

![The cues over time, and the farthest step of a joint]({plot})

{changes}

*In view*: hips and neck are in the picture of a camera that delivers; the first frames after somebody came, in which a person
is not believed yet, count. *Step*: how far a joint goes from frame to frame beyond its true motion, and so the tracker's own
error counts, too; at a change: in the {approach_s:g} s in which the published pose approaches what those cues found.
*Ghosts*: frames with a body, when nobody has been in the room for longer than a body coasts.

{errors}
"""


def spans_of(scenario: Scenario) -> dict[str, Spans]:
    """What interrupts, from when to when."""
    jacket = scenario.clothes.events
    dark = [light.events for light in scenario.lights if light.events]
    return {
        "jacket": [(jacket[0].t_s, jacket[-1].t_s + jacket[-1].over_s)] if jacket else [],
        "no lamp": [(events[0].t_s, events[-1].t_s) for events in dark[:1]],
        "one camera": [(s.from_s, s.to_s) for one in scenario.cameras for s in one.outages],
        "nobody there": [(span.from_s, span.to_s) for span in scenario.absences],
    }


def figures_table(of: Interruptions) -> str:
    """What is wanted and what was measured."""
    steps = [one.step_cm for one in of.changes]
    rows = [
        ["frames with a body, while somebody is in view", f">= {_WANTED_PERCENT:g} %", f"{100 * of.published:.1f} %"],
        ["step of a joint at a change of cues", f"<= {LIMIT_CM:g} cm", f"{number(max(steps, default=np.nan), 1)} cm"],
        ["step of a joint at any time", "", f"{number(_largest(of), 1)} cm"],
        ["ghosts", "0", str(of.ghosts)],
    ]  # fmt: skip
    return table(["", "wanted", "measured"], rows)


def changes_table(of: Interruptions) -> str:
    """One row for each change of cues."""
    rows = [
        [
            f"{one.before} to {one.after}",
            number(one.at_s, 2),
            number(one.step_cm, 1),
        ]
        for one in of.changes
    ]
    return table(["change", "at [s]", "step [cm]"], rows)


def errors_table(of: Interruptions) -> str:
    """How far off the joints of the whole body were, by the cues that carried it."""
    shares = {cues: float((of.bodies.carrier == cues).mean()) for cues in of.error_cm}
    rows = [
        [cues, number(100.0 * shares[cues], 0), number(error, 1)]
        for cues, error in of.error_cm.items()
    ]
    return table(["cues", "frames [%]", "RMS, full body [cm]"], rows)


def as_json(of: Interruptions) -> dict[str, Any]:
    """The same; null where there is nothing to tell."""
    return {
        "published_percent": 100.0 * of.published,
        "largest_step_cm": _plain(_largest(of)),
        "ghosts": of.ghosts,
        "rms_cm": {cues: _plain(error) for cues, error in of.error_cm.items()},
        "changes": [asdict(one) | {"step_cm": _plain(one.step_cm)} for one in of.changes],
    }


def write_page(
    directory: Path,
    of: Interruptions,
    spans: Mapping[str, Spans],
    command: str,
) -> list[Path]:
    """Write the page and its plot; the paths. Raises CannotCreateError."""
    path = directory / PAGE
    text = _PAGE.format(
        command=command, plot=PLOT, figures=figures_table(of), changes=changes_table(of), errors=errors_table(of),
        approach_s=APPROACH_S,
    )  # fmt: skip
    write_out(path, text, force=True)
    save(cues_plot(of, LIMIT_CM, spans), directory / PLOT, force=True)
    return [path, directory / PLOT]


def _plain(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _largest(of: Interruptions) -> float:
    return float(np.nanmax(of.step_cm)) if np.isfinite(of.step_cm).any() else float("nan")
