"""Access control of /metrics: only for a Prometheus with the key.

The page's token changes with each start, which a collector cannot follow. So this address has a key of its own, as
`Authorization: Bearer KEY`, which opens nothing else. The metrics show when a person plays and how many cameras there
are: this is private from other users of this machine.
"""

from dataclasses import dataclass
from pathlib import Path

from starlette.requests import HTTPConnection

from mocapd.web.stored_key import key_of, same_secret

PATH = "/metrics"
FILE_NAME = "metrics.key"  # in the state directory
_SCHEME = "bearer"


@dataclass(frozen=True, slots=True)
class MetricsAccess:
    """key: empty where the figures are not served."""

    key: str = ""

    @property
    def enabled(self) -> bool:
        """True if the metrics are served."""
        return bool(self.key)

    def lets_in(self, connection: HTTPConnection) -> bool:
        """True for a request with the key. The caller also checks Host and Origin."""
        if connection.scope["type"] != "http" or connection.scope["path"] != PATH or not self.key:
            return False
        scheme, _, given = connection.headers.get("authorization", "").partition(" ")
        return scheme.lower() == _SCHEME and same_secret(given, self.key)


def metrics_access(enabled: bool, state_dir: Path | None) -> MetricsAccess:
    """Access with the key stored in `state_dir`; None: a temporary key. Raises as `stored_key`."""
    return MetricsAccess(key_of(state_dir, FILE_NAME)) if enabled else MetricsAccess()
