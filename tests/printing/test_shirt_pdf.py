"""The shirt's pattern has the stated sizes, patches where the standard puts them, and true colours."""

from functools import cache

import numpy as np
import pytest

from mocapd.errors import ConfigError
from mocapd.printing.cielab import lab_from_srgb
from mocapd.printing.shirt_drawing import centre_of
from mocapd.printing.shirt_pattern import (
    EASE_MM,
    HEM_MM,
    SEAM_MM,
    SIZES,
    Piece,
    measures_of,
    offset,
    pieces_of,
)
from mocapd.printing.shirt_pdf import shirt_pdf as shirt_pdf_anew
from mocapd.printing.shirt_tiles import EDGE_MM, FOOT_MM, tiling_of
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.types import Floats
from tests.printing.printed import pages, printed, text

SHIRT = standard_shirt()
shirt_pdf = cache(shirt_pdf_anew)


def area(polygon: Floats) -> float:
    """Positive when counter-clockwise."""
    x, y = polygon.T
    return float(0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def length(curve: Floats) -> float:
    return float(np.linalg.norm(np.diff(curve, axis=0), axis=1).sum())


def patch_centres(piece: Piece) -> dict[str, tuple[float, float]]:
    return {SHIRT.patch_names[p.index - 1]: centre_of(p.outline) for p in piece.patches}


@pytest.mark.parametrize(
    ("srgb", "lab"),
    [  # the published CIELAB (D65) of sRGB's corners, and of its middle grey
        ([255, 0, 0], [53.24, 80.09, 67.20]),
        ([0, 255, 0], [87.73, -86.18, 83.18]),
        ([0, 0, 255], [32.30, 79.19, -107.86]),
        ([255, 255, 255], [100.0, 0.0, 0.0]),
        ([119, 119, 119], [50.03, 0.0, 0.0]),
        ([0, 0, 0], [0.0, 0.0, 0.0]),
        ([1, 1, 1], [0.2742, 0.0, 0.0]),  # on the straight part of the curve
    ],
)
def test_cielab_of_known_colours(srgb: list[int], lab: list[float]) -> None:
    assert lab_from_srgb(srgb) == pytest.approx(lab, abs=0.03)


@pytest.mark.parametrize("size", SIZES)
def test_the_pieces_have_the_stated_size(size: str) -> None:
    measures = measures_of(size)
    front, back, *sleeves = pieces_of(measures)
    # front and back close round the chest
    assert front.size_mm[0] + back.size_mm[0] == pytest.approx(measures.chest + EASE_MM)
    for sleeve in sleeves:
        assert sleeve.size_mm[0] == pytest.approx(measures.armhole)
        bottom = sleeve.outline[sleeve.outline[:, 1] == sleeve.outline[:, 1].min()]
        assert np.ptp(bottom[:, 0]) == pytest.approx(measures.cuff)
    # it covers the arm to the wrist and the torso to the hips, as adults are built
    assert 0.26 < sleeves[0].size_mm[1] / measures.stature < 0.32
    assert 0.28 < front.size_mm[1] / measures.stature < 0.33


@pytest.mark.parametrize("size", SIZES)
def test_the_patches_cover_each_piece_once(size: str) -> None:
    pieces = pieces_of(measures_of(size))
    assert sorted(p.index for piece in pieces for p in piece.patches) == list(range(1, 21))
    for piece in pieces:
        assert min(area(p.outline) for p in piece.patches) > 5e3
        assert sum(area(p.outline) for p in piece.patches) == pytest.approx(area(piece.outline))
        assert sum(area(p.cloth) for p in piece.patches) == pytest.approx(area(piece.cut))


@pytest.mark.parametrize("size", SIZES)
def test_seams_that_meet_are_of_one_length(size: str) -> None:
    """The half of a sleeve's cap is as long as the armhole; front and back are of one height."""
    front, back, left, right = pieces_of(measures_of(size))
    for sleeve in (left, right):
        # from the armpit, where it is widest, up to the fold
        begin, end = np.argmax(sleeve.outline[:, 0]), np.argmax(sleeve.outline[:, 1])
        cap = sleeve.outline[begin : end + 1]
        for torso in (front, back):
            # the first point is at the hem, the second the armpit
            armhole = torso.outline[1 : 1 + len(cap)]
            assert length(armhole) == pytest.approx(length(cap))
            assert np.ptp(armhole[:, 1]) == pytest.approx(sleeve.size_mm[0] / 2)
    assert front.outline[1] == pytest.approx(back.outline[1])


def test_patches_are_where_the_standard_puts_them() -> None:
    front, back, left, right = (patch_centres(piece) for piece in pieces_of(measures_of("M")))
    for level in ("upper", "lower"):
        # seen from outside
        assert front[f"torso_front_{level}_left"][0] > 0 > front[f"torso_front_{level}_right"][0]
        assert back[f"torso_back_{level}_left"][0] < 0 < back[f"torso_back_{level}_right"][0]
    assert front["torso_front_upper_left"][1] > front["torso_front_lower_left"][1]
    for bone in ("upper_arm", "forearm"):
        # Shoulder up and outside towards the reader, thumbs forward: to the left of the fold is the
        # front of a left sleeve and the back of a right one.
        assert left[f"left_{bone}_front"][0] < 0 < left[f"left_{bone}_back"][0]
        assert right[f"right_{bone}_back"][0] < 0 < right[f"right_{bone}_front"][0]
    down = [
        left[f"left_{name}"][1] for name in ("shoulder", "upper_arm_front", "forearm_front", "cuff")
    ]
    assert down == sorted(down, reverse=True)


def test_the_allowance_is_as_wide_as_it_says() -> None:
    square = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 50.0], [50.0, 50.0], [0.0, 50.0]])
    moved = offset(square, np.array([30.0, 10.0, 10.0, 10.0, 10.0]))
    assert moved == pytest.approx(
        np.array([[-10.0, -30.0], [110.0, -30.0], [110.0, 60.0], [50.0, 60.0], [-10.0, 60.0]])
    )
    for piece in pieces_of(measures_of("L")):
        grown = np.ptp(piece.cut, axis=0) - piece.size_mm
        assert grown[0] == pytest.approx(2 * SEAM_MM, abs=0.5)
        assert piece.outline[:, 1].min() - piece.cut[:, 1].min() == pytest.approx(HEM_MM)


