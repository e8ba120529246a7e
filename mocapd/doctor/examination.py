"""Runs all checks, in the order of the output."""

from mocapd.doctor.checks.calibration_checks import check_calibration
from mocapd.doctor.checks.camera_checks import check_bandwidth, check_rights, check_webcams
from mocapd.doctor.checks.storage_checks import check_folder, check_ports
from mocapd.doctor.checks.system_checks import (
    check_clock,
    check_config,
    check_daemons,
    check_libraries,
    check_ownership,
    check_preparation,
    check_processor,
)
from mocapd.doctor.facts import Facts
from mocapd.doctor.finding import Finding


def examine(facts: Facts) -> tuple[Finding, ...]:
    """The findings of all checks."""
    return (
        check_config(facts.config),
        *check_daemons(facts.daemons),
        *check_ownership(facts.user, facts.states),
        *check_rights(facts.user, facts.cameras),
        *check_webcams(facts.cameras, facts.daemons),
        *check_bandwidth(facts.cameras),
        check_calibration(facts.calibration),
        *check_ports(facts.ports, facts.daemons),
        *(check_folder(folder) for folder in facts.folders),
        *check_processor(facts.processor),
        check_clock(facts.clock),
        *check_libraries(facts.libraries),
        check_preparation(facts.preparation),
    )
