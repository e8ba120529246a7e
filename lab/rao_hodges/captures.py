"""Score the tracker of Rao and Hodges on recorded captures, with its root from the hull.

python -m lab.rao_hodges.captures CAPTURE...
"""

import sys
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Annotated

import typer

from lab.command_line import run
from mocapd.calibration.calibration_record import Calibration
from mocapd.evaluate.capture_eval import evaluate, open_case
from mocapd.published.rao_hodges.annealing import AnnealingParams
from mocapd.published.rao_hodges.params import Params
from mocapd.session.tracker_setup import ReadyTracker
from mocapd.trackers.registry import Resources, build
from mocapd.tracking.tracker_inputs import wearer_shape

_TRACKER = "rao_hodges"
_STATURE_M = 1.75  # of captures that do not say
_PARAMS: Mapping[str, Params] = MappingProxyType(
    {
        "as published": Params(),
        "converse term, six layers": Params(converse=1.0, annealing=AnnealingParams(layers=6)),
    }
)


def captures(
    folders: Annotated[
        list[Path], typer.Argument(help="Folders in the capture format with a truth.npz.")
    ],
) -> None:
    """Print a table of errors over all joints of the body."""
    sys.stdout.write(
        "| capture | | coverage [%] | RMS [cm] | median [cm] | hips RMS [cm] | angle [deg] |\n"
        "|---|---|---:|---:|---:|---:|---:|\n"
    )
    for label, params in _PARAMS.items():
        for folder in folders:

            def ready(known: Calibration, params: Params = params) -> ReadyTracker:
                tracker = build(_TRACKER, known, Resources(params={_TRACKER: params}))
                return ReadyTracker(tracker, wearer_shape(known))

            found = evaluate(open_case(folder), ready, stature_m=_STATURE_M, joints="full").score
            sys.stdout.write(
                f"| {folder.name} | {label} | {100.0 * found.coverage:.1f} | {found.rms_cm:.1f} | {found.median_cm:.1f} "
                f"| {found.per_joint_rms_cm['hips']:.1f} | {found.joint_angle_deg:.1f} |\n"
            )
            sys.stdout.flush()


if __name__ == "__main__":
    run(captures)
