"""The stream of a daemon that runs, and what can go wrong with it: none there, silent, of another version."""

import threading
from dataclasses import replace

from goalkeeper.streams.sighting import Sighting, StreamState, pose_of_frame
from mocapd.client import Body, Client, Link
from mocapd.errors import ConfigError, InputError, UnavailableError

_SILENT_S = 1.0  # without a frame, before it is said
_MOST_AGE_S = 1.0  # of a frame; beyond that two machines' clocks disagree
_USUAL_AGE_S = 0.05  # taken instead
_MOST_AHEAD_S = 0.1  # of a pose that the daemon predicts
_ATTEMPT_S = 2.0


class LiveStream:
    """The newest frame of one daemon; connects in a thread of its own, so that the game's window opens at once."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self._client: Client | None = None
        self._trouble = f"looking for mocapd at {link.endpoint}"
        self._closed = threading.Event()
        self._heard_s: float | None = None
        self._now_s = 0.0
        self._slow = ""
        self._thread = threading.Thread(target=self._connect, name="connect", daemon=True)
        self._thread.start()

    def _connect(self) -> None:
        """Until there is a daemon, or nobody wants one."""
        link = replace(self._link, connect_timeout_s=_ATTEMPT_S)
        while not self._closed.is_set():
            try:
                client = Client(link)
            except UnavailableError as error:
                self._trouble = str(error)
                continue
            except ConfigError as error:  # of an address that is none: another attempt is the same
                self._trouble = str(error)
                return
            if self._closed.is_set():
                client.close()
                return
            self._client = client
            self._trouble = ""
            return

    def poll(self, now_s: float) -> list[Sighting]:
        """The newest frame, when there is one; now_s: of the monotonic clock."""
        self._now_s = now_s
        client = self._client
        if client is None:
            return []
        try:
            body = client.poll()
        except (InputError, UnavailableError) as error:
            self._trouble = str(error)
            self._heard_s = now_s
            return []
        self._look_at_health(client)
        if body is None:
            return []
        self._trouble, self._heard_s = "", now_s
        return [Sighting(_captured_s(body, now_s), pose_of_frame(body.frame))]

    def _look_at_health(self, client: Client) -> None:
        try:
            health = client.health()
        except (InputError, UnavailableError):
            return  # of another version: the frames say so
        self._slow = "" if health is None else health.slowness

    @property
    def has_heard(self) -> bool:
        """Whether a frame came, or something that is none."""
        return self._heard_s is not None

    def state(self) -> StreamState:
        """Whether frames come."""
        if self._trouble or self._client is None:
            return StreamState(self._trouble)
        if self._heard_s is None:
            return StreamState("mocapd is there: waiting for its first frame")
        if self._now_s - self._heard_s > _SILENT_S:
            return StreamState("the stream has stopped: is mocapd still running?")
        return StreamState(slow=self._slow)

    def close(self) -> None:
        """Disconnect."""
        self._closed.set()
        client, self._client = self._client, None
        if client is not None:
            client.close()


def _captured_s(body: Body, now_s: float) -> float:
    """When it was exposed, or the time that it is predicted for: by the sender's monotonic clock, which on one machine is
    that of now_s, else by Unix time."""
    by_monotonic_s = body.frame.capture_monotonic_ns * 1e-9
    for captured_s in (by_monotonic_s, now_s - body.age_s):
        if -_MOST_AHEAD_S <= now_s - captured_s <= _MOST_AGE_S:
            return captured_s
    return now_s - _USUAL_AGE_S
