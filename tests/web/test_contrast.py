"""The page's colours can be told apart: WCAG 2.2 AA, 4.5:1 for text, in light and dark."""

import re

import pytest

from mocapd.web.app import PAGE_DIR

TEXT = [
    ("text", "page"), ("text", "panel"), ("text", "accent-soft"), ("text-soft", "page"),
    ("text-soft", "panel"), ("accent", "panel"), ("accent", "page"), ("accent", "accent-soft"),
    ("on-accent", "accent"), ("good", "page"), ("good", "panel"), ("good", "good-soft"),
    ("bad", "page"), ("bad", "panel"), ("bad", "bad-soft"), ("work", "work-soft"),
    ("plot-a", "panel"), ("plot-b", "panel"),
]  # fmt: skip
GRAPHICS = [("focus", "page"), ("focus", "panel"), ("text-soft", "panel")]


def variables(css: str) -> dict[str, str]:
    return dict(re.findall(r"--([\w-]+): (#[0-9a-f]{3,6})\b", css))


def schemes() -> dict[str, dict[str, str]]:
    css = (PAGE_DIR / "style.css").read_text()
    light, _, dark = css.partition("@media (prefers-color-scheme: dark)")
    return {"light": variables(light), "dark": variables(light) | variables(dark)}


def luminance(colour: str) -> float:
    """Relative luminance of WCAG 2.2."""
    digits = colour.removeprefix("#")
    if len(digits) == 3:
        digits = "".join(2 * digit for digit in digits)
    rgb = [int(digits[i : i + 2], 16) / 255 for i in (0, 2, 4)]
    r, g, b = ((v / 12.92) if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in rgb)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


def contrast(one: str, other: str) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_the_measure_knows_black_on_white() -> None:
    assert contrast("#000", "#fff") == pytest.approx(21.0)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_texts_and_signs_stand_out(scheme: str) -> None:
    colours = schemes()[scheme]
    for least, pairs in ((4.5, TEXT), (3.0, GRAPHICS)):
        for front, back in pairs:
            reached = contrast(colours[front], colours[back])
            assert reached >= least, f"{front} on {back}: {reached:.2f}"
