"""A short run of one fault: what half an hour of them shows, in seconds."""

from tests.module_run import module_run

SHARE = "0.025"


def short_run(name: str, env: dict[str, str], share: str = SHARE) -> str:
    """What a row prints; the test fails with it when something was not as it should be."""
    return module_run(env, "tests.faults", name, "--share", share)
