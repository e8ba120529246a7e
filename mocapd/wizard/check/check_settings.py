"""What the step Check needs to know of the daemon."""

from dataclasses import dataclass, field

from mocapd.config.sections import TrackerSection
from mocapd.pipeline.bundler import BundlerParams


@dataclass(frozen=True, slots=True)
class CheckSettings:
    """How the daemon will track: its section `tracker`, the preset of `smoothing`, and how frames wait for
    each other. next_command: what starts it on what is saved; empty where it runs, and takes that up by itself."""

    tracker: TrackerSection
    smoothing: str = "balanced"
    bundler: BundlerParams = field(default_factory=BundlerParams)
    next_command: str = ""
