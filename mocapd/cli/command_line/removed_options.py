"""Removed options of earlier versions, with advice for each."""

from collections.abc import Mapping, Sequence

from mocapd.config.removed_keys import REMOVED
from mocapd.errors import UsageError

_STUDIES = {
    "--compare": "lab.evaluation",
    "--simulated": "lab.evaluation",
    "--clothes": "lab.evaluation",
    "--failures": "lab.failures",
    "--interruptions": "lab.interruptions",
    "--prediction": "lab.prediction",
}
_REMOVED: Mapping[tuple[str, str], str] = {
    **{
        (command, "--variant"): REMOVED["tracker.variant"] for command in ("track", "eval", "bench")
    },
    **{
        ("eval", option): f"in a checkout of mocapd's source run `python -m {module} --help`"
        for option, module in _STUDIES.items()
    },
}


def refuse_removed_options(words: Sequence[str]) -> None:
    """Raises UsageError if the command line, without the program's name, has a removed option."""
    for word in words[1:]:
        option = word.partition("=")[0]
        advice = _REMOVED.get((words[0], option))
        if advice is not None:
            raise UsageError(
                f"`mocapd {words[0]}` has no {option} any more", "command line", advice
            )
