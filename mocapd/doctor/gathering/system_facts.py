"""Facts of the user, the processor and the clock."""

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
_TIMEOUT_S = 5.0


def user_facts() -> UserFacts:
    """Facts of this process's user; groups added since the login are missing."""
    uid = os.geteuid()
    try:
        name = pwd.getpwuid(uid).pw_name
    except KeyError:
        name = str(uid)
    names = {group.gr_gid: group.gr_name for group in grp.getgrall()}
    own = frozenset(names[gid] for gid in (os.getegid(), *os.getgroups()) if gid in names)
    return UserFacts(name, uid == 0, own, GROUP in names.values())


def state_facts(config: Config, user: UserFacts, system: Path = SERVICES) -> StateFacts:
    """system: systemd's folder of services' state, readable by root only."""
    if not user.is_root:
        return StateFacts(config.state_dir)
    paths = (system / "mocapd", *system.glob("mocapd-rigs/*"))
    own = config.state_dir.resolve()
    return StateFacts(
        config.state_dir, tuple(p for p in paths if p.is_dir() and p.resolve() != own)
    )


def processor_facts(sysfs: Path = SYSFS) -> ProcessorFacts:
    """The facts; without governors where a virtual machine hides frequencies."""
    cpus = sysfs / "devices/system/cpu"
    governors = Counter(_text(file) for file in cpus.glob("cpu[0-9]*/cpufreq/scaling_governor"))
    driver = next(iter(cpus.glob("cpu[0-9]*/cpufreq/scaling_driver")), None)
    return ProcessorFacts(
        len(os.sched_getaffinity(0)), dict(governors), _text(driver) if driver else ""
    )


def clock_facts() -> ClockFacts:
    built = Path(mocapd.__file__).stat().st_mtime
    return ClockFacts(time.time(), built, _is_synchronised())


def _is_synchronised() -> bool | None:
    """Systemd's answer; None without one."""
    tool = shutil.which("timedatectl")
    if tool is None:
        return None
    try:
        answer = subprocess.run(
            [tool, "show", "--property=NTPSynchronized", "--value"],
            capture_output=True,
            text=True,
            timeout=_TIMEOUT_S,
            check=True,
        ).stdout.strip()
    except (OSError, subprocess.SubprocessError):  # no systemd runs, as in a container
        return None
    return {"yes": True, "no": False}.get(answer)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="ascii", errors="replace").strip()
    except OSError:
        return ""
