"""Every attack by its name. Whoever writes another adds the table of its module here."""

from tests.attacks import (
    control_requests,
    frozen_at_the_end,
    frozen_beside_newcomers,
    large_messages,
    malicious_nodes,
    page_connections,
    page_requests,
    silent,
)
from tests.attacks.scenario import Scenario

SCENARIOS: dict[str, Scenario] = (
    frozen_at_the_end.SCENARIOS
    | frozen_beside_newcomers.SCENARIOS
    | silent.SCENARIOS
    | large_messages.SCENARIOS
    | malicious_nodes.SCENARIOS
    | page_connections.SCENARIOS
    | page_requests.SCENARIOS
    | control_requests.SCENARIOS
)
