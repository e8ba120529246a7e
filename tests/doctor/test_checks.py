"""Each thing that the doctor finds wrong is told with what mends it, and nothing is said of what is well."""

import shlex
from dataclasses import replace
from pathlib import Path

import pytest

from mocapd.boundary.secret_files import narrowing
from mocapd.capture.webcam.identity import WebcamIdentity
from mocapd.capture.webcam.usb_bandwidth import CrowdedBus
from mocapd.capture.webcam.v4l2_ioctl import PixelFormat
from mocapd.capture.webcam.webcam_listing import CameraInfo
from mocapd.doctor.checks.calibration_checks import check_calibration
from mocapd.doctor.checks.camera_checks import check_bandwidth, check_rights, check_webcams
from mocapd.doctor.checks.storage_checks import check_folder, check_ports
from mocapd.doctor.checks.system_checks import (
    check_clock,
    check_config,
    check_daemons,
    check_libraries,
    check_preparation,
    check_processor,
)
from mocapd.doctor.facts import (
    CalibrationFacts,
    CameraFacts,
    ClockFacts,
    ConfigFacts,
    FolderFacts,
    LibraryFacts,
    PortFacts,
    PreparationFacts,
    ProcessorFacts,
    UserFacts,
)
from mocapd.doctor.finding import Verdict
from mocapd.errors import Problem
from mocapd.wizard.draft import DraftCamera
from tests.control.reports import CAMERA, report

OK, WARN, BAD = Verdict.OK, Verdict.WARN, Verdict.BAD
DAY_S = 86400.0

SOURCE = "usb:1-3:046d:0825:"
WEBCAM = CameraInfo(
    Path("/dev/video0"),
    "C270",
    WebcamIdentity("1-3", "046d", "0825"),
    SOURCE,
    (PixelFormat("MJPG", (640, 480), (30.0,)),),
    "",
    "",
)
FORBIDDEN = replace(WEBCAM, problem="no permission", fix="sudo usermod -aG video me")
BUSY = replace(WEBCAM, problem="busy: used by pid 4242 (mocapd)", fix="end that program")
LEFT = DraftCamera("left", SOURCE, (640, 480), 30.0)
ME = UserFacts("me", False, frozenset({"me"}))


@pytest.mark.parametrize(
    ("user", "webcam", "verdict", "fix"),
    [
        (replace(ME, groups=frozenset({"video"})), WEBCAM, OK, ""),
        (replace(ME, is_root=True), FORBIDDEN, OK, ""),
        (ME, WEBCAM, OK, ""),  # who sits at the screen
        (ME, FORBIDDEN, BAD, "sudo usermod -aG video me, then log in again"),
        (ME, None, WARN, "sudo usermod -aG video me, then log in again"),
        (replace(ME, has_video_group=False), FORBIDDEN, WARN, "ls -l /dev/video*"),
    ],
)
def test_the_right_to_open_webcams(
    user: UserFacts, webcam: CameraInfo | None, verdict: Verdict, fix: str
) -> None:
    nodes = (webcam,) if webcam else ()
    (found,) = check_rights(user, CameraFacts(nodes, ()))
    assert found.verdict is verdict
    assert found.fix.startswith(fix)


def test_a_webcam_that_the_running_daemon_has_is_well() -> None:
    running = report(instance="pc", cameras=(CAMERA,))  # of the same source
    facts = CameraFacts((BUSY,), (LEFT,))
    (found,) = check_webcams(facts, (running,))
    assert found.verdict is OK
    assert "in use by the running pc" in found.what
    (found,) = check_webcams(facts, ())
    assert (found.verdict, found.fix) == (BAD, "end that program")


def test_a_webcam_that_is_wanted_and_not_there_is_bad() -> None:
    found = [*check_webcams(CameraFacts((), (LEFT,)), ())]
    assert [(one.verdict, "left" in one.what) for one in found] == [(BAD, True)]
    (found_none,) = check_webcams(CameraFacts((), ()), ())
    assert found_none.verdict is WARN
    film = DraftCamera("film", "sim:living_room#cam0", (640, 480), 30.0)
    assert [one.verdict for one in check_webcams(CameraFacts((WEBCAM,), (film,)), ())] == [OK]


def test_a_metadata_node_is_no_webcam() -> None:
    metadata = replace(WEBCAM, captures=False, problem="a metadata node")
    found = [*check_webcams(CameraFacts((WEBCAM, metadata), ()), ())]
    assert [one.verdict for one in found] == [OK]


def test_a_crowded_bus_is_told_with_what_is_asked_of_it() -> None:
    crowded = CrowdedBus("1", ("left", "right"), 74e6, 36e6)
    (found,) = check_bandwidth(CameraFacts((WEBCAM,), (LEFT,), (crowded,)))
    assert found.verdict is WARN
    assert "74 MB/s by left and right" in found.what
    assert "quirks=128" in found.fix
    (found,) = check_bandwidth(CameraFacts((WEBCAM,), (LEFT,)))
    assert found.verdict is OK
    assert not [*check_bandwidth(CameraFacts((), (LEFT,)))]


def test_ports() -> None:
    free = PortFacts("zenoh.port", 7447, "")
    own = replace(free, holder="python (pid 4242)")
    others = replace(free, holder="zenohd (pid 42)")
    found = [*check_ports((free, own, others), (report(pid=4242),))]
    assert [one.verdict for one in found] == [OK, OK, BAD]
    assert "zenohd (pid 42) has it" in found[2].what
    assert "set zenoh.port to another" in found[2].fix


FOLDER = FolderFacts("state_dir", Path("/var/lib/mocapd"), None, False, 20 << 30)


