"""Commands of the step Check, with their arguments and ranges."""

from mocapd.wizard.commands import Command, Verbs


class MeasureAgain(Command, frozen=True):
    """Judge another five seconds."""


class Save(Command, frozen=True):
    """Write the calibration."""


CHECK: Verbs = {"measure": MeasureAgain, "save": Save}
