"""The settings of the VMC output."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from msgspec import Meta

from mocapd.outputs.osc.osc_sink import parse_destination
from mocapd.outputs.vmc.vmc_packets import Bundling
from mocapd.outputs.vmc.vrm_file import read_vrm

KEY = "vmc.destinations"

# stored as text; a relative path starts at the configuration file
_PathText = Annotated[str, Meta(extra={"is_path": True})]


@dataclass(frozen=True, slots=True)
class Params:
    """How the person is sent. Raises ConfigError for a destination, InputError for a `.vrm` file that does not do.

    destinations: list of `address:port`, numeric addresses only
    port_step: VMC has no person numbers, so person n is sent to the configured port plus n times this
    root: which bone has the motion over the floor: `hips`, which every receiver supports, or `root`
    turn: 180 for a receiver that shows the avatar from behind [degrees]
    yaw_deg: additional turn, counter-clockwise from above [degrees]
    mirror: as in a mirror: the person's left is the avatar's right
    bundle: two, of at most 1472 bytes each; one, for VSeeFace; or off, for receivers that read no bundles
    rate_hz: maximum number of frames per second [Hz]
    vrm: a `.vrm` file; its bone lengths are sent instead of the wearer's
    """

    destinations: tuple[str, ...] = ("127.0.0.1:39539",)
    port_step: Annotated[int, Meta(ge=1, le=10_000)] = 10
    root: Literal["hips", "root"] = "hips"
    turn: Literal[0, 180] = 0
    yaw_deg: Annotated[float, Meta(ge=-360, le=360)] = 0.0
    mirror: bool = False
    bundle: Bundling = "two"
    rate_hz: Annotated[float, Meta(ge=1, le=200)] = 60.0
    vrm: _PathText = ""

    def __post_init__(self) -> None:
        for destination in self.destinations:
            parse_destination(destination, KEY)
        if self.vrm:
            read_vrm(Path(self.vrm))
