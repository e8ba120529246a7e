"""Implementation of `mocapd camera-node`: the configured cameras, a status line, an orderly end."""

import logging
import threading
import traceback
from typing import TYPE_CHECKING

from mocapd.app.daemon.unsafe_settings import unsafe_settings
from mocapd.app.libraries import prepare_libraries
from mocapd.app.terminal.logs import set_up_logs
from mocapd.errors import ConfigError

if TYPE_CHECKING:
    from mocapd.config.effective import Effective
    from mocapd.node.node_service import CameraNode

SHOW_EVERY_S = 0.5  # how often the status line changes [s]

_log = logging.getLogger(__name__)


def run_camera_node(effective: "Effective", imperfect: str) -> int:
    """Runs until a signal; returns the exit code. Raises MocapdError."""
    config = effective.config
    set_up_logs(config.log_level)
    if not config.camera:
        raise ConfigError(
            "no camera is configured",
            "camera-node",
            "add [[camera]] (see `mocapd cameras`), or --camera ID=SOURCE",
        )
    prepare_libraries(config.cache_dir)
    for line in unsafe_settings(effective):
        _log.warning("unsafe: %s", line)

    from mocapd.app.daemon.main_loop import END_S, INTERNAL_ERROR, Signals, end_despite_work
    from mocapd.app.daemon.notifier import Notifier
    from mocapd.app.terminal.progress import ProgressBars
    from mocapd.app.terminal.status_line import StatusLine
    from mocapd.boundary.image_decoding import REDUCTIONS
    from mocapd.capture.decoder_warnings import DecoderWarnings
    from mocapd.capture.kinds.source_kinds import common_origin, open_origin
    from mocapd.latch import ThreadDiedError
    from mocapd.node.network_emulation import parse_imperfections
    from mocapd.node.node_service import CameraNode
    from mocapd.outputs.output_table import zenoh_section
    from mocapd.session.camera_inputs import camera_inputs

    signals, notifier = Signals(within_s=END_S), Notifier.of_environment()
    origin = common_origin(camera.source for camera in config.camera)
    with ProgressBars() as progress:
        opened = open_origin(origin, config.cache_dir, progress) if origin else None
    smallest = dict.fromkeys((camera.id for camera in config.camera), max(REDUCTIONS))
    inputs = camera_inputs(config.camera, None, opened, config.node.size_px, smallest)
    faults = parse_imperfections(imperfect) if imperfect else None
    node = CameraNode(config.instance, zenoh_section(config.outputs), config.node, inputs, faults)
    # an exception in any thread must end the process
    threading.excepthook = lambda args: node.died(args.exc_value or RuntimeError(args.exc_type))
    signals.ends(node)
    try:
        with node, DecoderWarnings(), StatusLine() as shown:
            print("\n".join(_how_to(node)), flush=True)
            notifier.ready(_camera_states(node))
            while not node.wait(SHOW_EVERY_S):
                shown.say(lambda: state_text(node))
                notifier.status(_camera_states(node))
                if notifier.is_heartbeat_due:
                    notifier.heartbeat()
            notifier.stopping()
    except ThreadDiedError as error:
        traceback.print_exception(error.__cause__)
        return INTERNAL_ERROR
    end_despite_work(signals.exit_code)
    return signals.exit_code


def _how_to(node: "CameraNode") -> list[str]:
    sources = [f'    source = "{address}"' for address in node.addresses()]
    return ["in the daemon's configuration, one [[camera]] for each of:", *sources]


def _camera_states(node: "CameraNode") -> str:
    """A word for each camera, without figures."""
    return ", ".join(f"{camera.name} {camera.state.state}" for camera in node.cameras)


def state_text(node: "CameraNode") -> str:
    """One line: each camera's rate or trouble, and the number of sent pictures."""
    parts = []
    for camera in node.cameras:
        state = camera.state
        how = f"{state.rate_hz:.1f} Hz" if state.state == "live" else state.state
        parts.append(f"{camera.name} {how}, {camera.sent} sent")
    return f"{node.name} | " + " | ".join(parts)
