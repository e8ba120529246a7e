"""The user, the processor and the clock."""

import grp
import os
import pwd
import shutil
import subprocess
import time
from collections import Counter
from pathlib import Path

import mocapd
from mocapd.capture.webcam.webcams import SYSFS
from mocapd.config.sections import Config
from mocapd.doctor.checks.camera_checks import GROUP
from mocapd.doctor.facts import ClockFacts, ProcessorFacts, StateFacts, UserFacts

SERVICES = Path("/var/lib")
_PATIENCE_S = 5.0


def user_facts() -> UserFacts:
    """Of this process: a group that was given since the login is not among them yet."""
    uid = os.geteuid()
    try:
        name = pwd.getpwuid(uid).pw_name
    except KeyError:
        name = str(uid)
    known = {one.gr_gid: one.gr_name for one in grp.getgrall()}
    own = frozenset(known[gid] for gid in (os.getegid(), *os.getgroups()) if gid in known)
    return UserFacts(name, uid == 0, own, GROUP in known.values())


def state_facts(config: Config, user: UserFacts, system: Path = SERVICES) -> StateFacts:
    """system: where systemd keeps what services have. Nobody but root may look there."""
    if not user.is_root:
        return StateFacts(config.state_dir)
    found = [one for one in (system / "mocapd", *system.glob("mocapd-rigs/*")) if one.is_dir()]
    own = config.state_dir.resolve()
    return StateFacts(config.state_dir, tuple(one for one in found if one.resolve() != own))


def processor_facts(sysfs: Path = SYSFS) -> ProcessorFacts:
    """Empty where the system (a virtual machine) tells nothing of frequencies."""
    cpus = sysfs / "devices/system/cpu"
    governors = Counter(_text(one) for one in cpus.glob("cpu[0-9]*/cpufreq/scaling_governor"))
    driver = next(iter(cpus.glob("cpu[0-9]*/cpufreq/scaling_driver")), None)
    return ProcessorFacts(
        len(os.sched_getaffinity(0)), dict(governors), _text(driver) if driver else ""
    )


def clock_facts() -> ClockFacts:
    """Of the wall clock."""
    built = Path(mocapd.__file__).stat().st_mtime
    return ClockFacts(time.time(), built, _synchronised())


def _synchronised() -> bool | None:
    """As systemd tells, whoever does it."""
    tool = shutil.which("timedatectl")
    if tool is None:
        return None
    try:
        told = subprocess.run(
            [tool, "show", "--property=NTPSynchronized", "--value"],
            capture_output=True,
            text=True,
            timeout=_PATIENCE_S,
            check=True,
        ).stdout.strip()
    except (OSError, subprocess.SubprocessError):  # no systemd runs, as in a container
        return None
    return {"yes": True, "no": False}.get(told)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="ascii", errors="replace").strip()
    except OSError:
        return ""
