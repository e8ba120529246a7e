"""Penalties and scores: as a naive twin has them, and neutral towards what cannot be seen."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.published.hecht2009.cylinders.limb_params import LimbScoreParams
from mocapd.published.hecht2009.cylinders.limb_score import (
    EDGE,
    SURFACE,
    LimbView,
    Penalties,
    UsualPenalties,
    learn_usual,
    limb_penalties,
    log_scores,
)
from mocapd.published.hecht2009.cylinders.occlusion import allocate_occlusion, fill_occlusion
from mocapd.published.hecht2009.cylinders.work_camera import work_camera
from mocapd.published.hecht2009.edge_kernels import FULL
from mocapd.types import Camera, Floats
from tests.published.hecht2009.cylinders.naive import (
    ENDS_M,
    LEFT_ARM,
    RADII_M,
    WORK_PX,
    camera,
    limb_of,
    naive_penalties,
    score_limbs,
)

PARAMS = LimbScoreParams()
ARM_RADII_M = RADII_M[list(LEFT_ARM)]


def view_of(of: Camera, index: int = 0, seed: int = 0) -> tuple[LimbView, tuple[Floats, Floats]]:
    """A view of noise, and the quads and depths of the body's parts in it."""
    rng = np.random.default_rng(seed)
    width, height = WORK_PX
    occlusion = allocate_occlusion(len(ENDS_M), WORK_PX, PARAMS.cell_px)
    body = fill_occlusion(occlusion, work_camera(of, WORK_PX), ENDS_M, RADII_M)
    reference = rng.uniform(20.0, 230.0, (len(ENDS_M), PARAMS.along, 3)).astype(np.float32)
    reference[LEFT_ARM[0], 3:5] = np.nan
    turn = rng.uniform(0.0, 6.3, (height, width))
    strength = rng.uniform(0.0, 1.2 * FULL, (height, width))
    edges = strength[..., None] * np.stack([np.ones_like(turn), np.cos(turn), np.sin(turn)], -1)
    return LimbView(
        index, work_camera(of, WORK_PX), rng.integers(0, 255, (height, width, 3)).astype(np.uint8),
        edges.astype(np.int16), np.zeros((height // 4, width // 4), np.uint8), reference, occlusion,
    ), body  # fmt: skip


def particles(n: int, sd_m: float, seed: int = 1) -> Floats:
    out: Floats = limb_of(ENDS_M, LEFT_ARM) + np.random.default_rng(seed).normal(
        0.0, sd_m, (n, 3, 3)
    )
    return out


@pytest.mark.parametrize(
    "params", [PARAMS, replace(PARAMS, shading=0.0), replace(PARAMS, along=5, across=3)]
)
def test_penalties_are_those_of_the_naive_twin(params: LimbScoreParams) -> None:
    of = camera(0.9)
    view, body = view_of(of)
    view = replace(view, reference=view.reference[:, : params.along])
    points = particles(25, 0.25)
    points[0] += [1.5, 0.0, 0.0]  # half outside of the picture
    points[1] += [0.0, 0.0, -0.4]  # behind the trunk in part
    got = limb_penalties(points, ARM_RADII_M, LEFT_ARM, [view], params)
    for n, limb in enumerate(points):
        mean, seen = naive_penalties(of, limb, LEFT_ARM, body, view, params)
        assert got.mean[0, n] == pytest.approx(mean, abs=1e-5)
        assert got.visible[0, n] == pytest.approx(seen, abs=1e-9)


def test_a_perfect_picture_costs_nothing_and_its_opposite_most() -> None:
    view, _ = view_of(camera())
    limb = limb_of(ENDS_M, LEFT_ARM)[None]
    full = np.zeros_like(view.edges)
    full[..., 0] = 2 * FULL  # whichever way it runs
    params = replace(PARAMS, occlusion=False)
    for grey, edges, expected in ((100, full, 0.0), (255, np.zeros_like(full), 1.0)):
        reference = np.full_like(view.reference, 100.0)
        seen = replace(
            view, colour=np.full_like(view.colour, grey), edges=edges, reference=reference
        )
        got = limb_penalties(limb, ARM_RADII_M, LEFT_ARM, [seen], params)
        assert got.mean == pytest.approx(np.full((1, 1, 2), expected), abs=1e-6)


def test_edges_count_where_they_run_along_the_limb() -> None:
    view, _ = view_of(camera())
    hanging = np.array([[[0.4, 1.4, 0.0], [0.4, 1.1, 0.0], [0.4, 0.8, 0.0]]])
    vertical, horizontal = np.zeros_like(view.edges), np.zeros_like(view.edges)
    vertical[...] = [FULL, FULL, 0]  # their gradient runs along x
    horizontal[...] = [FULL, -FULL, 0]
    along = limb_penalties(hanging, ARM_RADII_M, LEFT_ARM, [replace(view, edges=vertical)], PARAMS)
    across = limb_penalties(
        hanging, ARM_RADII_M, LEFT_ARM, [replace(view, edges=horizontal)], PARAMS
    )
    assert along.mean[0, 0, EDGE] < 0.02
    assert across.mean[0, 0, EDGE] > 0.9


def test_a_colour_in_shade_is_the_same_colour_and_another_hue_is_not() -> None:
    view, _ = view_of(camera())
    reference = np.broadcast_to(
        np.array([40.0, 80.0, 160.0], np.float32), view.reference.shape
    ).copy()
    limb = limb_of(ENDS_M, LEFT_ARM)[None]
    penalty = []
    for bgr in ((28, 56, 112), (100, 90, 90)):
        colour = np.broadcast_to(np.array(bgr, np.uint8), view.colour.shape).copy()
        seen = replace(view, colour=colour, reference=reference)
        penalty.append(
            limb_penalties(limb, ARM_RADII_M, LEFT_ARM, [seen], PARAMS).mean[0, 0, SURFACE]
        )
    assert penalty[0] < 0.05
    assert penalty[1] > 0.9


def test_a_limb_that_no_view_sees_costs_what_is_said_of_hidden_ones() -> None:
    views = [view_of(camera(x), i)[0] for i, x in enumerate((-0.5, 0.5))]
    usual = UsualPenalties(np.array([[0.1, 0.2], [0.3, 0.4]]), np.zeros((2, 2)))
    behind = particles(3, 0.0) + [0.0, 0.0, 9.0]
    got = score_limbs(behind, ARM_RADII_M, LEFT_ARM, views, usual, PARAMS)
    each = usual.mean.sum(axis=0) + 2 * PARAMS.hidden_surplus
    expected = -(PARAMS.edge_weight * each[EDGE] + PARAMS.surface_weight * each[SURFACE])
    assert got == pytest.approx(np.full(3, expected))


def test_a_hidden_limb_lies_between_a_good_and_a_bad_one() -> None:
    views = [view_of(camera())[0]]
    usual = UsualPenalties(np.array([[0.2, 0.2]]), np.zeros((1, 2)))
    mean = np.array([[[0.2, 0.2], [0.9, 0.9], [0.6, 0.6]]])
    seen = np.array([[[0.9, 0.9], [0.0, 0.0], [0.9, 0.9]]])
    good, hidden, bad = log_scores(Penalties(mean, seen), usual, views, PARAMS)
    assert good > hidden > bad


def test_switches_leave_out_what_they_name() -> None:
    view, _ = view_of(camera())
    usual = UsualPenalties.initial(1, PARAMS)
    points = particles(30, 0.1) + [0.0, 0.0, -0.3]

    def scores(params: LimbScoreParams, view: LimbView = view) -> Floats:
        return score_limbs(points, ARM_RADII_M, LEFT_ARM, [view], usual, params)

    other_colours = replace(view, colour=255 - view.colour)
    edges_alone = replace(PARAMS, appearance=False)
    assert (scores(edges_alone) == scores(edges_alone, other_colours)).all()
    assert (scores(PARAMS) != scores(PARAMS, other_colours)).any()
    nobody = allocate_occlusion(len(ENDS_M), WORK_PX, PARAMS.cell_px)
    see_through, unhidden = replace(PARAMS, occlusion=False), replace(view, occlusion=nobody)
    assert (scores(PARAMS) != scores(PARAMS, unhidden)).any()
    assert (scores(see_through) == scores(see_through, unhidden)).all()
    assert (scores(see_through) != scores(PARAMS, unhidden)).any()  # of those that fold
    points[:, 2] = 2.0 * points[:, 1] - points[:, 0]  # straight
    assert (scores(see_through) == scores(PARAMS, unhidden)).all()


def test_what_is_usual_is_the_mean_at_first_and_waits_while_the_limb_is_hidden() -> None:
    views = [view_of(camera())[0]]
    usual = UsualPenalties.initial(1, PARAMS)
    half = np.array([0.5, 0.5])

    def looked(usual: UsualPenalties, penalty: float, seen: float) -> UsualPenalties:
        of = Penalties(np.full((1, 2, 2), penalty), np.full((1, 2, 2), seen))
        return learn_usual(usual, of, half, views, 0.1, PARAMS)

    usual = looked(looked(usual, 0.1, 1.0), 0.3, 1.0)
    assert usual.mean == pytest.approx(np.full((1, 2), 0.2))
    assert (looked(usual, 0.9, 0.2).mean == usual.mean).all()
    for _ in range(200):
        usual = looked(usual, 0.6, 1.0)
    assert usual.mean == pytest.approx(np.full((1, 2), 0.6), abs=1e-3)
