"""Proposed strokes on captures' scribble pictures, against those that a user drew there.

`python -m lab.colours_of_captures CAPTURE...`; the user's strokes are for the score only.
"""

import argparse
import sys
from pathlib import Path

from lab.studies.colour_proposals import ProposalScore, score_by_strokes, table
from mocapd.calibrate.colours.stroke_proposal import propose_strokes
from mocapd.calibration.calibration_record import ShirtColours
from mocapd.calibration.from_origin import from_capture
from mocapd.capture.capture_folder import load_folder
from mocapd.config.sections import TrackerSection, default_cache_dir
from mocapd.shirt.colour.from_pictures import colour_model, white_balances
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.shirt.pose_database.database_file import load_or_build


def score_capture(
    capture: Path, database: PoseDatabase, standard: bool
) -> dict[str, ProposalScore]:
    """By picture. standard: with the shirt's standard colours in place of the capture's own pictures of it.

    Raises InputError when there is no rig, no scribble, or nobody in the pictures.
    """
    folder = load_folder(capture)
    shirt = from_capture(folder).shirt or ShirtColours()
    model = colour_model(() if standard else shirt.model)
    user = shirt.white_balance
    found = propose_strokes(
        {name: one.pixels for name, one in user.items()},
        folder.rig,
        model,
        database,
        folder.stature_m or TrackerSection().stature_m,
    )
    W = white_balances(user, model)
    return {
        f"{capture.name} {name}": score_by_strokes(one.strokes, user[name].labels, one.W, W[name])
        for name, one in found.items()
    }


def main() -> None:
    """The command in the module's docstring."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("captures", nargs="+", type=Path)
    parser.add_argument("--standard", action="store_true", help="the shirt's standard colours")
    told = parser.parse_args()
    database = load_or_build(default_cache_dir()).database
    scores: dict[str, ProposalScore] = {}
    for capture in told.captures:
        scores |= score_capture(capture, database, told.standard)
    sys.stdout.write(table(scores) + "\n")


if __name__ == "__main__":
    main()
