"""The newest body of a setup's tracker, for display."""

from dataclasses import dataclass, field

from mocapd.pipeline.body_hub import BodyHub
from mocapd.pipeline.loop import PipelineLoop


@dataclass(slots=True, eq=False)
class NewestBody:
    """Set by the wizard's thread, read by any: a reference is replaced as a whole.

    `loop`: the pipeline that sets it; None without one.
    """

    bodies: BodyHub = field(default_factory=BodyHub)
    loop: PipelineLoop | None = None

    def forget(self) -> None:
        """Called when tracking ends."""
        self.loop = None
        self.bodies.forget()