@pytest.mark.parametrize("size", ["S", "XXL"])
def test_printed_cloth_is_of_true_size_and_colour(size: str) -> None:
    pdf = shirt_pdf(size, layout="printing")
    pieces = pieces_of(measures_of(size))
    assert pages(pdf) == 2 + len(pieces)
    for number, piece in enumerate(pieces):
        sheet = printed(pdf, 2 + number, 2.0)
        ink = sheet.pixels.min(axis=-1) < 250
        rows, columns = np.flatnonzero(ink.any(axis=1)), np.flatnonzero(ink.any(axis=0))
        found_mm = np.array([np.ptp(columns) + 1, np.ptp(rows) + 1]) / sheet.px_per_mm
        # half of the line is outside, and pixels are whole
        assert np.abs(found_mm - 0.3 - np.ptp(piece.cut, axis=0)).max() < 1.0
        low = piece.cut.min(axis=0) - 10.0
        for patch in piece.patches:
            at = np.array(centre_of(patch.outline)) - low
            colour = SHIRT.srgb[SHIRT.colour_of_patch[patch.index] - 1]
            assert (sheet.part(at - 5, (10, 10)) == colour).all()


@pytest.mark.parametrize("paper", ["A4", "Letter", "A3"])
def test_tiles_join_to_a_piece_of_true_size(paper: str) -> None:
    """Cut along the frames and laid side by side, the pages show each patch where it is."""
    pdf = shirt_pdf("M", paper)
    page, patches_seen = 2, 0
    for piece in pieces_of(measures_of("M")):
        tiling = tiling_of(piece.cut, paper)
        inked = 0.0
        shown = {}
        for tile in tiling.tiles():
            sheet = printed(pdf, page, 1.0)
            page += 1
            inside = sheet.part((EDGE_MM, EDGE_MM + FOOT_MM), tiling.frame_mm)
            # the tints are coloured, all else is grey
            inked += float((np.ptp(inside.astype(int), axis=-1) > 8).sum() / sheet.px_per_mm.prod())
            for patch in piece.patches:
                # above the words in the middle of the patch
                at = np.array(centre_of(patch.outline)) + [0.0, 22.0] - tile.corner_mm
                if (at > 6).all() and (at < np.array(tiling.frame_mm) - 6).all():
                    spot = sheet.part(at + [EDGE_MM + 1, EDGE_MM + FOOT_MM], (3, 3))
                    shown[patch.index] = np.median(spot, axis=(0, 1))
        # but for lines, marks and words: the area of the cloth
        assert 0.95 < inked / area(piece.cut) < 1.005
        patches_seen += len(shown)
        for index, colour in shown.items():
            tint = 255 - 0.25 * (255 - SHIRT.srgb[SHIRT.colour_of_patch[index] - 1].astype(float))
            assert np.abs(colour - tint).max() <= 1.0
    assert page == pages(pdf)
    assert patches_seen >= 10  # the others are near a frame


def test_each_page_says_which_it_is() -> None:
    pdf = shirt_pdf("M")
    last = pages(pdf)
    first, final = (" ".join(text(pdf, page).split()) for page in (2, last - 1))
    assert f"size M · torso front · A1: row 1 of 3, column 1 of 3 · page 3 of {last}" in first
    assert f"size M · right sleeve · D2: row 4 of 4, column 2 of 2 · page {last} of {last}" in final


def test_swatches_are_of_the_exact_colours() -> None:
    pdf = shirt_pdf("M")
    sheet = printed(pdf, 1, 3.0)
    words = text(pdf, 1)
    for colour, (name, srgb) in enumerate(zip(SHIRT.colour_names, SHIRT.srgb, strict=True)):
        exact = (sheet.pixels == srgb).all(axis=-1)
        assert exact.sum() / np.prod(sheet.px_per_mm) > 40 * 25  # mm2
        assert f"{colour + 1} {name}" in words
        assert "sRGB {} {} {}".format(*srgb) in words
        assert f"L* {lab_from_srgb(srgb)[0]:.1f}" in words


def test_the_overview_names_every_patch_and_the_size() -> None:
    words = text(shirt_pdf("xl"), 0)
    assert "size XL" in words
    assert "chest 114 cm" in words
    for name in SHIRT.patch_names:
        assert name.replace("_", " ") in words


def test_the_same_size_gives_the_same_bytes() -> None:
    assert shirt_pdf("M") == shirt_pdf_anew("M")


def test_what_does_not_exist_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"no size 'XS'.*S, M, L, XL, XXL"):
        shirt_pdf("XS")
    with pytest.raises(ConfigError, match="no paper 'B4'"):
        shirt_pdf("M", "B4")
    with pytest.raises(ConfigError, match="no layout 'knitting'"):
        shirt_pdf("M", layout="knitting")
