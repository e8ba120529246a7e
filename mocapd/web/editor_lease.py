"""Lease for the setup's controls: of several browsers one edits, the others watch."""

GRACE_S = 2.0  # time for a reloading page to reclaim the lease [s]


class EditorLease:
    """Held by the first link. After it leaves, the next link to join within `GRACE_S` gets it, else the oldest one.
    Used from one thread; times are seconds of any clock."""

    def __init__(self) -> None:
        self._links: list[object] = []
        self._driver: object | None = None
        self._free_since_s = float("-inf")

    def join(self, link: object) -> None:
        """A page has connected."""
        self._links.append(link)
        if self._driver is None:
            self._driver = link

    def leave(self, link: object, now_s: float) -> None:
        """A page has disconnected."""
        self._links.remove(link)
        if self._driver is link:
            self._driver, self._free_since_s = None, now_s

    def take_over(self, link: object) -> None:
        """Give this page the lease."""
        self._driver = link

    def drives(self, link: object, now_s: float) -> bool:
        """True if this page holds the lease."""
        if self._driver is None and self._links and now_s - self._free_since_s >= GRACE_S:
            self._driver = self._links[0]
        return self._driver is link