@pytest.mark.parametrize(
    ("facts", "verdict", "says"),
    [
        (FOLDER, OK, "20 GB free"),
        (replace(FOLDER, free_bytes=None), OK, "private and writable"),
        (replace(FOLDER, free_bytes=500 << 20), WARN, "500 MB free"),
        (replace(FOLDER, free_bytes=5 << 20), BAD, "5 MB free"),
        (replace(FOLDER, free_bytes=5 << 20, holds_little=True), OK, "5 MB free"),
        (replace(FOLDER, free_bytes=1000, holds_little=True), BAD, "0 MB free"),
        (replace(FOLDER, open_to_others=True), WARN, "chmod 700 /var/lib/mocapd"),
        (replace(FOLDER, trouble=Problem("cannot be written to", fix="chown it")), BAD, "chown it"),
    ],
)
def test_folders(facts: FolderFacts, verdict: Verdict, says: str) -> None:
    found = check_folder(facts)
    assert found.verdict is verdict
    assert says in f"{found.what} {found.fix}"


def test_commands_name_a_path_with_a_space_as_one_word() -> None:
    path = Path("/srv/motion capture/state")
    found = check_folder(FolderFacts("state_dir", path, None, True, None))
    for command in (found.fix, narrowing(path)):
        assert shlex.split(command)[-1] == str(path)


GOOD = CalibrationFacts(Path("c.toml"), None, 3 * DAY_S, 0.3, 0.8, 2)


@pytest.mark.parametrize(
    ("facts", "verdict", "says"),
    [
        (GOOD, OK, "2 cameras, 3 days old, 0.30 px, 0.8 cm"),
        (replace(GOOD, rms_px=None, play_area_cm=None), OK, "3 days old"),
        (CalibrationFacts(None), WARN, "mocapd calibrate"),
        (
            replace(GOOD, trouble=Problem("has schema 9", fix="use the mocapd that wrote it")),
            BAD,
            "9",
        ),
        (replace(GOOD, play_area_cm=8.0), WARN, "--step room"),
        (replace(GOOD, rms_px=4.0), WARN, "--step room"),
        (replace(GOOD, age_s=300 * DAY_S), WARN, "it is old"),
        (replace(GOOD, age_s=-9 * DAY_S), WARN, "of the future"),
    ],
)
def test_the_calibration(facts: CalibrationFacts, verdict: Verdict, says: str) -> None:
    found = check_calibration(facts)
    assert found.verdict is verdict
    assert says in f"{found.what} {found.fix}"


@pytest.mark.parametrize(
    ("facts", "verdict"),
    [
        (ProcessorFacts(4, {"schedutil": 4}, "acpi-cpufreq"), OK),
        (ProcessorFacts(4), OK),
        (ProcessorFacts(4, {"powersave": 4}, "intel_pstate"), OK),
        (ProcessorFacts(4, {"powersave": 4}, "acpi-cpufreq"), WARN),
        (ProcessorFacts(1, {"performance": 1}, "acpi-cpufreq"), WARN),
    ],
)
def test_the_processor(facts: ProcessorFacts, verdict: Verdict) -> None:
    assert [one.verdict for one in check_processor(facts)] == [verdict]


@pytest.mark.parametrize(
    ("now_s", "synchronised", "verdict"),
    [
        (100 * DAY_S, True, OK),
        (100 * DAY_S, None, OK),
        (100 * DAY_S, False, WARN),
        (0.0, True, BAD),
    ],
)
def test_the_clock(now_s: float, synchronised: bool | None, verdict: Verdict) -> None:
    assert check_clock(ClockFacts(now_s, 90 * DAY_S, synchronised)).verdict is verdict


def test_libraries_and_the_extra_for_vrchat() -> None:
    facts = LibraryFacts(
        "3.11.2",
        {"numpy": "2.1"},
        {"opencv": "libGL.so.1: no such file"},
        vrchat_fix="pipx inject mocapd zeroconf",
    )
    found = {one.about: one for one in check_libraries(facts)}
    assert found["library"].verdict is BAD
    assert "libGL" in found["library"].what
    assert found["vrchat"].verdict is OK
    wanting = [*check_libraries(replace(facts, broken={}, wants_vrchat=True))]
    assert [one.verdict for one in wanting] == [OK, BAD]
    assert "mocapd[vrchat]" in wanting[1].what
    assert wanting[1].fix == "pipx inject mocapd zeroconf"
    has = [*check_libraries(replace(facts, broken={}, wants_vrchat=True, vrchat_fix=""))]
    assert [one.verdict for one in has] == [OK, OK]


def test_configuration_and_daemons() -> None:
    assert check_config(ConfigFacts(Path("config.toml"))).verdict is OK
    broken = check_config(
        ConfigFacts(None, Problem("config.toml:3: no key 'colour'", fix="colour?"))
    )
    assert (broken.verdict, broken.fix) == (BAD, "colour?")
    assert [one.verdict for one in check_daemons(())] == [OK]
    both = check_daemons((report(), report(state="blind")))
    assert [one.verdict for one in both] == [OK, BAD]
    (slow,) = check_daemons((report(effort="saving"),))
    assert slow.verdict is WARN
    assert "saving effort: this machine is too slow" in slow.what
    assert "fps_hz" in slow.fix


def test_whether_the_first_start_is_prepared() -> None:
    waits = check_preparation(PreparationFacts(done=False))
    assert waits.verdict is WARN
    assert waits.fix == "mocapd prepare"
    assert check_preparation(PreparationFacts(done=True)).verdict is OK
    assert check_preparation(PreparationFacts(done=False, under_way=True)).verdict is OK
