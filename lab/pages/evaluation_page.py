"""The page about an evaluation, with the methods that the tracker is measured by, and their plots."""

from pathlib import Path

from lab.compared.compare import BASELINE, shoulder_angles
from lab.compared.compared_runs import EvaluationResults
from lab.compared.comparison_report import comparison_tables, roc_table
from mocapd.evaluate import score_page
from mocapd.evaluate.write_out import write_out

SHOULDER_PLOT = "images/eval_shoulder.png"
ROC_PLOT = "images/eval_roc.png"

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
    parts = [
        score_page.page(findings.results, findings.tracker, findings.joints, command),
    ]
    if findings.comparison:
        rms, median, coverage = comparison_tables(findings.comparison)
        of_shirt = BASELINE in findings.comparison
        parts += [_AGAINST_PAPER if of_shirt else _AGAINST_OTHERS]
        parts += [_COMPARISON.format(rms=rms, median=median, coverage=coverage)]
        parts += [_SHOULDER.format(plot=SHOULDER_PLOT)] if of_shirt else []
    if findings.rocs:
        parts.append(_ROC.format(table=roc_table(findings.roc), plot=ROC_PLOT))
    return "".join(parts)


def write_page(directory: Path, findings: EvaluationResults, command: str) -> list[Path]:
    """Write the page and its plots; the paths. Raises CannotCreateError."""
    # matplotlib takes a second to import
    from lab.pages.plots import roc_plot, shoulder_plot
    from mocapd.evaluate.plots import save

    path = directory / score_page.PAGE
    write_out(path, page(findings, command), force=True)
    written = [
        path,
        score_page.write_plot(directory, findings.results, findings.joints, force=True),
    ]
    if BASELINE in findings.comparison:
        written.append(directory / SHOULDER_PLOT)
        save(shoulder_plot(shoulder_angles(findings.comparison)), written[-1], force=True)
    if findings.rocs:
        written.append(directory / ROC_PLOT)
        save(roc_plot(findings.rocs), written[-1], force=True)
    return written
