"""What a user's calibration of the simulated rig would know, without a film."""

from mocapd.calibration.calibration_record import Calibration, ShirtColours, Wearer
from mocapd.sim.setup_record import SimSetup


def calibration_of_setup(setup: SimSetup) -> Calibration:
    return Calibration(
        setup.rig, Wearer(setup.stature_m), ShirtColours(setup.model, setup.scribbles)
    )
