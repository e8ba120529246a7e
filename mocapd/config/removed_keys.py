"""Removed keys of earlier versions, with advice for each."""

from collections.abc import Mapping


def _each(prefix: str, names: str, advice: str) -> Mapping[str, str]:
    return {f"{prefix}.{name}": advice for name in names.split()}


_STUDY = "it served studies only, which lab/compared/ablations.py now does: leave it out"

REMOVED: Mapping[str, str] = {
    "tracker.variant": 'the published method is a tracker now: tracker.name = "wang2011"',
    "tracker.colour_model": "it is shirt.colour_model now: write colour_model = ... under [shirt]",
    "tracker.confirm_s": "no other value did better: leave it out",
    "tracker.auto.trackers": 'name one tracker: tracker.name = "shirt" or "markerless"',
    **_each("tracker.canned", "loop_s waves sway_m", _STUDY),
    **_each("tracker.colour", "learn_shape live_match accept_match", _STUDY),
    **_each("tracker.colour_paper", "baseline tolerant", _STUDY),
    **_each(
        "tracker.flex",
        "live_explained accept_explained joints texture depths floor arm_search leg_search faces turns shadows "
        "look_alikes limits steady",
        _STUDY,
    ),
    **_each(
        "tracker.flex_paper",
        "particles depth_noise particle_constraints occlusion appearance",
        _STUDY,
    ),
    **_each(
        "bundler",
        "period_s slack_periods longest_wait_periods hysteresis_periods patience",
        "write how long a picture may be late in seconds: wait_s = ... under [bundler]",
    ),
    **{
        f"{output}.predict_{name}": f"all outputs share it: write {name} = ... under [prediction]"
        for output in ("zenoh", "osc", "vmc", "vrchat")
        for name in ("hz", "ahead_ms")
    },
}
