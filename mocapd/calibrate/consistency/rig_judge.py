"""Checks a rig against its cameras' views of people, and searches for a mistake that explains a contradiction."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from mocapd.calibrate.consistency.findings import CaptureFinding, Mistake
from mocapd.calibrate.consistency.hypotheses import (
    Hypothesis,
    as_given,
    hypotheses,
    shifted_zooms,
    zooms,
)
from mocapd.calibrate.consistency.person_views import PersonView
from mocapd.calibrate.consistency.view_agreement import PairFit, fit_pair, thin_view
from mocapd.types import Camera

Stretch = Sequence[Sequence[PersonView]]  # by camera, its people in a few seconds
_Pair = tuple[int, int, int]  # of cameras, in a stretch

_WELL = 0.6  # cost of two views that leaves nothing to improve
_FITS = 1.5  # cost of two views above which they are of no use, or do not agree
_GAIN = 0.3  # least mean gain in cost of an explanation
_ZOOM_GAIN = 0.2
_AGREES = 1.0  # cost of two views that agree, whatever may be better
_AGAINST = 0.2  # a larger share of views that agree as given excludes a mistake
_RIVAL = 0.75  # of the best zoom's gain; another camera's with more is an alternative
_OFTEN = 0.65  # least share of stretches that an explanation must improve
# Limits of angles between views of people that contradict each other: with the same motion in both, and without
_CONTRADICT_DEG, _STRANGE_DEG = 1.8, 1.0
_LEAST_STRETCHES = 2
_LEAST_FOR_ZOOM = 3  # views that fit, for a mistake with free numbers


@dataclass(frozen=True, slots=True, eq=False)
class RigVerdict:
    """findings: the contradictions; fits: of the views, corrected by the best explanation; off_m: distance between
    views where nothing explains it [m]."""

    findings: tuple[CaptureFinding, ...]
    fits: tuple[PairFit, ...]
    off_m: float = 0.0


def judge(
    cameras: Sequence[Camera], stretches: Sequence[Stretch], moves_alike: Sequence[bool] = ()
) -> RigVerdict:
    """Checks given cameras against their views. No finding where they have too little in common. moves_alike: by
    camera, whether its motion coincides with the others'; all do by default."""
    table = _Table([[[thin_view(view) for view in views] for views in part] for part in stretches])
    given = table.fits(as_given(cameras))
    if not given:
        return RigVerdict((), ())
    best = _best_explanation(cameras, table, given)
    if best is not None:
        names = tuple(cameras[i].name for i in best.affected)
        assert best.mistake is not None
        finding = CaptureFinding(best.mistake, names, best.what, best.fix)
        return RigVerdict((finding,), tuple(table.fits(best).values()), _off_m(given.values()))
    lone = tuple(_contradicting(cameras, given, moves_alike or (True,) * len(cameras)))
    return RigVerdict(lone, tuple(given.values()), _off_m(given.values()) if lone else 0.0)


class _Table:
    """Fits of pairs of views under hypotheses."""

    def __init__(self, stretches: Sequence[Stretch]) -> None:
        self._stretches = stretches

    def fits(
        self, hypothesis: Hypothesis, given: Mapping[_Pair, PairFit] | None = None
    ) -> dict[_Pair, PairFit]:
        """For each two cameras in each stretch the two people that agree best; `given`: reused for unaffected pairs."""
        out: dict[_Pair, PairFit] = {}
        for k, stretch in enumerate(self._stretches):
            mended = [
                [mend(view) for view in views]
                for mend, views in zip(hypothesis.mends, stretch, strict=True)
            ]
            for i, j in combinations(range(len(stretch)), 2):
                key = (i, j, k)
                if (
                    given is not None
                    and i not in hypothesis.affected
                    and j not in hypothesis.affected
                ):
                    if key in given:
                        out[key] = given[key]
                    continue
                cameras = hypothesis.cameras[i], hypothesis.cameras[j]
                pairs = [fit_pair(cameras, (a, b)) for a in mended[i] for b in mended[j]]
                fits = [fit for fit in pairs if fit is not None]
                if fits:
                    out[key] = min(fits, key=lambda fit: fit.cost)
        return out


def _best_explanation(
    cameras: Sequence[Camera], table: _Table, given: Mapping[_Pair, PairFit]
) -> Hypothesis | None:
    """The mistake with the largest gain, if large enough; None for a correct rig, or without an explanation."""
    count = len(cameras)
    if all(_cost(given, i, j) < _WELL for i, j in combinations(range(count), 2)):
        return None
    best, most = None, 0.0
    for one in hypotheses(cameras):
        if _cost_about(given, one.affected) < _WELL:
            continue
        gain = _gain(one, table.fits(one, given), given, _GAIN)
        if gain > most:
            best, most = one, gain
    # a zoom and its middle are free parameters, which the other mistakes do not have
    zoomed = _best_zoom(cameras, table, given)
    if zoomed is not None and zoomed[1] > 1.15 * most + 0.05:
        return zoomed[0]
    return best


