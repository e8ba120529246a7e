"""The bodies that a setup tracks, for who shows them."""

from dataclasses import dataclass, field

from mocapd.pipeline.body_hub import BodyHub
from mocapd.pipeline.loop import PipelineLoop


@dataclass(slots=True, eq=False)
class NewestBody:
    """Set by the wizard's thread, read by any: a reference is replaced whole.

    `loop`: the pipeline that puts them in; None while nothing tracks.
    """

    bodies: BodyHub = field(default_factory=BodyHub)
    loop: PipelineLoop | None = None

    def forget(self) -> None:
        """Nothing tracks any more."""
        self.loop = None
        self.bodies.forget()
