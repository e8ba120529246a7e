"""Two browsers at once: one drives the setup, the others look on."""

GRACE_S = 2.0  # a page that is loaded anew comes back to its seat within this [s]


class Seat:
    """Who drives. The first link does; when it leaves, the next to come within `GRACE_S`, else the
    one that has waited longest. Used from one thread; times are seconds of any clock."""

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
        """A page is gone."""
        self._links.remove(link)
        if self._driver is link:
            self._driver, self._free_since_s = None, now_s

    def take_over(self, link: object) -> None:
        """This one drives from now on."""
        self._driver = link

    def drives(self, link: object, now_s: float) -> bool:
        """Whether this one drives."""
        if self._driver is None and self._links and now_s - self._free_since_s >= GRACE_S:
            self._driver = self._links[0]
        return self._driver is link
