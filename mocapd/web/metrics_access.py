"""Who may have the figures of /metrics: a Prometheus that was given the key, and nobody else.

The page's token changes with each start, and a collector cannot follow it. So this one address has a key of its own, as
`Authorization: Bearer KEY`; it opens nothing else. The figures say when somebody plays, and how many cameras there are: other
users of this machine do not get them for nothing.
"""

import secrets
from dataclasses import dataclass
from pathlib import Path

from starlette.requests import HTTPConnection

from mocapd.web.kept_key import kept_key, new_key

PATH = "/metrics"
FILE_NAME = "metrics.key"  # in the state directory
_SCHEME = "bearer"


@dataclass(frozen=True, slots=True)
class MetricsAccess:
    """key: empty where the figures are not served."""

    key: str = ""

    @property
    def enabled(self) -> bool:
        """Whether there is something at the address."""
        return bool(self.key)

    def lets_in(self, connection: HTTPConnection) -> bool:
        """Whether this one has the key. Its Host and Origin are looked at besides."""
        if connection.scope["type"] != "http" or connection.scope["path"] != PATH or not self.key:
            return False
        scheme, _, given = connection.headers.get("authorization", "").partition(" ")
        return scheme.lower() == _SCHEME and secrets.compare_digest(
            given.encode(errors="replace"), self.key.encode()
        )


def metrics_access(enabled: bool, state_dir: Path | None) -> MetricsAccess:
    """With the key that is kept in `state_dir`; None: a new one, kept nowhere. Raises as `kept_key`."""
    if not enabled:
        return MetricsAccess()
    return MetricsAccess(new_key() if state_dir is None else kept_key(state_dir / FILE_NAME))