def _best_zoom(
    cameras: Sequence[Camera], table: _Table, given: Mapping[_Pair, PairFit]
) -> tuple[Hypothesis, float] | None:
    """The zoom of one camera with the largest gain, and the gain; names all cameras that may be the zoomed one."""
    gains: list[tuple[Hypothesis, float]] = []
    for i in range(len(cameras)):
        if _cost_about(given, (i,)) < _WELL:
            continue
        zoom, brought = _best_of(zooms(cameras, i), table, given)
        if zoom is None:
            continue
        factor = float(zoom.mends[i].keywords["factor"])  # type: ignore[attr-defined]
        finer, more = _best_of(shifted_zooms(cameras, i, 1.0 / factor), table, given)
        gains.append((finer, more) if finer is not None and more > brought else (zoom, brought))
    if not gains:
        return None
    best, most = max(gains, key=lambda entry: entry[1])
    rivals = [zoom for zoom, brought in gains if brought > _RIVAL * most and zoom is not best]
    if not rivals:
        return best, most
    affected = tuple(sorted({best.affected[0], *(rival.affected[0] for rival in rivals)}))
    return replace(
        best, affected=affected, what="; or ".join(zoom.what for zoom in (best, *rivals))
    ), most


def _best_of(
    some: Iterable[Hypothesis], table: _Table, given: Mapping[_Pair, PairFit]
) -> tuple[Hypothesis | None, float]:
    best, most = None, 0.0
    for hypothesis in some:
        gain = _gain(hypothesis, table.fits(hypothesis, given), given, _ZOOM_GAIN)
        if gain > most:
            best, most = hypothesis, gain
    return best, most


def _gain(
    hypothesis: Hypothesis,
    fits: Mapping[_Pair, PairFit],
    given: Mapping[_Pair, PairFit],
    least: float,
) -> float:
    """The gain of an explanation, summed over pairs of views; 0 for a small gain, or one in too few stretches."""
    gains, costs, against, when = [], [], 0, set()
    for key, before in given.items():
        after = fits.get(key)
        if after is None or not {key[0], key[1]} & set(hypothesis.affected):
            continue
        if min(before.cost, after.cost) < _FITS:
            gains.append(before.cost - after.cost)
            costs.append(after.cost)
            when.add(key[2])
            # one stretch that agrees well as given excludes a lasting mistake
            against += before.cost < _AGREES and gains[-1] < 0.5 * least
    few = len(gains) < _LEAST_FOR_ZOOM if hypothesis.mistake is Mistake.ZOOMED else False
    if few or len(when) < _LEAST_STRETCHES or against > _AGAINST * len(gains):
        return 0.0
    if np.mean([fit.up[1] for fit in fits.values() if np.isfinite(fit.up[1])] or [1.0]) < 0.0:
        return 0.0  # a hypothesis with people upside down explains nothing
    enough = np.mean(gains) >= least and np.mean(np.array(gains) > 0.0) >= _OFTEN
    return float(np.sum(gains)) if enough and np.median(costs) < _FITS else 0.0


def _cost(fits: Mapping[_Pair, PairFit], i: int, j: int) -> float:
    """The median cost of two cameras over stretches; 0 without common views."""
    costs = [fit.cost for key, fit in fits.items() if key[:2] == (i, j)]
    return float(np.median(costs)) if costs else 0.0


def _cost_about(fits: Mapping[_Pair, PairFit], affected: Sequence[int]) -> float:
    """Mean cost of the pairs of some cameras."""
    costs = [fit.cost for key, fit in fits.items() if {key[0], key[1]} & set(affected)]
    return float(np.mean(costs)) if costs else 0.0


def _contradicting(
    cameras: Sequence[Camera], given: Mapping[_Pair, PairFit], moves_alike: Sequence[bool]
) -> Iterator[CaptureFinding]:
    """A camera that never agrees with any other one, for any reason."""
    out = []
    for i, camera in enumerate(cameras):
        mine = [fit for key, fit in given.items() if i in key[:2]]
        off_deg = np.array([fit.angle_deg for fit in mine])
        if len({key[2] for key in given if i in key[:2]}) < _LEAST_STRETCHES:
            continue
        if np.mean([fit.cost < _AGREES for fit in mine]) > _AGAINST:
            continue
        if np.percentile(off_deg, 25) > (_CONTRADICT_DEG if moves_alike[i] else _STRANGE_DEG):
            out.append((i, camera.name, float(np.median(off_deg))))
    if not out:
        return
    names = tuple(name for _, name, _ in out)
    off = max(off for _, _, off in out)
    others = "each other" if len(names) == len(cameras) else "the other cameras"
    never = (
        "" if all(moves_alike[i] for i, _, _ in out) else ", and does not move at the same times"
    )
    yield CaptureFinding(
        Mistake.CONTRADICTION,
        names,
        f"what {' and '.join(map(repr, names))} shows of people contradicts {others} by {off:.1f} degrees{never}; "
        "no exchange, mirror or turn makes it agree",
        "are these the videos of this rig, of one room and one time? Calibrate again where a camera was moved",
    )


def _off_m(fits: Iterable[PairFit]) -> float:
    """Median distance between rays at the body."""
    off = [np.radians(fit.angle_deg) * fit.away_m for fit in fits if np.isfinite(fit.away_m)]
    return float(np.median(off)) if off else 1.0
