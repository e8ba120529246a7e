"""Facts of the TCP ports that the configuration needs: the programs that use them."""

from mocapd.config.sections import Config
from mocapd.doctor.facts import PortFacts
from mocapd.outputs.output_table import zenoh_section
from mocapd.outputs.socket_owners import holder_of


def port_facts(config: Config) -> tuple[PortFacts, ...]:
    """Zenoh's port on this machine, and the page's if it is fixed."""
    wanted = []
    zenoh = zenoh_section(config.outputs)
    if zenoh.enabled and not zenoh.connect and not zenoh.listen:
        wanted.append(("zenoh.port", zenoh.port))
    if config.web.enabled and config.web.port:
        wanted.append(("web.port", config.web.port))
    return tuple(PortFacts(key, port, holder_of(port)) for key, port in wanted)
