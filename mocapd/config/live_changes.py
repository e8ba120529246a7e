"""What of a changed configuration a running daemon takes up, and what waits for its next start."""

from dataclasses import replace

from mocapd.config.sections import Config

# what lives as long as the process: outputs and page are open, and found by name and folder
_FIXED = ("instance", "cache_dir", "state_dir", "prediction", "web")


def taken_live(running: Config, wanted: Config) -> tuple[Config, tuple[str, ...]]:
    """The wanted configuration with what cannot change from the running one, and the names of the keys and
    sections in which they differ there."""
    fixed = {name: getattr(running, name) for name in _FIXED}
    waiting = [name for name in _FIXED if getattr(wanted, name) != fixed[name]]
    names = dict.fromkeys((*running.outputs, *wanted.outputs))
    waiting += [one for one in names if running.outputs.get(one) != wanted.outputs.get(one)]
    return replace(wanted, **fixed, outputs=running.outputs), tuple(waiting)
