"""The calibration record, from any source: rig, wearer, and the colours of the shirt."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from mocapd.types import Floats, LabelledPicture, Rig


@dataclass(frozen=True, slots=True, eq=False)
class Wearer:
    """stature_m: the height [m]; shape_factors (N_FACTORS,): measured proportions relative to the mean body.
    None: unknown. has_shirt: whether the wearer has a shirt for the tracker."""

    stature_m: float | None = None
    shape_factors: Floats | None = None
    has_shirt: bool = True

    def overlaid(self, stronger: "Wearer") -> "Wearer":
        """Field by field the stronger record's value, or this one's where that is unknown."""
        return Wearer(
            self.stature_m if stronger.stature_m is None else stronger.stature_m,
            self.shape_factors if stronger.shape_factors is None else stronger.shape_factors,
            self.has_shirt and stronger.has_shirt,
        )


@dataclass(frozen=True, slots=True, eq=False)
class ShirtColours:
    """model: the shirt in neutral light, empty for the standard shirt; white_balance: by camera, the shirt in
    the light of the place."""

    model: tuple[LabelledPicture, ...] = ()
    white_balance: Mapping[str, LabelledPicture] = field(default_factory=dict)

    def overlaid(self, stronger: "ShirtColours") -> "ShirtColours":
        """The model of the stronger where it has one; each camera's picture likewise."""
        return ShirtColours(
            stronger.model or self.model, {**self.white_balance, **stronger.white_balance}
        )


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """None: no value available. Readers are in `calibration`, `session` and `wizard`; a tracker refuses to
    start without a value that it needs. assumes_rig: the rig was not measured, so the floor may be elsewhere."""

    rig: Rig | None = None
    wearer: Wearer = field(default_factory=Wearer)
    shirt: ShirtColours | None = None
    assumes_rig: bool = False

    def overlaid(self, stronger: "Calibration") -> "Calibration":
        """Field by field the stronger record's value, or this one's where that is unknown."""
        shirt = self.shirt or stronger.shirt
        if self.shirt is not None and stronger.shirt is not None:
            shirt = self.shirt.overlaid(stronger.shirt)
        by = self if stronger.rig is None else stronger
        return Calibration(by.rig, self.wearer.overlaid(stronger.wearer), shirt, by.assumes_rig)

    def assuming(self, stature_m: float) -> "Calibration":
        """The same, with this height of the wearer [m] where none is known yet."""
        return Calibration(wearer=Wearer(stature_m)).overlaid(self)
