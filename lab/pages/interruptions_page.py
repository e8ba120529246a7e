"""The page of the docs about the supervisor: what interrupts, who spoke then, and how far joints went."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from lab.pages.plots import Spans, speakers_plot
from lab.studies.speakers import Interruptions
from mocapd.evaluate.plots import save
from mocapd.evaluate.tables import number, table
from mocapd.evaluate.write_out import write_out
from mocapd.sim.scenario import Scenario

PAGE = "supervisor.md"
PLOT = "images/supervisor.png"
LIMIT_CM = 10.0  # a joint may go beyond its motion in a frame in which another speaks
_WANTED_PERCENT, _WANTED_FRAMES = 98.0, 10

_PAGE = """\
# When something interrupts

Written by this command, which makes everything below anew; do not edit by hand:

```sh
{command}
```

A simulated recording of 24 s, two cameras: somebody in the shirt puts a jacket on over it and takes it off, the lamps go out,
one camera is unplugged and comes back, the person leaves the room and returns. In each frame the tracker `auto` chooses who
speaks: `colour` (the shirt), `flex` (any clothes), or both joined to one body, `colour+flex`. How it chooses is in
[its README](../mocapd/trackers/supervisor/README.md).

{figures}

![Who speaks over time, and the farthest step of a joint]({plot})

{switches}

*In view*: hips and neck are in the picture of a camera that delivers; the first frames after somebody came, in which a person
is not believed yet, count. *Switch*: from the last frame that one told to the first that is what the next one knows; in
between the body glides. *Step*: how far a joint goes from frame to frame beyond its true motion, which is the tracker's own
error, too. *Ghosts*: frames with a body, when nobody has been in the room for longer than a body coasts.

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
    frames = [one.frames for one in of.switches]
    steps = [one.step_cm for one in of.switches]
    rows = [
        ["a body is told, of the frames with somebody in view", f">= {_WANTED_PERCENT:g} %", f"{100 * of.published:.1f} %"],
        ["frames that a switch takes, at most", f"<= {_WANTED_FRAMES}", number(max(frames, default=np.nan), 0)],
        ["step of a joint at a switch, at most", f"<= {LIMIT_CM:g} cm", f"{number(max(steps, default=np.nan), 1)} cm"],
        ["step of a joint at any time, at most", "", f"{number(_largest(of), 1)} cm"],
        ["ghosts", "0", str(of.ghosts)],
    ]  # fmt: skip
    return table(["", "wanted", "measured"], rows)


def switches_table(of: Interruptions) -> str:
    """One row for each switch."""
    rows = [
        [
            f"{one.before} to {one.after}",
            number(one.at_s, 2),
            str(one.frames),
            number(one.step_cm, 1),
        ]
        for one in of.switches
    ]
    return table(["switch", "at [s]", "frames", "step [cm]"], rows)


def errors_table(of: Interruptions) -> str:
    """How far off the joints of the whole body were, by who spoke."""
    shares = {who: float((of.told.tracker == who).mean()) for who in of.error_cm}
    rows = [
        [who, number(100.0 * shares[who], 0), number(error, 1)]
        for who, error in of.error_cm.items()
    ]
    return table(["who spoke", "frames [%]", "RMS, full body [cm]"], rows)


def as_json(of: Interruptions) -> dict[str, Any]:
    """The same; null where there is nothing to tell."""
    return {
        "published_percent": 100.0 * of.published,
        "largest_step_cm": _plain(_largest(of)),
        "ghosts": of.ghosts,
        "rms_cm": {who: _plain(error) for who, error in of.error_cm.items()},
        "switches": [asdict(one) | {"step_cm": _plain(one.step_cm)} for one in of.switches],
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
        command=command, plot=PLOT, figures=figures_table(of), switches=switches_table(of), errors=errors_table(of)
    )  # fmt: skip
    write_out(path, text)
    save(speakers_plot(of, LIMIT_CM, spans), directory / PLOT)
    return [path, directory / PLOT]


def _plain(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _largest(of: Interruptions) -> float:
    return float(np.nanmax(of.step_cm)) if np.isfinite(of.step_cm).any() else float("nan")
