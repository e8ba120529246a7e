"""Solves the extrinsics of a live setup from the board at rest before its cameras."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.board.board_sightings import Views
from mocapd.calibrate.extrinsics.board_extrinsics import (
    BoardExtrinsicsParams,
    SceneExtrinsics,
    WorldExtrinsics,
    place_in_world,
    solve_extrinsics,
)
from mocapd.calibrate.extrinsics.bundle_adjustment import BundleParams
from mocapd.calibrate.extrinsics.contradictions import ContradictionError, MirroredError
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibrate.intrinsics.intrinsics_priors import IntrinsicsPriors, MeasuredIntrinsics
from mocapd.calibrate.intrinsics.views import choose_views
from mocapd.calibration.board_spec import BoardSpec
from mocapd.errors import ConfigError
from mocapd.geometry.reprojection import intrinsics_row

# positions are never of neighbouring frames, so there is no motion: one round is enough
PARAMS = BoardExtrinsicsParams(bundle=BundleParams(rounds=1))
_ALONE = 12  # pictures of one camera alone, for its intrinsics
_OWN_VIEWS = 8  # with fewer pictures its earlier intrinsics count
_MOST_REFUSED = 0.15  # of the corners; with more, the cameras have moved between the steps
# Deviations of earlier intrinsics: of the middle [picture widths] and of k1 k2 p1 p2 k3.
_MIDDLE = 0.004
_DIST = (0.02, 0.05, 0.001, 0.001, 0.05)


def solve_live(
    intrinsics_of: Mapping[str, Intrinsics], spec: BoardSpec, views: Views, earlier: frozenset[int]
) -> tuple[SceneExtrinsics, WorldExtrinsics]:
    """The extrinsics of the cameras of `intrinsics_of`, in its order, and a guess of the world.

    views: by camera and index of the sighting; earlier: indices of the sightings from the intrinsics step. Where these
    contradict the others, a camera may have moved since: the second solution does not use them between cameras.
    Raises ConfigError.
    """
    refusal: ContradictionError | None = None
    try:
        solution = _solve(intrinsics_of, spec, views)
        if not earlier or 1.0 - np.mean(solution[0].bundle.used) <= _MOST_REFUSED:
            return solution
    except ContradictionError as error:
        if not earlier:
            raise
        refusal = error
    try:
        return _solve(intrinsics_of, spec, _apart(views, earlier))
    except ConfigError:
        # this step's own views may be too few for their own error message
        if isinstance(refusal, MirroredError):
            raise refusal from None
        raise


def _solve(
    intrinsics_of: Mapping[str, Intrinsics], spec: BoardSpec, views: Views
) -> tuple[SceneExtrinsics, WorldExtrinsics]:
    chosen = {
        name: _choose(name, intrinsics.size_px, views) for name, intrinsics in intrinsics_of.items()
    }
    measured = _measured_intrinsics(
        list(intrinsics_of.values()), [_alone(name, views) for name in intrinsics_of]
    )
    bundle = replace(PARAMS.bundle, priors=IntrinsicsPriors(measured=measured))
    extrinsics = solve_extrinsics(intrinsics_of, chosen, spec, replace(PARAMS, bundle=bundle))
    return extrinsics, place_in_world(extrinsics, None, "", PARAMS)


def _alone(name: str, views: Views) -> list[BoardView]:
    """This camera's views without a counterpart in other cameras."""
    others = {i for other, own in views.items() if other != name for i in own}
    return [view for index, view in views[name].items() if index not in others]


def _choose(name: str, size_px: tuple[int, int], views: Views) -> dict[int, BoardView]:
    """All views in common with other cameras, and the best of the other ones."""
    alone = _alone(name, views)
    chosen = {view.index for view in choose_views(alone, size_px, _ALONE)}
    dropped = {view.index for view in alone} - chosen
    return {index: view for index, view in views[name].items() if index not in dropped}


def _measured_intrinsics(
    measured: Sequence[Intrinsics], alone: Sequence[Sequence[BoardView]]
) -> MeasuredIntrinsics:
    """Prior for intrinsics without pictures of their own: near their measured values."""
    rows = np.stack([intrinsics_row(intrinsics.K, intrinsics.dist) for intrinsics in measured])
    deviation = np.full(rows.shape, np.inf)
    for i, (intrinsics, views) in enumerate(zip(measured, alone, strict=True)):
        if len(views) >= _OWN_VIEWS:
            continue
        focal = max(
            intrinsics.focal_deviation if np.isfinite(intrinsics.focal_deviation) else 0.005, 0.001
        )
        deviation[i, :2] = focal * rows[i, :2]
        deviation[i, 2:4] = _MIDDLE * intrinsics.size_px[0]
        deviation[i, 4:] = _DIST
    return MeasuredIntrinsics(rows, deviation)


def _apart(views: Views, earlier: frozenset[int]) -> dict[str, dict[int, BoardView]]:
    """The same views, with those of earlier sightings separate for each camera."""
    free = 1 + max((index for own in views.values() for index in own), default=0)
    out: dict[str, dict[int, BoardView]] = {}
    for name, own in views.items():
        out[name] = {}
        for index, view in own.items():
            if index in earlier:
                free += 2
                out[name][free] = replace(view, index=free)
            else:
                out[name][index] = view
    return out
