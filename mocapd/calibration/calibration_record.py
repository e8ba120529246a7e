"""All that is known before the first frame, whoever says it: rig, wearer, and the colours of the shirt."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from mocapd.types import Floats, LabelledPicture, Rig


@dataclass(frozen=True, slots=True, eq=False)
class Wearer:
    """stature_m: the height [m]; shape_factors (N_FACTORS,): the proportions on the mean body, as measured.
    None: not known. has_shirt: whether there is a shirt to be tracked by."""

    stature_m: float | None = None
    shape_factors: Floats | None = None
    has_shirt: bool = True

    def overlaid(self, stronger: "Wearer") -> "Wearer":
        """What the stronger knows, and this where it knows nothing."""
        return Wearer(
            self.stature_m if stronger.stature_m is None else stronger.stature_m,
            self.shape_factors if stronger.shape_factors is None else stronger.shape_factors,
            self.has_shirt and stronger.has_shirt,
        )


@dataclass(frozen=True, slots=True, eq=False)
class ShirtColours:
    """model: the shirt in neutral light, none for its standard; white_balance: by camera, the shirt in the
    place's own light."""

    model: tuple[LabelledPicture, ...] = ()
    white_balance: Mapping[str, LabelledPicture] = field(default_factory=dict)

    def overlaid(self, stronger: "ShirtColours") -> "ShirtColours":
        """The model of the stronger where it has one; each camera's picture likewise."""
        return ShirtColours(
            stronger.model or self.model, {**self.white_balance, **stronger.white_balance}
        )


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """None: nobody says. Readers are in `calibration`, `session` and `wizard`; a tracker refuses what it
    needs and is not given."""

    rig: Rig | None = None
    wearer: Wearer = field(default_factory=Wearer)
    shirt: ShirtColours | None = None

    def overlaid(self, stronger: "Calibration") -> "Calibration":
        """Field by field what the stronger knows, and this where it knows nothing."""
        shirt = self.shirt or stronger.shirt
        if self.shirt is not None and stronger.shirt is not None:
            shirt = self.shirt.overlaid(stronger.shirt)
        return Calibration(
            self.rig if stronger.rig is None else stronger.rig,
            self.wearer.overlaid(stronger.wearer),
            shirt,
        )

    def assuming(self, stature_m: float) -> "Calibration":
        """The same of a wearer of this height [m], where nobody says."""
        return Calibration(wearer=Wearer(stature_m)).overlaid(self)
