"""All outputs of a configuration, opened together before the first session and open until the service ends."""

from contextlib import ExitStack

from mocapd.clock import monotonic_ns, seconds
from mocapd.config.sections import Config
from mocapd.outputs.instance import instance_name
from mocapd.outputs.output_table import build_sinks


class OpenOutputs:
    """`instance`: the daemon's name in the messages."""

    def __init__(self, config: Config) -> None:
        self.instance = instance_name(config.instance)
        self.sinks = build_sinks(config.outputs, self.instance, config.prediction)
        self._opened: ExitStack | None = None
        self._opened_ns = monotonic_ns()

    def __enter__(self) -> "OpenOutputs":
        self.open()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def open(self) -> None:
        """Opens all or none; idempotent. Raises the error of the failing output."""
        if self._opened is not None:
            return
        with ExitStack() as opened:
            for sink in self.sinks:
                opened.callback(sink.close)
                sink.open()
            self._opened = opened.pop_all()
        self._opened_ns = monotonic_ns()

    @property
    def uptime_s(self) -> float:
        """Since they were opened [s]."""
        return seconds(monotonic_ns() - self._opened_ns)

    def close(self) -> None:
        """Closes all; idempotent."""
        opened, self._opened = self._opened, None
        if opened is not None:
            opened.close()
