"""Hypotheses of mistakes with cameras and their videos, each with the cameras and views that would correct it."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, permutations

import numpy as np

from mocapd.calibrate.consistency.findings import CaptureFinding, Mistake
from mocapd.calibrate.consistency.person_views import PersonView
from mocapd.calibrate.consistency.view_agreement import mirror_view, upside_down, zoom_view
from mocapd.geometry.camera_model import centre
from mocapd.types import Camera

Mend = Callable[[PersonView], PersonView]

_ZOOMS = (0.5, 0.6, 0.7, 0.8, 0.88, 1.12, 1.25, 1.4, 1.6, 1.8, 2.0)
# of a picture's side, of the middle of a part that was cut out
_SHIFTS = (-0.2, -0.1, 0.0, 0.1, 0.2)
_MOST_PERMUTED = 4  # cameras, of which all orders are tried


def identity_view(view: PersonView) -> PersonView:
    return view


@dataclass(frozen=True, slots=True, eq=False)
class Hypothesis:
    """cameras, mends: by view, in the rig's order, the camera of its pictures and their correction; affected: indexes of
    the views that this changes; what, fix: for the user."""

    mistake: Mistake | None
    cameras: tuple[Camera, ...]
    mends: tuple[Mend, ...]
    affected: tuple[int, ...]
    what: str = ""
    fix: str = ""


def as_given(cameras: Sequence[Camera]) -> Hypothesis:
    """No mistake."""
    return Hypothesis(
        None, tuple(cameras), (identity_view,) * len(cameras), tuple(range(len(cameras)))
    )


def hypotheses(cameras: Sequence[Camera]) -> Iterator[Hypothesis]:
    """Common mistakes, the likelier first, without zooms."""
    yield from _exchanges(cameras)
    yield from _mirrorings(cameras)
    yield from _upside_down(cameras)
    yield from _other_conventions(cameras)


def zooms(cameras: Sequence[Camera], index: int) -> Iterator[Hypothesis]:
    """One camera's pictures are a cut-out of the calibrated ones, about its principal point, or the other way round."""
    camera = cameras[index]
    for factor in _ZOOMS:
        yield _zoom(cameras, index, factor, (camera.K[0, 2], camera.K[1, 2]))


def shifted_zooms(cameras: Sequence[Camera], index: int, factor: float) -> Iterator[Hypothesis]:
    """The same zoom about other points, and slightly other zooms."""
    (w, h), cx, cy = cameras[index].size_px, cameras[index].K[0, 2], cameras[index].K[1, 2]
    for by in (0.94, 1.0, 1.06):
        if abs(by * factor - 1.0) < 0.04:
            continue
        for x in _SHIFTS:
            for y in _SHIFTS:
                yield _zoom(cameras, index, by * factor, (cx + x * w, cy + y * h))


def _zoom(
    cameras: Sequence[Camera], index: int, factor: float, about: tuple[float, float]
) -> Hypothesis:
    mends: list[Mend] = [identity_view] * len(cameras)
    mends[index] = partial(zoom_view, middle_px=about, factor=1.0 / factor)
    name = cameras[index].name
    size_word = "larger" if factor > 1.0 else "smaller"
    return Hypothesis(
        Mistake.ZOOMED, tuple(cameras), tuple(mends), (index,),
        f"what camera {name!r} shows is about {max(factor, 1 / factor):.1f} times {size_word} than its focal length makes it",
        "were its pictures cut, zoomed or letterboxed after it was calibrated? Record as then, or calibrate it again",
    )  # fmt: skip


def _exchanges(cameras: Sequence[Camera]) -> Iterator[Hypothesis]:
    count, names = len(cameras), [camera.name for camera in cameras]
    orders = (
        permutations(range(count))
        if count <= _MOST_PERMUTED
        else (_swap(count, i, j) for i, j in combinations(range(count), 2))
    )
    for order in orders:
        moved = tuple(i for i in range(count) if order[i] != i)
        if not moved:
            continue
        if any(cameras[order[i]].size_px != cameras[i].size_px for i in moved):
            continue
        if len(moved) == 2:
            two = exchanged_finding(*(names[i] for i in moved))
            what, fix = two.what, two.fix
        else:
            pairs = ", ".join(f"{names[i]!r} that of {names[order[i]]!r}" for i in moved)
            what = f"the pictures fit other cameras' places: {pairs}"
            fix = "give each camera its own video in rig.json"
        placed = tuple(cameras[k] for k in order)
        yield Hypothesis(Mistake.EXCHANGED, placed, (identity_view,) * count, moved, what, fix)


