"""The wearer's proportions from a few seconds of movement, with calibrated cameras.

Gauss-Newton over the body's shape and the pose of every observation, with the residual rows of the tracker's own
alignment. The Schur complement eliminates the poses from each step, so an observation constrains lengths only where no
other pose explains it. The tracker itself learns frame by frame and cannot undo the influence of a poor frame.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.body.skeleton import local_from_global, standard_skeleton
from mocapd.calibrate.self_calibration.body_rows import (
    BodyRows,
    RowGatherer,
    cost_of,
    least_match_of,
    pictured,
)
from mocapd.clock import seconds
from mocapd.errors import InputError
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState, apply_step, initial_information, step_between
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.fit.work_size import image_scales
from mocapd.shirt.garment import shirt_labels
from mocapd.tracking.base import Track
from mocapd.types import Camera, Floats, FrameSet

_SMALLEST, _LARGEST = 0.6, 1.6  # factors, as in the tracker
_ROUNDS = 8
_AVERAGED = 4  # last rounds: steps end in the noise of whole pixels
_SETTLING = 4  # iterations of every pose before the first round
_RADIUS_PX = 7  # work px, search radius for colours: the poses are nearly right
_LOOSE_S = 0.1  # weight of a pose's prior, as of a prediction over this time
_JOINT_SD_RAD = 0.5  # how far a pose may yield to a change of shape
_LEAST_MATCH = 0.6  # of an inlier observation
_TOLERATED_COST = 1.5  # of an inlier, relative to the median cost
_FEWEST_OBSERVATIONS = 6
# weight of all observations relative to the prior of people's shapes: their errors are correlated
_INDEPENDENT_OBSERVATIONS = 32.0


@dataclass(frozen=True, slots=True, eq=False)
class BodyObservation:
    """The tracked body at one instant, and the evidence of the cameras: views at work resolution."""

    t_ns: int
    state: MotionState
    views: tuple[View, ...]


@dataclass(frozen=True, slots=True, eq=False)
class ShapeFit:
    """factors (N,) of `body.shape`. measured (N,) and information (N,N): from the pictures alone, without the
    prior of people's shapes; states: every observation's pose in this shape; counted: indices of the inliers."""

    factors: Floats
    measured: Floats
    information: Floats
    states: tuple[MotionState, ...]
    counted: tuple[int, ...]


def observe_body(
    track: Track,
    frames: FrameSet,
    model: BodyModel,
    cameras: Sequence[Camera],
    before: BodyObservation | None,
) -> BodyObservation | None:
    """An observation of a tracked frame set; None without evidence. before: the last one, for velocity."""
    body = track.body
    if body.pose is None or not track.evidence:
        return None
    index = {camera.name: i for i, camera in enumerate(cameras)}
    work = image_scales(cameras, FitParams().work_width_px)
    views = []
    for name, ids in track.evidence.items():
        i = index[name]
        late_s = seconds(frames.frames[name].t_ns - body.t_ns)
        views.append(pictured(i, ids, track.roi_px[name], work[i], late_s))
    local = local_from_global(standard_skeleton(model.stature_m), body.pose.quats_xyzw)
    velocity = np.zeros(model.n_pose)
    if before is not None:
        dt_s = max(seconds(body.t_ns - before.t_ns), 1e-3)
        last = before.state.root_m, before.state.local_xyzw
        velocity = step_between(model, (body.pose.root_m, local), last) / dt_s
    state = MotionState(
        body.pose.root_m.copy(),
        local,
        velocity,
        np.ones(model.n_shape),
        initial_information(model.space),
    )
    return BodyObservation(body.t_ns, state, tuple(views))


def fit_shape(
    observations: Sequence[BodyObservation], model: BodyModel, cameras: Sequence[Camera]
) -> ShapeFit:
    """The proportions that agree best with all observations. Raises InputError when too few agree."""
    tracker = FitParams()
    scales = image_scales(cameras, tracker.work_width_px)
    fitter = Fitter(model, shirt_labels(model), cameras, scales, tracker)
    gatherer = RowGatherer(fitter, _RADIUS_PX)
    if len(observations) < _FEWEST_OBSERVATIONS:
        raise _too_few(len(observations))
    states = [
        fitter.fit(m.state, m.views, _LOOSE_S, _SETTLING, learn_shape=True).state
        for m in observations
    ]
    factors = np.median([state.factors for state in states], axis=0)
    rounds: list[Floats] = []
    for i in range(_ROUNDS + 1):
        states = [replace(state, factors=factors) for state in states]
        rows = [
            [gatherer.gather(state, view) for view in m.views]
            for state, m in zip(states, observations, strict=True)
        ]
        # before the first steps a wearer of unusual proportions matches no picture well
        counted = _inliers(rows, _LEAST_MATCH if i == _ROUNDS else 0.0)
        evidence = _Evidence(rows, counted, model)
        if i == _ROUNDS:
            break
        step = evidence.step(factors)
        states = [
            state if follow is None else _follow_shape(model, state, follow, step)
            for state, follow in zip(states, evidence.follows, strict=True)
        ]
        factors = np.clip(factors + step, _SMALLEST, _LARGEST)
        rounds.append(factors)
        if i == _ROUNDS - 1:
            factors = np.mean(rounds[-_AVERAGED:], axis=0)
    return ShapeFit(
        factors,
        factors + np.linalg.solve(evidence.H + 1e-3 * np.eye(model.n_shape), evidence.b),
        evidence.H,
        tuple(states),
        tuple(counted),
    )


_Follow = tuple[Floats, Floats]  # derivative of a pose by the shape, and the pose's own step


class _Evidence:
    """Normal equations of the shape over all observations: H (N,N), b (N,), poses eliminated."""

    def __init__(
        self, rows: Sequence[Sequence[BodyRows]], counted: Sequence[int], model: BodyModel
    ) -> None:
        n, n_shape = model.n_pose, model.n_shape
        self.H, self.b = np.zeros((n_shape, n_shape)), np.zeros(n_shape)
        self._prior = 1.0 / model.space.factor_sd**2
        self.follows: list[_Follow | None] = [None] * len(rows)
        held = np.full(n, 1.0 / _JOINT_SD_RAD**2)
        held[:6] = 1e-3  # root and hips are free
        for k in counted:
            H = np.sum([row.H for row in rows[k]], axis=0)
            b = np.sum([row.b for row in rows[k]], axis=0)
            Hpp = H[:n, :n] + np.diag(held)
            Hps = H[:n, n:]
            back: Floats = np.linalg.solve(Hpp, Hps)
            own: Floats = np.linalg.solve(Hpp, b[:n])
            self.H += H[n:, n:] - Hps.T @ back
            self.b += b[n:] - Hps.T @ own
            self.follows[k] = back, own
        gain = min(1.0, _INDEPENDENT_OBSERVATIONS / len(counted))
        self.H, self.b = self.H * gain, self.b * gain

    def step(self, factors: Floats) -> Floats:
        """The Gauss-Newton step of evidence and prior."""
        prior = self._prior
        return np.asarray(
            np.linalg.solve(self.H + np.diag(prior), self.b - prior * (factors - 1.0)),
            dtype=np.float64,
        )


def _follow_shape(
    model: BodyModel, state: MotionState, follow: _Follow, step: Floats
) -> MotionState:
    root, local = apply_step(model, state.root_m, state.local_xyzw, follow[1] - follow[0] @ step)
    return replace(state, root_m=root, local_xyzw=local)


def _inliers(rows: Sequence[Sequence[BodyRows]], least_match: float) -> list[int]:
    """The observations in which body and pictures agree. Raises InputError for too few."""
    costs = [cost_of(observation) for observation in rows]
    tolerable = _TOLERATED_COST * float(np.median(costs))
    counted = [
        k
        for k, observation in enumerate(rows)
        if least_match_of(observation) >= least_match and costs[k] <= tolerable
    ]
    if len(counted) < _FEWEST_OBSERVATIONS:
        raise _too_few(len(counted))
    return counted


def _too_few(count: int) -> InputError:
    return InputError(
        f"body and pictures agree in {count} moments only, {_FEWEST_OBSERVATIONS} are needed",
        "body",
        "check the colours, then stand where all cameras see the whole shirt and measure again",
    )
