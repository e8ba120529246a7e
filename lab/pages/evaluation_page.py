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

The comparison follows Fig. 9 of Wang, Paris and Popović (2011):

- `full`: this tracker.
- `paper`: the published method, steps 1 to 5 with its constants.
- `baseline`: the published method without the pose prior of step 3 and without adaptive white balance.

The paper measured 4.0 cm for its method and 5.1 cm for the baseline, on recordings of its own. The paper's errors are
of the vertices of a mesh. The errors in the tables below are of joints.
"""

_AGAINST_OTHERS = """
## Against other methods

The column `full` is this tracker. Each other column is a published tracker, or this tracker without one of its steps.
"""

_COMPARISON = """
{rms}

The RMS error is of the tracked frames alone. The coverage is the share of tracked frames:

{coverage}

The median error distinguishes small errors in all frames from large errors in a few frames:

{median}
"""

_SHOULDER = """
### The shoulder over time

The plot follows Fig. 10 of the paper. It shows the interior angle at the left shoulder (neck, shoulder, elbow). The
three curves are the ground truth, the full method and the baseline. A gap means: not tracked.

![The shoulder's angle over time]({plot})
"""

_ROC = """
### Classification of the shirt's colours

The table follows Fig. 6 of the paper, over the labelled frames of these captures. It compares the Gaussians of step 1
alone with step 3, which has the pose as prior. The thresholds of both steps vary.

- Both steps classify the same pixels: the region around the body, in pictures averaged down as for the tracker.
- Both steps use the white balance of step 5 in the previous frame.
- The prior is rendered from the pose that the full method tracked, not from the ground truth.
- *Correct* (table columns and vertical axis): share of the shirt's pixels that got their own colour.
- *False positives*: share of the region's pixels that got a wrong colour.
- Pixels on the border of two patches do not count.

{table}

![Correct classification over false positives]({plot})

The dots show the full method's own classifier during tracking. This classifier uses the prior, adapts to the colours of
each camera, and knows the background.
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