def exchanged_finding(a: str, b: str) -> CaptureFinding:
    """For two cameras, each of which shows the view of the other."""
    return CaptureFinding(
        Mistake.EXCHANGED,
        (a, b),
        f"the pictures of {a!r} fit the place of {b!r}, and those of {b!r} that of {a!r}: they are exchanged",
        "exchange their 'file' in rig.json, or the cameras",
    )


def _swap(count: int, i: int, j: int) -> tuple[int, ...]:
    order = list(range(count))
    order[i], order[j] = j, i
    return tuple(order)


def _one_or_all(
    cameras: Sequence[Camera], mend_of: Callable[[Camera], Mend]
) -> Iterator[tuple[tuple[int, ...], tuple[Mend, ...]]]:
    """Each camera's pictures alone are wrong, or all of them: the indexes of these, and the corrections of all."""
    every = tuple(range(len(cameras)))
    for chosen in dict.fromkeys([*((i,) for i in every), every]):
        yield chosen, tuple(mend_of(cameras[i]) if i in chosen else identity_view for i in every)


def _mirrorings(cameras: Sequence[Camera]) -> Iterator[Hypothesis]:
    for chosen, mends in _one_or_all(
        cameras, lambda camera: partial(mirror_view, width_px=camera.size_px[0])
    ):
        if len(chosen) == 1:
            what = f"the pictures of {cameras[chosen[0]].name!r} are mirrored, left to right"
            fix = "switch off mirroring where they are recorded, or mirror the video back"
        else:
            what = "all pictures are mirrored, left to right, or the rig is of a left-handed world"
            fix = "mirror the videos back, or turn the sign of one axis of the rig's world and of its cameras"
        yield Hypothesis(Mistake.MIRRORED, tuple(cameras), mends, chosen, what, fix)


def _upside_down(cameras: Sequence[Camera]) -> Iterator[Hypothesis]:
    for chosen, mends in _one_or_all(
        cameras, lambda camera: partial(upside_down, size_px=camera.size_px)
    ):
        names = " and ".join(repr(cameras[i].name) for i in chosen)
        yield Hypothesis(
            Mistake.TURNED, tuple(cameras), mends, chosen,
            f"the pictures of {names} are turned by 180 degrees from how they were calibrated",
            "turn the video back, or calibrate again with the camera as it is mounted",
        )  # fmt: skip


def _other_conventions(cameras: Sequence[Camera]) -> Iterator[Hypothesis]:
    """A rig in another program's conventions."""
    every = tuple(range(len(cameras)))
    same = (identity_view,) * len(cameras)
    wanted = "mocapd takes x_camera = R x_world + t: invert them"
    inverse = tuple(replace(c, R=c.R.T, t_m=centre(c)) for c in cameras)
    yield Hypothesis(
        Mistake.INVERTED, inverse, same, every,
        "R and t look like camera-to-world, where the camera is and how it is turned", wanted,
    )  # fmt: skip
    places = tuple(replace(c, t_m=-c.R @ c.t_m) for c in cameras)
    yield Hypothesis(
        Mistake.INVERTED, places, same, every,
        "t looks like the camera's place in the world", "mocapd takes x_camera = R x_world + t: t = -R place",
    )  # fmt: skip
    turned = tuple(replace(c, R=c.R.T) for c in cameras)
    yield Hypothesis(
        Mistake.INVERTED, turned, same, every, "R looks transposed", "mocapd takes x_camera = R x_world + t: transpose R"
    )  # fmt: skip
    for flip, axes in (
        ((1.0, -1.0, -1.0), "y up and z backwards, as OpenGL's"),
        ((-1.0, -1.0, 1.0), "x left and y up"),
        ((-1.0, 1.0, -1.0), "x left and z backwards"),
    ):
        D = np.diag(flip)
        other = tuple(replace(c, R=D @ c.R, t_m=D @ c.t_m) for c in cameras)
        yield Hypothesis(
            Mistake.AXES, other, same, every,
            f"the cameras' axes look like {axes}",
            "mocapd takes x right, y down, z forward: turn the signs of these rows of R and t",
        )  # fmt: skip
    for flip, axis in (((1.0, 1.0, -1.0), "z"), ((1.0, -1.0, 1.0), "y")):
        D = np.diag(flip)
        other = tuple(replace(c, R=D @ c.R @ D, t_m=D @ c.t_m) for c in cameras)
        yield Hypothesis(
            Mistake.AXES, other, same, every,
            f"the rig looks left-handed: the sign of {axis} is turned in the world and in the cameras",
            f"turn the sign of {axis} back in both",
        )  # fmt: skip
