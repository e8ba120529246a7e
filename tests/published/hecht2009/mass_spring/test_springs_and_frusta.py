"""Springs, their lengths, and the cylinder model."""

import numpy as np
import pytest

from mocapd.body.shape import BodyShape, mean_shape
from mocapd.body.skeleton import INDEX
from mocapd.published.hecht2009.mass_spring.body_points import (
    HEAD,
    LIMBS,
    N_POINTS,
)
from mocapd.published.hecht2009.mass_spring.constraint_kernels import sweep_springs
from mocapd.published.hecht2009.mass_spring.frusta import CHIN, CROWN, MID_WAIST, N_ENDS, NAMES
from mocapd.published.hecht2009.mass_spring.mass_spring_body import build_body
from mocapd.published.hecht2009.mass_spring.springs import COMPLIANCE, ENDS
from tests.published.hecht2009.mass_spring.naive_constraints import MIRROR

BODY = build_body(mean_shape(1.75))
N_SPRINGS = 24


def test_the_papers_sixteen_points_and_twenty_four_springs() -> None:
    assert ENDS.shape == (N_SPRINGS, 2)
    pairs = {frozenset(pair) for pair in ENDS.tolist()}
    assert len(pairs) == N_SPRINGS
    assert set(ENDS.ravel().tolist()) == set(range(N_POINTS))
    # each limb is a chain
    for a, b, c in LIMBS.values():
        assert frozenset((a, b)) in pairs
        assert frozenset((b, c)) in pairs


def test_the_body_is_symmetric() -> None:
    assert (MIRROR[MIRROR] == np.arange(N_POINTS)).all()
    mirrored = (BODY.rest_m * [-1.0, 1.0, 1.0])[MIRROR]
    assert np.abs(mirrored - BODY.rest_m).max() < 1e-12
    ends = ENDS.tolist()
    values = zip(BODY.constraints.lengths, COMPLIANCE, strict=True)
    of_pair = {frozenset(pair): value for pair, value in zip(ends, values, strict=True)}
    for pair in ends:
        assert of_pair[frozenset(MIRROR[pair].tolist())] == pytest.approx(of_pair[frozenset(pair)])
    assert (BODY.mass_kg[MIRROR] == BODY.mass_kg).all()


def test_a_persons_mass_without_the_head() -> None:
    assert np.isinf(BODY.mass_kg[HEAD])
    assert BODY.mass_kg[1:].sum() == pytest.approx(70.0 * 0.93, rel=0.15)


def test_a_spring_whose_ends_are_one_point_parts_them() -> None:
    points = np.ones((2, 3))
    sweep_springs(
        points, np.array([1.0, 3.0]), np.array([[0, 1]]), np.array([0.4]), np.zeros(1), np.full(1, 0.25),
        np.array([0]), np.zeros(1),
    )  # fmt: skip
    # as long as it should be, the lighter end having moved three times as far
    assert np.linalg.norm(points[1] - points[0]) == pytest.approx(0.4)
    assert np.linalg.norm(points[1] - 1.0) == pytest.approx(0.3)


def test_frusta_cover_the_limbs() -> None:
    frusta = BODY.frusta
    assert len(NAMES) == len(frusta.index) == 11
    ends = frusta.ends_of(BODY.rest_m)
    assert ends.shape == (N_ENDS, 3)
    by_name = {name: tuple(frusta.index[k]) for k, name in enumerate(NAMES)}
    for name, (a, b, c) in LIMBS.items():
        side = name.split("_")[0]
        upper, lower = ("upper_arm", "forearm") if "arm" in name else ("thigh", "shank")
        assert by_name[f"{side}_{upper}"] == (a, b)
        assert by_name[f"{side}_{lower}"] == (b, c)
    # parts of the trunk meet at the waist
    assert by_name["upper_trunk"][1] == by_name["lower_trunk"][0] == MID_WAIST
    # the crown is as high as the person
    assert ends[CROWN, 1] == pytest.approx(1.75, abs=0.03)
    head = BODY.skeleton.rest_m[INDEX["head"]] + np.array([0.0, 0.050, 0.020]) * 1.75
    assert np.abs(0.5 * (ends[CHIN] + ends[CROWN]) - head).max() < 1e-9
    assert ends[CROWN, 1] - ends[CHIN, 1] == pytest.approx(0.13 * 1.75, abs=0.01)


def test_radii_are_those_of_a_person_and_taper() -> None:
    frusta = BODY.frusta
    start = dict(zip(NAMES, frusta.radii_m[:, 0], strict=True))
    end = dict(zip(NAMES, frusta.radii_m[:, 1], strict=True))
    for name, low, high in (
        ("left_upper_arm", 0.045, 0.08), ("left_forearm", 0.025, 0.06), ("left_thigh", 0.06, 0.13),
        ("left_shank", 0.035, 0.085), ("upper_trunk", 0.12, 0.2), ("head", 0.05, 0.11),
    ):  # fmt: skip
        assert low < end[name] <= start[name] < high


def test_girth_makes_limbs_thicker() -> None:
    factors = np.ones(12)
    factors[6], factors[10] = 1.2, 1.3
    thick = build_body(BodyShape(1.75, factors)).frusta
    ratio = thick.radii_m[:, 0] / BODY.frusta.radii_m[:, 0]
    assert ratio[3:7] == pytest.approx(1.2, abs=0.02)
    assert ratio[7:] == pytest.approx(1.3, abs=0.02)


def test_ends_of_many_bodies_at_once() -> None:
    rng = np.random.default_rng(0)
    many = BODY.rest_m + 0.1 * rng.normal(size=(4, 5, N_POINTS, 3))
    ends = BODY.frusta.ends_of(many)
    assert ends.shape == (4, 5, N_ENDS, 3)
    assert np.abs(ends[2, 3] - BODY.frusta.ends_of(many[2, 3])).max() < 1e-12
