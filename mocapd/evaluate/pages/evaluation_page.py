"""The page of the docs: tables as measured, the command that made them, and the plots."""

from pathlib import Path

from mocapd.evaluate.compare import BASELINE
from mocapd.evaluate.pages.write_out import write_out
from mocapd.evaluate.reliability import reliability
from mocapd.evaluate.report import comparison_tables, reliability_table, roc_table, score_table
from mocapd.evaluate.runs import EvaluationResults

PAGE = "evaluation.md"
RELIABILITY_PLOT = "images/eval_confidence.png"
SHOULDER_PLOT = "images/eval_shoulder.png"
ROC_PLOT = "images/eval_roc.png"

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

_AGAINST_PAPER = """
## Against the paper's method and its baseline

As in Fig. 9 of Wang, Paris and Popović (2011). `full`: this tracker. `paper`: the method as published,
steps 1 to 5 with its constants. `baseline`: the same without the pose prior of step 3 and without
adaptive white balance. The paper measured 4.0 cm for its method and 5.1 cm for the baseline, over the
vertices of a mesh and on recordings of its own; here it is the joints.
"""

_AGAINST_OTHERS = """
## Against other ways

`full`: this tracker; beside it what the registry sets there: as published, or without a step.
"""

_COMPARISON = """
{rms}

An error is that of the frames tracked, which are these:

{coverage}

The median tells a tracker that is a little off everywhere from one that is right but for some frames:

{median}
"""

_SHOULDER = """
### The shoulder over time

As in the paper's Fig. 10: the interior angle at the left shoulder (neck, shoulder, elbow), as it was,
as the full method tells it, and as the baseline does. A gap: not tracked.

![The shoulder's angle over time]({plot})
"""

_ROC = """
### Telling the colours apart

As in the paper's Fig. 6, over the labelled frames of these captures: the Gaussians of step 1 alone,
against step 3 with the pose as prior, while their thresholds vary. Both see the same pixels (pictures
averaged down as for the tracker, the region around the body) with the same white balance, that of
step 5 in the frame before; the prior is drawn from the pose that the full method tracked, not from the
truth. *Correct*: share of the shirt that got its own colour. *False positives*: share of the region
that got a colour which is not its own. Pixels on the border of two patches are not counted.

{table}

![Correct classification over false positives]({plot})

The dots are what the full method's own classifier gave while it ran: besides the prior it follows
each colour as the camera sees it, and it knows the background.
"""


def page(findings: EvaluationResults, command: str) -> str:
    """The page as Markdown."""
    believed = reliability(findings.results, findings.joints)
    parts = [
        _HEAD.format(
            command=command,
            tracker=findings.tracker,
            scores=score_table(findings.results),
            joints=findings.joints,
        )
    ]
    parts.append(_RELIABILITY.format(table=reliability_table(believed), plot=RELIABILITY_PLOT))
    if findings.comparison:
        rms, median, coverage = comparison_tables(findings.comparison)
        of_shirt = BASELINE in findings.comparison
        parts += [_AGAINST_PAPER if of_shirt else _AGAINST_OTHERS]
        parts += [_COMPARISON.format(rms=rms, median=median, coverage=coverage)]
        parts += [_SHOULDER.format(plot=SHOULDER_PLOT)] if of_shirt else []
    if findings.rocs:
        parts.append(_ROC.format(table=roc_table(findings.roc), plot=ROC_PLOT))
    return "".join(parts)


def write_page(
    directory: Path, findings: EvaluationResults, command: str, force: bool = False
) -> list[Path]:
    """Write the page and its plots; the paths. Raises CannotCreateError."""
    # matplotlib takes a second to import
    from mocapd.evaluate.compare import shoulder_angles
    from mocapd.evaluate.pages.plots import reliability_plot, roc_plot, save, shoulder_plot

    path = directory / PAGE
    written = [path, directory / RELIABILITY_PLOT]
    write_out(path, page(findings, command), force)
    save(reliability_plot(reliability(findings.results, findings.joints)), written[-1], force)
    if BASELINE in findings.comparison:
        written.append(directory / SHOULDER_PLOT)
        save(shoulder_plot(shoulder_angles(findings.comparison)), written[-1], force)
    if findings.rocs:
        written.append(directory / ROC_PLOT)
        save(roc_plot(findings.rocs), written[-1], force)
    return written
