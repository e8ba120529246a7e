"""The wire schema `mocapd.Skeleton.v1`: what a subscriber decodes."""

import msgspec


class Joint(msgspec.Struct, frozen=True, gc=False):
    """One bone: `p` position [m, world], `r` global and `l` local rotation (xyzw), `c` confidence 0..1."""

    p: tuple[float, float, float]
    r: tuple[float, float, float, float]
    l: tuple[float, float, float, float]  # noqa: E741 (the wire's short key)
    c: float


class SkeletonFrame(msgspec.Struct, frozen=True):
    """One person at one instant, as sent. Lost: `joints` is empty."""

    schema: str
    instance: str
    person: int
    seq: int
    capture_monotonic_ns: int
    capture_unix_ns: int
    publish_monotonic_ns: int
    tracker: str
    tracking: str
    cameras: tuple[str, ...]
    joints: dict[str, Joint]
