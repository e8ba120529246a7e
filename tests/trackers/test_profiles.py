"""Which cues the registry builds a profile of: what the rig and the clothes suit, and what it reports."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mocapd.calibration.calibration_record import Calibration, Wearer
from mocapd.errors import ConfigError
from mocapd.geometry.nominal_rig import nominal_rig
from mocapd.shirt.pose_database.cache_name import CACHE_NAME
from mocapd.trackers import registry
from mocapd.trackers.registry import PROFILES, Resources, build, has_caches, shirt_tracker
from mocapd.tracking.build import ProfileParams
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.types import Rig

NO_SHIRT = Wearer(1.7, has_shirt=False)


def known(*places_m: float, wearer: Wearer | None = None) -> Calibration:
    """Cameras side by side, at these places along x."""
    one = nominal_rig("cam0", (320, 240)).cameras[0]
    cameras = [
        replace(one, name=f"cam{i}", t_m=one.t_m - one.R @ np.array([x, 0.0, 0.0]))
        for i, x in enumerate(places_m)
    ]
    return Calibration(Rig(tuple(cameras)), wearer or Wearer(1.7))


@pytest.fixture
def cues(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, bool, bool, ProfileParams | None]]:
    """Of each body tracker that is built: the profile, whether it has the shirt, whether clothes; its params."""
    built = []

    def build_it(name, _known, database, clothes, params, *_):  # type: ignore[no-untyped-def]
        built.append((name, database is not None, clothes, params))

    monkeypatch.setattr("mocapd.tracking.build.build_body_tracker", build_it)
    monkeypatch.setattr(registry, "_database", lambda _: "database")
    return built


@pytest.mark.parametrize(
    ("name", "calibration", "shirt", "clothes"),
    [
        ("auto", known(0.0), True, True),
        # where the floor is, nobody knows
        ("auto", replace(known(0.0), assumes_rig=True), True, False),
        ("auto", known(0.0, 0.2), True, True),
        ("auto", known(0.0, 0.2, wearer=NO_SHIRT), False, True),
        ("shirt", known(0.0), True, False),
        ("shirt", known(0.0, 0.2), True, False),
        ("markerless", known(0.0, 0.2), False, True),
    ],
)
def test_a_profile_has_the_cues_that_rig_and_clothes_suit(
    cues: list[tuple[str, bool, bool, ProfileParams | None]],
    name: str,
    calibration: Calibration,
    shirt: bool,
    clothes: bool,
) -> None:
    messages: list[str] = []
    build(name, calibration, Resources(warn=messages.append))
    assert cues == [(name, shirt, clothes, None)]
    assert messages == []


def test_a_pair_in_one_place_tracks_the_shirt_only_and_one_message_says_so(
    cues: list[tuple[str, bool, bool, ProfileParams | None]],
) -> None:
    messages: list[str] = []
    build("auto", known(0.0, 0.0), Resources(warn=messages.append))
    assert cues == [("auto", True, True, None)]
    (message,) = messages
    assert "only somebody in the shirt" in message
    assert "all are in one" in message


@pytest.mark.kernels
def test_somebody_without_a_shirt_needs_no_pose_database(tmp_path: Path) -> None:
    assert build("auto", known(0.0, 0.2, wearer=NO_SHIRT), Resources(tmp_path)).name == "auto"
    assert not (tmp_path / CACHE_NAME).exists()


def test_without_a_shirt_one_camera_does_not_do(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"'auto'.*needs two"):
        build("auto", known(0.0, wearer=NO_SHIRT), Resources(tmp_path))


def test_a_study_gives_a_profile_other_numbers(
    cues: list[tuple[str, bool, bool, ProfileParams | None]],
) -> None:
    other = ProfileParams(clothes=replace(ClothesParams(), live_explained=0.33))
    build("auto", known(0.0, 0.2, wearer=NO_SHIRT), Resources(params={"auto": other}))
    assert cues[0][3] is other


def test_a_setup_measures_with_the_shirts_own_tracker_and_finds_its_cache(tmp_path: Path) -> None:
    assert shirt_tracker("auto") == "shirt"
    for name, profile in PROFILES.items():
        assert has_caches(name, tmp_path) is not profile.shirt
    (tmp_path / CACHE_NAME).write_bytes(b"")
    assert has_caches("auto", tmp_path)
