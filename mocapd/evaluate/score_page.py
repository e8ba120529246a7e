"""The page about an evaluation: tables as measured, the command that made them, and a plot."""

from collections.abc import Sequence
from pathlib import Path

from mocapd.evaluate.capture_eval import CaptureResult
from mocapd.evaluate.reliability import reliability
from mocapd.evaluate.report import reliability_table, score_table
from mocapd.evaluate.write_out import PAGE_KIND, write_out
from mocapd.output_file import PNG, OutputFile

PAGE = "evaluation.md"
RELIABILITY_PLOT = "images/eval_confidence.png"

_HEAD = """\
# How well it tracks

Written by this command, which makes every table below anew; do not edit by hand:

```sh
{command}
```

## Scores of the tracker {tracker}

{scores}

Distances of the joint centres ({joints}) to the ground truth, in metres of the world: nothing is
aligned, scaled or smoothed before. Half a second after the person comes in is left out. *Ghosts*:
frames with a person before there was one. *Angle*: mean error of the angles between the bones at
neck, shoulders and elbows, or at the joints scored. *Back after*: frames from a lamp going out until
the RMS error of a frame is under 6 cm for good, or, where something hid the person, from its end until it
is under 10 cm; 0: it never left; `-`: nothing of both. *Step*: median time of the tracker for one frame
set, on the machine that ran this and beside whatever else ran there (`mocapd bench` is the measure of
speed). *Jitter*: median second difference from frame to frame, as a ratio to that of the truth. *Step*
p99, max: how far a joint moves from frame to frame beyond its true
motion. *Believed*: the joints of confidence 0.4 and more.
"""

_RELIABILITY = """
## What a confidence is worth

All captures of the table above together, by the confidence that each joint had in each frame:

{table}

![Errors over confidence]({plot})
"""


def page(results: Sequence[CaptureResult], tracker: str, joints: str, command: str) -> str:
    """The page as Markdown."""
    scores = score_table(results)
    confidences = reliability_table(reliability(results, joints))
    return _HEAD.format(
        command=command, tracker=tracker, scores=scores, joints=joints
    ) + _RELIABILITY.format(table=confidences, plot=RELIABILITY_PLOT)


def check_page(directory: Path, force: bool) -> None:
    """Check before a long run: raises CannotCreateError for an existing file that must not be replaced."""
    for name, kind in ((PAGE, PAGE_KIND), (RELIABILITY_PLOT, PNG)):
        OutputFile(directory / name, kind, force).check_replaceable()


def write_page(
    directory: Path,
    results: Sequence[CaptureResult],
    tracker: str,
    joints: str,
    command: str,
    force: bool = False,
) -> list[Path]:
    """Write the page and its plot; the paths. Raises CannotCreateError."""
    write_out(directory / PAGE, page(results, tracker, joints, command), force)
    return [directory / PAGE, write_plot(directory, results, joints, force)]


def write_plot(
    directory: Path, results: Sequence[CaptureResult], joints: str, force: bool = False
) -> Path:
    """Write the plot of errors over confidence into the page's folder. Raises CannotCreateError."""
    # matplotlib takes a second to import
    from mocapd.evaluate.plots import reliability_plot, save

    path = directory / RELIABILITY_PLOT
    save(reliability_plot(reliability(results, joints)), path, force)
    return path
