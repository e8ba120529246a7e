"""Gathers all facts once."""

from mocapd.config.effective import Effective
from mocapd.control.target_process import find_daemons
from mocapd.doctor.facts import ConfigFacts, Facts
from mocapd.doctor.gathering.calibration_facts import calibration_facts
from mocapd.doctor.gathering.camera_facts import camera_facts
from mocapd.doctor.gathering.folder_facts import folder_facts
from mocapd.doctor.gathering.library_facts import library_facts
from mocapd.doctor.gathering.port_facts import port_facts
from mocapd.doctor.gathering.preparation_facts import preparation_facts
from mocapd.doctor.gathering.system_facts import (
    clock_facts,
    processor_facts,
    state_facts,
    user_facts,
)
from mocapd.errors import Problem


def gather_facts(effective: Effective, trouble: Problem | None) -> Facts:
    """trouble: why the user's configuration is invalid; `effective` then holds the built-in values."""
    config = effective.config
    calibration, saved = calibration_facts(config)
    user = user_facts()
    return Facts(
        config=ConfigFacts(effective.file, trouble),
        daemons=tuple(daemon.status for daemon in find_daemons(config).daemons),
        user=user,
        states=state_facts(config, user),
        cameras=camera_facts(config, saved),
        ports=port_facts(config),
        folders=folder_facts(config),
        calibration=calibration,
        processor=processor_facts(),
        clock=clock_facts(),
        libraries=library_facts(config),
        preparation=preparation_facts(config),
    )
