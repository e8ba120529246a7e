"""Splits a changed configuration into live changes and changes that need a restart."""

from dataclasses import replace

from mocapd.config.sections import Config

# fixed while the process runs: outputs and page are open, and clients find them by name and folder
_FIXED = ("instance", "cache_dir", "state_dir", "prediction", "web")


def apply_live_changes(running: Config, wanted: Config) -> tuple[Config, tuple[str, ...]]:
    """The wanted configuration with the fixed values of the running one, and the names of changed keys and sections that
    need a restart."""
    fixed = {name: getattr(running, name) for name in _FIXED}
    waiting = [name for name in _FIXED if getattr(wanted, name) != fixed[name]]
    names = dict.fromkeys((*running.outputs, *wanted.outputs))
    waiting += [name for name in names if running.outputs.get(name) != wanted.outputs.get(name)]
    return replace(wanted, **fixed, outputs=running.outputs), tuple(waiting)
