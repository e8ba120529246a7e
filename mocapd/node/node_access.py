"""Access control of a camera node: every client may receive pictures, only the paired daemon may set cameras."""

from typing import Any

from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.camera_wire import ANY
from mocapd.config.node_params import Params
from mocapd.errors import ConfigError
from mocapd.outputs.zenoh import zenoh_config


def check_pairing(zenoh: zenoh_config.Params, node: Params) -> None:
    """Raises ConfigError where the node could not identify the paired daemon."""
    if node.paired_user and zenoh.connect:
        raise ConfigError(
            "behind a router clients cannot be identified",
            "node.paired_user",
            "leave it empty; let the router's access control guard mocapd-camera/v1/*/*/control, and set"
            " node.router_decides = true",
        )
    if node.paired_user and not (zenoh.password_file or zenoh.tls_require_client):
        raise ConfigError(
            f"no client can authenticate as {node.paired_user!r}",
            "node.paired_user",
            "set zenoh.password_file with that user, or zenoh.tls_require_client",
        )
    if node.router_decides and not zenoh.connect:
        raise ConfigError(
            "there is no router to decide",
            "node.router_decides",
            "set zenoh.connect, or node.paired_user in its place",
        )


def takes_orders(node: Params) -> bool:
    """True if some client may set its cameras."""
    return bool(node.paired_user) or node.router_decides


def node_session_config(zenoh: zenoh_config.Params, node: Params, name: str) -> dict[str, Any]:
    """Zenoh's configuration of a node of this name."""
    config = zenoh_config.session_config(zenoh)
    config.pop("adminspace", None)
    if not zenoh.connect:
        config["access_control"] = _access(zenoh, node, name)
    return config


def _access(zenoh: zenoh_config.Params, node: Params, name: str) -> dict[str, Any]:
    keys = [camera_wire.picture(name, ANY), camera_wire.alive(name, ANY)]
    # of any node: a search for cameras does not know our name
    questions = [camera_wire.state(ANY, ANY), camera_wire.clock(name)]
    orders = [camera_wire.control(name, ANY)]
    rules: list[dict[str, Any]] = [
        _rule(
            "look",
            ["declare_subscriber", "liveliness_query", "declare_liveliness_subscriber"],
            "ingress",
            keys,
        ),
        _rule("ask", ["query"], "ingress", questions),
        _rule(
            "tell",
            ["put", "delete", "reply", "liveliness_token"],
            "egress",
            [*keys, *questions, *orders],
        ),
    ]
    subjects: list[dict[str, Any]] = [{"id": "anyone"}]
    policies = [{"rules": ["look", "ask", "tell"], "subjects": ["anyone"]}]
    if node.paired_user:
        by = "usernames" if zenoh.password_file else "cert_common_names"
        rules.append(_rule("set", ["query"], "ingress", orders))
        subjects.append({"id": "paired", by: [node.paired_user]})
        policies.append({"rules": ["set"], "subjects": ["paired"]})
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    }


def _rule(name: str, messages: list[str], flow: str, keys: list[str]) -> dict[str, Any]:
    return {
        "id": name,
        "messages": messages,
        "flows": [flow],
        "permission": "allow",
        "key_exprs": keys,
    }
