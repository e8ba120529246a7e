"""Learn how far each angle of a limb changes from frame to frame, for `mocapd.published.rao_hodges.limb_motion`.

python -m lab.rao_hodges.learn_motion CLIPS
"""

import sys
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from lab.command_line import run
from lab.rao_hodges.clip_angles import LIMBS, steps_and_ranges
from lab.rao_hodges.experiment import chains
from lab.simulated.motion_clip import read_clip

PERCENTILE = 99.5  # of steps and, with its complement, of values


def learn_motion(
    clips: Annotated[Path, typer.Argument(help="A folder of clips of motion.")],
) -> None:
    """Print the largest step of each angle after discounting for the noise, and the range of its values."""
    read = [read_clip(path) for path in sorted(clips.glob("[!.]*.npz"))]
    by_limb = {limb: chains()[limb] for limb in LIMBS}
    steps, values = steps_and_ranges(
        read, {limb: (chain.kinds, chain.mirrored) for limb, chain in by_limb.items()}
    )
    sys.stdout.write(
        "| angle | largest step [deg] | very largest | range [deg] |\n|---|---:|---:|---|\n"
    )
    for kind in steps:
        step = np.degrees(np.percentile(steps[kind], [PERCENTILE, 100.0]))
        low, high = np.degrees(np.percentile(values[kind], [100.0 - PERCENTILE, PERCENTILE]))
        sys.stdout.write(f"| {kind} | {step[0]:.1f} | {step[1]:.1f} | {low:.0f} to {high:.0f} |\n")


if __name__ == "__main__":
    run(learn_motion)
