"""What the step Check needs to know of the daemon."""

from dataclasses import dataclass, field

from mocapd.config.sections import TrackerSection
from mocapd.pipeline.bundler import BundlerParams


@dataclass(frozen=True, slots=True)
class CheckSettings:
    """How the daemon will track: its section `tracker`, the preset of `smoothing`, and how frames wait for
    each other."""

    tracker: TrackerSection
    smoothing: str = "balanced"
    bundler: BundlerParams = field(default_factory=BundlerParams)
