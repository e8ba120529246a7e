"""The page of the docs about the published tracker's failures: each scene, its remedy, and how soon it is right again."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lab.pages.plots import recovery_plot
from lab.simulated.failure_scenes import FAILURE_SCENES
from lab.simulated.session_plan import PlannedSession
from mocapd.evaluate.capture_eval import CaptureResult
from mocapd.evaluate.plots import save
from mocapd.evaluate.recovery import CLEAR_LIMIT_M, frame_errors_m
from mocapd.evaluate.tables import number, table
from mocapd.evaluate.write_out import write_out
from mocapd.types import Floats

PAGE = "failures.md"
PLOT = "images/failures.png"
WANTED_S = 2.0  # in which somebody who is in the open again is known rightly
REMEDIED = "markerless"  # the tracker whose remedies are listed

_PAGE = """\
# What the published tracker got wrong

Written by this command, which makes everything below anew; do not edit by hand:

```sh
{command}
```

Hecht et al. (2009) name what their tracker without a shirt loses. Each of it is a simulated scene of 8 s: somebody in plain
clothes hangs the arms, is hard to see for some seconds, and is then in the open again. It is recorded twice, before a pair of
cameras 12 cm apart (`stereo`) and before one whose views cross (`pair`), and tracked by `{tracker}`.

{remedies}{outcomes}

![Error of the whole body over time, by scene]({plot})

*Right again after*: from the moment at which nothing hides the person any more until the RMS error of a frame
(joints: {joints}) is under {limit_cm:g} cm for good; 0: it never left; wanted within {wanted_s:g} s. *Hidden*, *open*: RMS
error of the frames before that moment and of those more than {wanted_s:g} s after it; nothing is aligned, and half a second
after the person comes in is left out. In the plot a dashed line is that limit, a grey band the time that it may take.
"""

_REMEDIES = {
    "from_the_side": """seen from the side. Legs, trunk and neck are held where people's usually are; an arm of which nothing
  is seen goes on a little, is told with low confidence, and is searched for as soon as its pixels come back.""",
    "legs_that_cross": """two legs on one leg. The whole body is drawn at once, nearer parts before farther ones, so that a
  pixel is explained by one leg alone; knees and hips have limits, and feet stay above the floor.""",
    "a_limb_that_passes_another": """a moving limb drags a still one along. All limbs are fitted together, and a pixel teaches
  colours only where what was classified and what is drawn agree.""",
    "folded_arms": """folded arms. Distances of the cloth's texture hold arms before the trunk; regions that look alike are
  one, so that neither is explained by the other's pixels.""",
    "right_round": """a turn right round. It is predicted from the last frames, and colours are learned of each region as it
  turns, not once of the front.""",
}


@dataclass(frozen=True, slots=True, eq=False)
class FailureOutcome:
    """One scene before one rig. clear_s: nothing hides the person from then on; errors_m (F,) [m] of the frames at
    times_s (F,): infinite where nobody is told, NaN where nothing is scored; back_s: until it is right again, infinite for
    never."""

    scene: str
    rig: str
    clear_s: float
    times_s: Floats
    errors_m: Floats
    back_s: float

    @property
    def hidden_cm(self) -> float:
        """RMS error until nothing hides the person."""
        return _rms_cm(self.errors_m[self.times_s < self.clear_s])

    @property
    def open_cm(self) -> float:
        """RMS error once it should be right again."""
        return _rms_cm(self.errors_m[self.times_s >= self.clear_s + WANTED_S])


def outcomes(
    sessions: Sequence[PlannedSession], results: Sequence[CaptureResult], joints: str
) -> list[FailureOutcome]:
    """What became of the scenes among some sessions, as tracked."""
    scenes = {scene.name for scene in FAILURE_SCENES}
    out = []
    for session, result in zip(sessions, results, strict=True):
        _, _, rest = session.name.partition("_")
        rig, _, scene = rest.partition("_")
        if scene not in scenes or session.clear_s is None or result.recovery_frames is None:
            continue
        errors_m = frame_errors_m(result.case.truth, result.track, joints)
        back_s = result.recovery_frames / result.case.folder.fps_hz
        times_s = result.case.truth.times_s
        out.append(FailureOutcome(scene, rig, session.clear_s, times_s, errors_m, back_s))
    return out


def remedies_list() -> str:
    """What was wrong, and what is done about it."""
    return "\n".join(f"- `{scene}`: {remedy}" for scene, remedy in _REMEDIES.items())


def outcomes_table(found: Sequence[FailureOutcome]) -> str:
    """One row for each scene and rig."""
    rows = [
        [
            one.scene,
            one.rig,
            number(one.back_s, 2),
            number(one.hidden_cm, 1),
            number(one.open_cm, 1),
        ]
        for one in found
    ]
    header = ["scene", "rig", "right again after [s]", "hidden [cm]", "open [cm]"]
    return table(header, rows)


def as_json(found: Sequence[FailureOutcome]) -> list[dict[str, Any]]:
    """The same; null is "nothing to tell", "never" for no recovery."""
    return [
        {
            "scene": one.scene,
            "rig": one.rig,
            "back_s": one.back_s if np.isfinite(one.back_s) else "never",
            "hidden_cm": one.hidden_cm if np.isfinite(one.hidden_cm) else None,
            "open_cm": one.open_cm if np.isfinite(one.open_cm) else None,
        }
        for one in found
    ]


def write_page(
    directory: Path,
    found: Sequence[FailureOutcome],
    tracker: str,
    joints: str,
    command: str,
) -> list[Path]:
    """Write the page and its plot; the paths. Raises CannotCreateError."""
    path = directory / PAGE
    text = _PAGE.format(
        command=command,
        tracker=tracker,
        joints=joints,
        remedies=f"What the paper's tracker got wrong, and its remedy here:\n\n{remedies_list()}\n\n"
        if tracker == REMEDIED
        else "",
        outcomes=outcomes_table(found),
        plot=PLOT,
        limit_cm=100.0 * CLEAR_LIMIT_M,
        wanted_s=WANTED_S,
    )
    write_out(path, text, force=True)
    panels: dict[str, list[tuple[str, Floats, Floats]]] = {}
    clear_s = {}
    for one in found:
        panels.setdefault(one.scene, []).append((one.rig, one.times_s, 100.0 * one.errors_m))
        clear_s[one.scene] = one.clear_s
    save(
        recovery_plot(panels, clear_s, WANTED_S, 100.0 * CLEAR_LIMIT_M),
        directory / PLOT,
        force=True,
    )
    return [path, directory / PLOT]


def _rms_cm(errors_m: Floats) -> float:
    """Of the frames that were scored and told; NaN where none was."""
    told = errors_m[np.isfinite(errors_m)]
    return 100.0 * float(np.sqrt((told**2).mean())) if len(told) else float("nan")
