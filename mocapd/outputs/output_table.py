"""The table of outputs: one entry each in OUTPUTS; its section of the configuration has the same name."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Protocol

from mocapd.errors import ConfigError
from mocapd.outputs.address_override import address_text, override_destination, resolve_host
from mocapd.outputs.base import Sink
from mocapd.outputs.osc import osc_sink
from mocapd.outputs.prediction.predicted_sink import PredictedSink
from mocapd.outputs.prediction.prediction_params import PredictionParams
from mocapd.outputs.vmc import vmc_params
from mocapd.outputs.vmt import vmt_sink
from mocapd.outputs.vrchat import vrchat_sink
from mocapd.outputs.zenoh import zenoh_config
from mocapd.outputs.zenoh.zenoh_warnings import warnings

NOT_PREDICTED = PredictionParams()


class OutputSection(Protocol):
    """A user's settings of an output: a frozen dataclass whose docstring describes each key."""

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


def _no_limit(_section: Any) -> float:
    """The output sends every frame."""
    return math.inf


def _own_rate(section: VmcSection | VRChatSection) -> float:
    """The output drops frames above its own rate."""
    return section.rate_hz


def _safe(_section: Any) -> tuple[str, ...]:
    """The output has no unsafe settings."""
    return ()


@dataclass(frozen=True, slots=True)
class OutputEntry:
    """`section`: its settings; `build`: makes the sink from its section and the daemon's name, importing it then.

    `unsafe`: one warning for each permitted but unsafe setting. `override_address`: the section with another host
    (address or name) and port, None: unchanged. `limit_hz`: the output's own highest rate [Hz]. `uses_facing`: True if it
    uses the forward direction of `mocapd recenter`.
    """

    section: Callable[[], OutputSection]
    build: Callable[[Any, str], Sink]
    unsafe: Callable[[Any], tuple[str, ...]] = _safe
    override_address: Callable[[Any, str | None, int | None], Any] = override_destination
    limit_hz: Callable[[Any], float] = _no_limit
    uses_facing: bool = False


def _zenoh(section: ZenohSection, instance: str) -> Sink:
    from mocapd.outputs.zenoh.zenoh_sink import ZenohSink

    return ZenohSink(section, instance)


def _override_zenoh(section: ZenohSection, host: str | None, port: int | None) -> ZenohSection:
    """With a host: join its router, by the protocol and port of the configured one. Without: listen on this machine.

    Raises UnavailableError for a name without an address; any other stays a name, as a certificate is for one.
    """
    if host is None:
        number = section.port if port is None else port
        return replace(section, port=number, listen=(), connect=())
    resolve_host(host)
    configured = (*section.connect, f"tcp/:{section.port}")[0]
    protocol, _, address = zenoh_config.without_options(configured).partition("/")
    number = int(address.rpartition(":")[2]) if port is None else port
    return replace(section, listen=(), connect=(f"{protocol}/{address_text(host, number)}",))


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
        # Drops frames for a slow subscriber. Measured with frames of 3.1 kB: median 0.08 ms to a subscriber that reads,
        # 0.05 ms over 10,000 frames to a stopped one.
        "zenoh": OutputEntry(
            ZenohSection,
            _zenoh,
            unsafe=warnings,
            override_address=_override_zenoh,
            uses_facing=True,
        ),
        # Non-blocking sockets and numeric addresses: a full buffer is an error that is counted. Measured: median
        # 0.07 ms, also without a reader.
        "osc": OutputEntry(OscSection, _osc),
        # The same sockets.
        "vmc": OutputEntry(VmcSection, _vmc, limit_hz=_own_rate),
        # The same, with fewer bytes; the search for VRChat has a thread of its own.
        "vrchat": OutputEntry(
            VRChatSection,
            _vrchat,
            unsafe=vrchat_sink.warnings,
            limit_hz=_own_rate,
            uses_facing=True,
        ),
        # The same socket, one bundle of a constant size.
        "vmt": OutputEntry(VmtSection, _vmt, uses_facing=True),
    }
)


def output_sections() -> dict[str, Callable[[], OutputSection]]:
    return {name: entry.section for name, entry in OUTPUTS.items()}


def default_sections() -> Mapping[str, OutputSection]:
    return {name: entry.section() for name, entry in OUTPUTS.items()}


def build_sinks(
    sections: Mapping[str, OutputSection],
    instance: str,
    prediction: PredictionParams = NOT_PREDICTED,
) -> tuple[Sink, ...]:
    """A sink for each enabled output in `sections`. Raises ConfigError if `prediction` names an unknown output."""
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
                sink = PredictedSink(sink, rate_hz, prediction.ahead_ms / 1e3)
            sinks.append(sink)
    return tuple(sinks)


def unsafe_outputs(sections: Mapping[str, OutputSection]) -> list[str]:
    """One warning for each permitted but unsafe setting of the enabled outputs."""
    return [
        line
        for name, section in sections.items()
        if section.enabled
        for line in OUTPUTS[name].unsafe(section)
    ]


def zenoh_section(sections: Mapping[str, OutputSection]) -> ZenohSection:
    section = sections["zenoh"]
    assert isinstance(section, ZenohSection)
    return section
