"""The job of the step Body: tracks the wearer live until there are enough observations, then solves the shape."""

import threading
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

from mocapd.body.model import build_model
from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.calibrate.body_shape.body_observations import PATIENCE_S, BodyObservations
from mocapd.calibrate.body_shape.body_scale import Scale, scale_of
from mocapd.calibrate.body_shape.body_shape_fit import fit_shape
from mocapd.clock import monotonic_ns, seconds
from mocapd.config.sections import TrackerSection
from mocapd.errors import InputError
from mocapd.pipeline.collector import FrameCollector
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.session.tracker_setup import ReadyTracker, cache_resources, ready_tracker
from mocapd.trackers.registry import shirt_tracker
from mocapd.types import BodyState, Bytes, Rig, Skeleton
from mocapd.wizard.body.measured_body import body_picture
from mocapd.wizard.draft import Draft
from mocapd.wizard.saving import calibration_of
from mocapd.wizard.step import Tell

READY, SEEN = 0.25, 0.85  # shares of the job: the tracker is ready, enough observations
_TIMEOUT_S = 0.2  # for a frame set; then `stop` is checked
# of a frame set that counts: a slow machine is not the wearer's fault
_LONGEST_LOOK_S = 0.25


MakeTracker = Callable[[Draft, Path, Tell], ReadyTracker]


@dataclass(frozen=True, slots=True, eq=False)
class BodyMeasurement:
    """The wearer's shape, its scale in the room, and by camera a picture (h,w,3) BGR of the last observation with the
    body drawn over it."""

    shape: BodyShape
    scale: Scale
    pictures: dict[str, Bytes]


@dataclass(slots=True, eq=False)
class BodyWatch:
    """Shared by the job and the step: the newest body, replaced as a whole, and a request to stop."""

    body: tuple[BodyState, Skeleton] | None = None
    stop: threading.Event = field(default_factory=threading.Event)


@dataclass(slots=True)
class VisibilityTimeout:
    """Remaining seconds of frame sets without a visible wearer; others do not count. Independent of the machine's speed."""

    left_s: float

    def update(self, took_s: float, *, visible: bool) -> None:
        if not visible:
            self.left_s -= min(took_s, _LONGEST_LOOK_S)

    @property
    def is_over(self) -> bool:
        return self.left_s <= 0.0


def measure(
    hub: FrameHub,
    draft: Draft,
    cache_dir: Path,
    watched: BodyWatch,
    report: Tell,
    make_tracker: MakeTracker,
) -> BodyMeasurement | None:
    """Measure the wearer of a draft that has room, colours and stature; None when stopped.

    Raises InputError for too few observations.
    """
    assert draft.rig is not None
    assert draft.stature_m is not None
    ready = make_tracker(draft, cache_dir, report)
    model = build_model(draft.stature_m)
    observations = BodyObservations(model, draft.rig.cameras)
    if not _watch(
        hub, draft.rig, ready, observations, watched, report, VisibilityTimeout(PATIENCE_S)
    ):
        return None
    report("working out the proportions", SEEN)
    fit = fit_shape(observations.observations, model, draft.rig.cameras)
    shown = fit.states[observations.pictured], observations.observations[observations.pictured]
    return BodyMeasurement(
        BodyShape(draft.stature_m, fit.factors),
        scale_of(fit, model, draft.floor_known),
        {
            camera.name: body_picture(observations.pictures[camera.name], camera, model, *shown, i)
            for i, camera in enumerate(draft.rig.cameras)
            if camera.name in observations.pictures
        },
    )


def measuring_tracker(draft: Draft, cache_dir: Path, report: Tell) -> ReadyTracker:
    """The draft's tracker, warm, without earlier measurements; takes seconds."""
    report("loading the tracker", 0.0)
    usual = TrackerSection()
    calibration = calibration_of(replace(draft, factors=None)).assuming(usual.stature_m)
    resources = cache_resources(
        cache_dir,
        lambda what, done, total: report(f"making the {what}", 0.5 * READY * done / total),
    )
    return ready_tracker(
        shirt_tracker(usual.name),
        calibration,
        resources,
        rehearsal=lambda done, total: report(
            "preparing the tracker", READY * (0.5 + 0.5 * done / total)
        ),
    )


def _watch(
    hub: FrameHub,
    rig: Rig,
    ready: ReadyTracker,
    observations: BodyObservations,
    watched: BodyWatch,
    report: Tell,
    timeout: VisibilityTimeout,
) -> bool:
    """Track the hub's frames until there are enough observations; False when stopped. Raises InputError."""
    tracker, shape = ready.tracker, ready.shape
    collector = FrameCollector(rig.names, hub.bundler)
    hub.join(collector)
    try:
        while observations.share < 1.0:
            if watched.stop.is_set():
                return False
            if timeout.is_over:
                raise InputError(
                    f"the wearer was well seen for {observations.good_s:.0f} s only",
                    "body",
                    "check the colours, stand where all cameras see the whole shirt, and measure again",
                )
            began_ns = monotonic_ns()
            frames = collector.get(_TIMEOUT_S)
            if frames is None:
                timeout.update(seconds(monotonic_ns() - began_ns), visible=False)
                continue
            track = tracker.step(frames, shape)
            shape = track.shape
            watched.body = track.body, skeleton_of(shape)
            visible = observations.add(track, frames)
            timeout.update(seconds(monotonic_ns() - began_ns), visible=visible)
            report(_instruction(visible, observations), READY + (SEEN - READY) * observations.share)
        return True
    finally:
        hub.leave(collector)
        watched.body = None


def _instruction(visible: bool, observations: BodyObservations) -> str:
    """The next instruction for the wearer."""
    if not visible:
        return "Stand where all cameras see the whole shirt, arms out"
    if not observations.bent:
        return "Arms out; now bend both elbows and stretch them again, slowly"
    return "Good. Go on bending and stretching the elbows"
