"""What the doctor judges: facts of the machine, the configuration and the calibration."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from mocapd.capture.webcam.usb_bandwidth import CrowdedBus
from mocapd.capture.webcam.webcam_listing import CameraInfo
from mocapd.control.control_messages import StatusReport
from mocapd.wizard.draft import DraftCamera


@dataclass(frozen=True, slots=True)
class FactTrouble:
    """What a MocapdError says."""

    what: str
    fix: str


@dataclass(frozen=True, slots=True)
class ConfigFacts:
    """file: None when there is none; trouble: why it cannot be used; then what is built in was looked at."""

    file: Path | None
    trouble: FactTrouble | None = None


@dataclass(frozen=True, slots=True)
class UserFacts:
    """groups: names of those that this process is in; video: whether the system has a group of that name."""

    name: str
    is_root: bool
    groups: frozenset[str]
    has_video_group: bool = True


@dataclass(frozen=True, slots=True)
class StateFacts:
    """Folders in which calibrations are kept. own: what is looked at; of_services: what services of this machine have
    in its place, told to root alone."""

    own: Path
    of_services: tuple[Path, ...] = ()


@dataclass(frozen=True, slots=True)
class CameraFacts:
    """nodes: the machine's; asked: webcams and others of configuration or calibration; crowded: buses that do not
    carry those of them that are plugged in."""

    nodes: tuple[CameraInfo, ...]
    asked: tuple[DraftCamera, ...]
    crowded: tuple[CrowdedBus, ...] = ()


@dataclass(frozen=True, slots=True)
class PortFacts:
    """A TCP port of this machine that the configuration wants. holder: who has it now; empty: nobody."""

    key: str
    port: int
    holder: str


@dataclass(frozen=True, slots=True)
class FolderFacts:
    """key: of the configuration; trouble: why it cannot be written to, or is not believed; open_to_others: somebody
    else may look into it; free_bytes: on its disk, None where that cannot be told; holds_little: only small files."""

    key: str
    path: Path
    trouble: FactTrouble | None
    open_to_others: bool
    free_bytes: int | None
    holds_little: bool = False


@dataclass(frozen=True, slots=True)
class CalibrationFacts:
    """path: None without any; trouble: why it cannot be used; age_s: since it was made [s]; rms_px, play_area_cm: as
    it was saved, None where not known; room_of: the cameras in it."""

    path: Path | None
    trouble: FactTrouble | None = None
    age_s: float = 0.0
    rms_px: float | None = None
    play_area_cm: float | None = None
    cameras: int = 0


@dataclass(frozen=True, slots=True)
class ProcessorFacts:
    """cores: that this process may use; governors: how many cores have each; driver: of the frequency."""

    cores: int
    governors: Mapping[str, int] = field(default_factory=dict)
    driver: str = ""


@dataclass(frozen=True, slots=True)
class ClockFacts:
    """now_unix_s: the wall clock; built_unix_s: when this mocapd was put here; synchronised: None where nobody tells."""

    now_unix_s: float
    built_unix_s: float
    synchronised: bool | None


@dataclass(frozen=True, slots=True)
class LibraryFacts:
    """python: its version; versions: of what was found; broken: why a library cannot be imported; wants_vrchat: the
    configuration looks for VRChat in the network; vrchat_fix: what installs the extra for it, empty where it is there."""

    python: str
    versions: Mapping[str, str]
    broken: Mapping[str, str]
    wants_vrchat: bool = False
    vrchat_fix: str = ""


@dataclass(frozen=True, slots=True)
class PreparationFacts:
    """Whether kernels and pose database of this version are there (`done`), or are being made now (`under_way`)."""

    done: bool
    under_way: bool = False


@dataclass(frozen=True, slots=True)
class Facts:
    """Everything that is looked at."""

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
