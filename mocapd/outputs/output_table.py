"""The outputs that exist: one line each in OUTPUTS, whose section of the configuration has the same name."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Protocol

from mocapd.errors import ConfigError
from mocapd.outputs.aim import address_text, aimed_by_destination
from mocapd.outputs.base import Sink
from mocapd.outputs.osc import osc_sink
from mocapd.outputs.prediction.predicted_sink import PredictedSink
from mocapd.outputs.prediction.prediction_params import PredictionParams
from mocapd.outputs.threaded import ThreadedSink
from mocapd.outputs.vmc import vmc_params
from mocapd.outputs.vmt import vmt_sink
from mocapd.outputs.vrchat import vrchat_sink
from mocapd.outputs.zenoh import zenoh_config
from mocapd.outputs.zenoh.zenoh_warnings import warnings

NOT_PREDICTED = PredictionParams()


class OutputSection(Protocol):
    """What a user may set of an output; a frozen dataclass whose docstring has the words for each key."""

    @property
    def enabled(self) -> bool: ...


@dataclass(frozen=True, slots=True)
class ZenohSection(zenoh_config.Params):
    """See zenoh_config.Params.

    enabled: publish on Zenoh
    """

    enabled: bool = True


@dataclass(frozen=True, slots=True)
class OscSection(osc_sink.Params):
    """See osc_sink.Params.

    enabled: send OSC over UDP
    destinations: list of `address:port`, numeric addresses only
    """

    enabled: bool = True


@dataclass(frozen=True, slots=True)
class VmcSection(vmc_params.Params):
    """See vmc_params.Params.

    enabled: send Virtual Motion Capture protocol over UDP, for VTuber programs and game engines
    """

    enabled: bool = False


@dataclass(frozen=True, slots=True)
class VRChatSection(vrchat_sink.Params):
    """See vrchat_sink.Params.

    enabled: send trackers of the body to VRChat
    """

    enabled: bool = False


@dataclass(frozen=True, slots=True)
class VmtSection(vmt_sink.Params):
    """See vmt_sink.Params.

    enabled: send trackers of the body to SteamVR, by the driver VMT (Virtual Motion Tracker)
    """

    enabled: bool = False


def _unlimited(_section: Any) -> float:
    """It sends as often as it is given a frame."""
    return math.inf


def _own_rate(section: VmcSection | VRChatSection) -> float:
    """It drops what comes faster than its own rate."""
    return section.rate_hz


def _safe(_section: Any) -> tuple[str, ...]:
    """It has no unsafe settings."""
    return ()


@dataclass(frozen=True, slots=True)
class OutputEntry:
    """`section`: its keys; `build`: the sink from its section and the daemon's name, imported only then.

    `blocks`: whether `send` or `tell` may take longer than a millisecond or two: then it gets a thread of
    its own; `unsafe`: a line for each setting that is permitted and yet unsafe; `aimed`: its section, but to
    one host (a numeric address) and port, None where the section says it; `limit_hz`: how many frames a second
    it sends at most [Hz].
    """

    section: Callable[[], OutputSection]
    build: Callable[[Any, str], Sink]
    blocks: bool
    unsafe: Callable[[Any], tuple[str, ...]] = _safe
    aimed: Callable[[Any, str | None, int | None], Any] = aimed_by_destination
    limit_hz: Callable[[Any], float] = _unlimited


def _zenoh(section: ZenohSection, instance: str) -> Sink:
    from mocapd.outputs.zenoh.zenoh_sink import ZenohSink

    return ZenohSink(section, instance)


def _zenoh_aimed(section: ZenohSection, host: str | None, port: int | None) -> ZenohSection:
    """At a host there is a router to join; without one, games come to this machine."""
    number = section.port if port is None else port
    if host is None:
        return replace(section, port=number, listen=(), connect=())
    return replace(section, connect=(f"tcp/{address_text(host, number)}",))


def _osc(section: OscSection, _instance: str) -> Sink:
    return osc_sink.OscSink(section)


def _vmc(section: VmcSection, _instance: str) -> Sink:
    from mocapd.outputs.vmc.vmc_sink import VmcSink

    return VmcSink(section)


def _vrchat(section: VRChatSection, _instance: str) -> Sink:
    return vrchat_sink.VRChatSink(section)


def _vmt(section: VmtSection, _instance: str) -> Sink:
    return vmt_sink.VmtSink(section)


OUTPUTS: Mapping[str, OutputEntry] = MappingProxyType(
    {
        # Drops what a subscriber does not take. Measured, 3.1 kB frames: median 0.08 ms to one that reads,
        # 0.05 ms over 10,000 frames to one that is stopped and never does.
        "zenoh": OutputEntry(
            ZenohSection, _zenoh, blocks=False, unsafe=warnings, aimed=_zenoh_aimed
        ),
        # Non-blocking sockets and numeric addresses: a full buffer is an error that is counted. Measured: median
        # 0.07 ms, also when nobody ever reads.
        "osc": OutputEntry(OscSection, _osc, blocks=False),
        # The same sockets.
        "vmc": OutputEntry(VmcSection, _vmc, blocks=False, limit_hz=_own_rate),
        # The same, and less of it; what looks for VRChat has a thread of its own.
        "vrchat": OutputEntry(
            VRChatSection,
            _vrchat,
            blocks=False,
            unsafe=vrchat_sink.warnings,
            limit_hz=_own_rate,
        ),
        # The same socket, and one bundle of a constant size.
        "vmt": OutputEntry(VmtSection, _vmt, blocks=False),
    }
)


def output_sections() -> dict[str, Callable[[], OutputSection]]:
    """The section of each output by its name."""
    return {name: entry.section for name, entry in OUTPUTS.items()}


def default_sections() -> Mapping[str, OutputSection]:
    """Every output as it is when nothing is configured."""
    return {name: entry.section() for name, entry in OUTPUTS.items()}


def build_sinks(
    sections: Mapping[str, OutputSection],
    instance: str,
    prediction: PredictionParams = NOT_PREDICTED,
) -> tuple[Sink, ...]:
    """A sink for each output that is enabled; one that is not named is not. Raises ConfigError for a prediction
    of an output that does not exist."""
    unknown = [name for name in prediction.outputs if name not in OUTPUTS]
    if unknown:
        raise ConfigError(
            f"no output is called {unknown[0]!r}",
            "prediction.outputs",
            f"some of: {', '.join(OUTPUTS)}",
        )
    sinks: list[Sink] = []
    for name, entry in OUTPUTS.items():
        section = sections.get(name)
        if section is not None and section.enabled:
            sink = entry.build(section, instance)
            rate_hz = prediction.rate_hz(name, entry.limit_hz(section))
            if rate_hz > 0.0:
                sinks.append(PredictedSink(sink, rate_hz, prediction.ahead_ms / 1e3))
            else:
                sinks.append(ThreadedSink(sink) if entry.blocks else sink)
    return tuple(sinks)


def unsafe_outputs(sections: Mapping[str, OutputSection]) -> list[str]:
    """A line for each setting of an output that is enabled, permitted and yet unsafe."""
    return [
        line
        for name, section in sections.items()
        if section.enabled
        for line in OUTPUTS[name].unsafe(section)
    ]


def zenoh_section(sections: Mapping[str, OutputSection]) -> ZenohSection:
    """That of Zenoh, for who connects as a client."""
    section = sections["zenoh"]
    assert isinstance(section, ZenohSection)
    return section
