"""Records of facts about the machine, the configuration and the calibration, input of the checks."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from mocapd.capture.webcam.usb_bandwidth import CrowdedBus
from mocapd.capture.webcam.webcam_listing import CameraInfo
from mocapd.control.control_messages import StatusReport
from mocapd.errors import Problem
from mocapd.wizard.draft import DraftCamera


@dataclass(frozen=True, slots=True)
class ConfigFacts:
    """file: None without one; trouble: why it is invalid, in which case the built-in values are examined."""

    file: Path | None
    trouble: Problem | None = None


@dataclass(frozen=True, slots=True)
class UserFacts:
    """groups: names of this process's groups; has_video_group: whether the group `video` exists."""

    name: str
    is_root: bool
    groups: frozenset[str]
    has_video_group: bool = True


@dataclass(frozen=True, slots=True)
class StateFacts:
    """Folders of calibrations. own: the examined one; of_services: those of this machine's services, visible to root
    only."""

    own: Path
    of_services: tuple[Path, ...] = ()


@dataclass(frozen=True, slots=True)
class CameraFacts:
    """nodes: the machine's; asked: cameras of configuration or calibration; crowded: buses overloaded by the plugged ones
    among them."""

    nodes: tuple[CameraInfo, ...]
    asked: tuple[DraftCamera, ...]
    crowded: tuple[CrowdedBus, ...] = ()


@dataclass(frozen=True, slots=True)
class PortFacts:
    """A TCP port that the configuration needs. holder: the program that uses it; empty without one."""

    key: str
    port: int
    holder: str


@dataclass(frozen=True, slots=True)
class FolderFacts:
    """key: of the configuration; trouble: why it is not writable or not trusted; open_to_others: readable by other users;
    free_bytes: on its disk, None if unknown; holds_little: only small files."""

    key: str
    path: Path
    trouble: Problem | None
    open_to_others: bool
    free_bytes: int | None
    holds_little: bool = False


@dataclass(frozen=True, slots=True)
class CalibrationFacts:
    """path: None without one; trouble: why it is unusable; age_s: since its creation [s]; rms_px, play_area_cm: saved
    errors, None if unknown; cameras: their number."""

    path: Path | None
    trouble: Problem | None = None
    age_s: float = 0.0
    rms_px: float | None = None
    play_area_cm: float | None = None
    cameras: int = 0


@dataclass(frozen=True, slots=True)
class ProcessorFacts:
    """cores: available to this process; governors: number of cores by governor; driver: of frequency scaling."""

    cores: int
    governors: Mapping[str, int] = field(default_factory=dict)
    driver: str = ""


@dataclass(frozen=True, slots=True)
class ClockFacts:
    """now_unix_s: the wall clock; built_unix_s: installation time of mocapd; synchronised: None if unknown."""

    now_unix_s: float
    built_unix_s: float
    synchronised: bool | None


@dataclass(frozen=True, slots=True)
class LibraryFacts:
    """python: its version; versions: of importable libraries; broken: import errors; wants_vrchat: the configuration
    needs VRChat's discovery; vrchat_fix: command that installs its extra, empty if installed."""

    python: str
    versions: Mapping[str, str]
    broken: Mapping[str, str]
    wants_vrchat: bool = False
    vrchat_fix: str = ""


@dataclass(frozen=True, slots=True)
class PreparationFacts:
    """Whether kernels and pose database of this version are cached (`done`) or in preparation (`under_way`)."""

    done: bool
    under_way: bool = False


@dataclass(frozen=True, slots=True)
class Facts:
    config: ConfigFacts
    daemons: tuple[StatusReport, ...]
    user: UserFacts
    states: StateFacts
    cameras: CameraFacts
    ports: tuple[PortFacts, ...]
    folders: tuple[FolderFacts, ...]
    calibration: CalibrationFacts
    processor: ProcessorFacts
    clock: ClockFacts
    libraries: LibraryFacts
    preparation: PreparationFacts
