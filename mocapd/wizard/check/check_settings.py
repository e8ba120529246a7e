"""The daemon's settings that the step Check needs."""

from dataclasses import dataclass, field

from mocapd.config.sections import TrackerSection
from mocapd.pipeline.bundler import BundlerParams


@dataclass(frozen=True, slots=True)
class CheckSettings:
    """The daemon's section `tracker`, its preset of `smoothing`, and its bundler settings. next_command: the
    command that starts it with the saved calibration; empty in a daemon, which loads that by itself."""

    tracker: TrackerSection
    smoothing: str = "balanced"
    bundler: BundlerParams = field(default_factory=BundlerParams)
    next_command: str = ""
