"""The table of source kinds, and look-ups by a camera's address."""

from collections.abc import Iterable
from pathlib import Path

from mocapd.boundary.files import user_path
from mocapd.boundary.urls import without_password
from mocapd.capture.base import Source
from mocapd.capture.camera_link import CameraLink
from mocapd.capture.kinds.file_kind import FILE
from mocapd.capture.kinds.folder_kind import FOLDER
from mocapd.capture.kinds.mcap_kind import RECORDING
from mocapd.capture.kinds.remote_kind import REMOTE
from mocapd.capture.kinds.source_kind import SourceKind
from mocapd.capture.kinds.url_kind import URL
from mocapd.capture.origin import Origin, OriginKind, Progress, split_address
from mocapd.capture.simulated.sim_kind import SIM
from mocapd.capture.source_request import SourceRequest
from mocapd.capture.webcam.identity import WebcamIdentity
from mocapd.capture.webcam.webcam_kind import NODE, WEBCAM
from mocapd.errors import ConfigError, InputError

SOURCE_KINDS: tuple[SourceKind, ...] = (WEBCAM, NODE, URL, REMOTE, SIM, RECORDING, FILE, FOLDER)
"""The first match wins; paths come last, as any text can be a path."""

SOURCE_FORMS = ", ".join(kind.form for kind in SOURCE_KINDS[:-1]) + f" or {SOURCE_KINDS[-1].form}"
"""The forms of an address, for users."""


def kind_of(address: str) -> SourceKind | None:
    """The kind of a camera's or origin's address; None for anything else, such as a missing file.

    Raises ConfigError for an invalid path.
    """
    return next((kind for kind in SOURCE_KINDS if kind.matches(address)), None)


def open_source(address: str, request: SourceRequest | None = None) -> Source:
    """The source of an address; checked but not opened.

    Raises ConfigError or InputError, also for a missing or damaged recording, which no retry can mend.
    """
    request = request if request is not None else SourceRequest()
    kind = kind_of(address)
    if kind is None:  # also a URL with a typo in its scheme comes here
        raise InputError(
            "no such camera or file", without_password(address), f"write {SOURCE_FORMS}"
        )
    return kind.open(address, request)


def identity_of(address: str) -> WebcamIdentity | None:
    """Which webcam it is; None for what has no identity. Raises ConfigError for a wrong one."""
    kind = kind_of(address)
    return kind.identity(address) if kind is not None and kind.identity is not None else None


def identities_of(addresses: Iterable[tuple[str, str]]) -> dict[str, WebcamIdentity]:
    """The webcams' identities by id, of cameras given as (id, address). Raises ConfigError."""
    identities = {name: identity_of(address) for name, address in addresses}
    return {name: identity for name, identity in identities.items() if identity is not None}


def is_simulated(address: str) -> bool:
    """True for a simulated camera."""
    kind = kind_of(address)
    return kind is not None and kind.is_simulated


def link_of(address: str) -> CameraLink:
    """Where a camera's frames can be lost. Raises ConfigError for an invalid path."""
    kind = kind_of(address)
    return kind.link if kind is not None else CameraLink.PLAYER


def is_settable(address: str) -> bool:
    """True if the camera can deliver a requested size."""
    kind = kind_of(address)
    return kind is not None and kind.is_settable


def origin_of(address: str) -> str:
    """The origin of a camera; empty for a camera without one."""
    kind = kind_of(address)
    return split_address(address)[0] if kind is not None and kind.origin is not None else ""


def common_origin(addresses: Iterable[str]) -> str:
    """The origin that all cameras share; empty without one. Raises ConfigError where only some are simulated."""
    cameras = tuple(addresses)
    origins = {origin_of(address) for address in cameras}
    if any(map(is_simulated, cameras)) and (len(origins) > 1 or origins == {""}):
        raise ConfigError(
            "simulated cameras must all be of one scenario",
            "camera",
            "write source = sim:SCENARIO#CAMERA for each",
        )
    return origins.pop() if len(origins) == 1 else ""


def cameras_of_origin(origin: str) -> tuple[str, ...]:
    """The names of all its cameras. Raises InputError or ConfigError."""
    return _origin_kind(origin).cameras(origin)


def open_origin(
    origin: str, cache_dir: Path, progress: Progress, is_beginning: bool = False
) -> Origin:
    """Opens an origin; `is_beginning`: the part that is ready soonest suffices. Raises InputError, ConfigError or
    CannotCreateError."""
    kind = _origin_kind(origin)
    opened = kind.open_beginning if is_beginning and kind.open_beginning is not None else kind.open
    return opened(origin, cache_dir, progress)


def is_made(origin: str, cache_dir: Path) -> bool:
    """False if opening the origin would render it first. Raises InputError or ConfigError."""
    return _origin_kind(origin).is_made(origin, cache_dir)


def address_in_folder(folder: Path, address: str) -> str:
    """Resolves an address that a file in this folder holds. Raises ConfigError."""
    kind = kind_of(address)
    if kind is not None and not kind.is_path:
        return address
    path = str(folder / user_path(address))
    kind = kind_of(path)
    return path if kind is not None and kind.is_path else address


def _origin_kind(origin: str) -> OriginKind:
    kind = kind_of(origin)
    if kind is None or kind.origin is None:
        raise InputError("no such capture folder", without_password(origin), "check the path")
    return kind.origin
