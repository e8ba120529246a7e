"""Checks of configuration, running daemons and their owners, processor, clock, Python and its libraries."""

from collections.abc import Iterator, Sequence

from mocapd.control.control_messages import StatusReport
from mocapd.doctor.facts import (
    ClockFacts,
    ConfigFacts,
    LibraryFacts,
    PreparationFacts,
    ProcessorFacts,
    StateFacts,
    UserFacts,
)
from mocapd.doctor.finding import Finding, bad, ok, warn
from mocapd.extras import reinstall_command
from mocapd.service.health import EFFORT_TROUBLE

FEWEST_CORES = 2
# Drivers whose `powersave` follows the load within milliseconds.
_QUICK_DRIVERS = ("intel_pstate", "amd-pstate-epp")


def check_config(facts: ConfigFacts) -> Finding:
    """Checks that the configuration is valid."""
    if facts.trouble is not None:
        return bad("config", facts.trouble.what, facts.trouble.fix)
    return ok("config", str(facts.file) if facts.file else "no file: what is built in")


def check_daemons(daemons: Sequence[StatusReport]) -> Iterator[Finding]:
    """Reports the running daemons and their troubles."""
    if not daemons:
        yield ok("daemon", "none of yours is running")
    for daemon in daemons:
        name = f"{daemon.instance} (pid {daemon.pid}) is running"
        if daemon.state == "blind":
            yield bad("daemon", f"{name}: no camera delivers", "mocapd status")
        elif daemon.slowness:
            what, _, fix = daemon.slowness.partition(" -- ")
            yield bad("daemon", f"{name}: {what}", fix)
        elif daemon.effort in EFFORT_TROUBLE:
            what, fix = EFFORT_TROUBLE[daemon.effort]
            yield warn("daemon", f"{name}: {what}", fix)
        else:
            yield ok("daemon", name)


def check_ownership(user: UserFacts, states: StateFacts) -> Iterator[Finding]:
    """Warns root, who examines its own folders, about services with folders of their own."""
    if user.is_root and states.of_services:
        theirs = ", ".join(map(str, states.of_services))
        yield warn(
            "service",
            f"configuration, calibration and folders are looked at as root has them ({states.own}), not as the service"
            f" has them ({theirs})",
            "sudo mocapd as-service doctor (of mocapd@NAME: as-service --rig NAME), while it runs",
        )


def check_processor(facts: ProcessorFacts) -> Iterator[Finding]:
    """Checks the number of cores and their frequency governor."""
    if facts.cores < FEWEST_CORES:
        yield warn(
            "processor",
            f"{facts.cores} core: tracking and everything else share it",
            "give it two, or lower fps_hz",
        )
    slow = facts.governors.get("powersave", 0)
    if slow and not facts.driver.startswith(_QUICK_DRIVERS):
        yield warn(
            "processor",
            f"{slow} cores stay at their lowest frequency (governor powersave)",
            "sudo cpupower frequency-set -g schedutil",
        )
    elif facts.cores >= FEWEST_CORES:
        kinds = ", ".join(sorted(facts.governors)) or "no governor is reported"
        yield ok("processor", f"{facts.cores} cores ({kinds})")


def check_clock(facts: ClockFacts) -> Finding:
    """Checks the wall clock, which stamps frames and files."""
    if facts.now_unix_s < facts.built_unix_s - 86400.0:
        return bad("clock", "it is earlier than mocapd itself", "sudo timedatectl set-ntp true")
    if facts.synchronised is False:
        return warn(
            "clock",
            "it is not synchronised: cameras and games of other machines get wrong times",
            "sudo timedatectl set-ntp true",
        )
    return ok(
        "clock",
        "synchronised" if facts.synchronised else "plausible; its synchronisation is not reported",
    )


def check_libraries(facts: LibraryFacts) -> Iterator[Finding]:
    """Checks that all libraries can be imported."""
    for name, why in facts.broken.items():
        yield bad("library", f"{name}: {why}", f"reinstall it: {reinstall_command()}")
    versions = ", ".join(f"{name} {version}" for name, version in facts.versions.items())
    yield ok("python", f"{facts.python}; {versions}")
    if facts.wants_vrchat and facts.vrchat_fix:
        yield bad(
            "vrchat",
            'vrchat.destination = "auto" needs the extra mocapd[vrchat], which is not installed',
            facts.vrchat_fix,
        )
    else:
        has = "not installed, and not needed" if facts.vrchat_fix else "installed"
        yield ok("vrchat", f"the extra that finds it is {has}")


def check_preparation(facts: PreparationFacts) -> Finding:
    """Checks that the caches are warm, so that a start takes seconds."""
    about = "first start"
    if facts.done:
        return ok(about, "kernels and pose database are prepared: a start takes seconds")
    if facts.under_way:
        return ok(
            about,
            "kernels and pose database are being prepared; a start before the end waits for them",
        )
    return warn(about, "the next start compiles kernels for about a minute, once", "mocapd prepare")
