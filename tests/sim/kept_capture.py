"""Captures of simulated scenarios, exported once: drawing them takes longer than what looks at them."""

import tempfile
from pathlib import Path

from lab.simulated.export import export_capture
from mocapd.file_lock import one_at_a_time
from mocapd.sim.film import film_key
from mocapd.sim.scenario import Scenario


def kept_capture(scenario: Scenario, seconds: float, cache_home: Path) -> Path:
    """The folder of so much of this scenario, named as that; nobody may change it.

    It is made anew when the scenario or the code that draws it has changed.
    """
    folder = cache_home / "captures" / f"{film_key(scenario)[:16]}-{seconds:g}s"
    with one_at_a_time(folder.parent, f"{folder.name}.lock"):
        if folder.is_dir():
            return folder / scenario.name
        partial = Path(tempfile.mkdtemp(dir=folder.parent, prefix="partial-"))
        export_capture(scenario, partial / scenario.name, seconds)
        partial.rename(folder)
    return folder / scenario.name
