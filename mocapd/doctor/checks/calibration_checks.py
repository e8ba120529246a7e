"""Check of the calibration: present, readable, recent, and accurate."""

from mocapd.doctor.facts import CalibrationFacts
from mocapd.doctor.finding import Finding, bad, ok, warn
from mocapd.user_command import user_command

OLD_S = 180 * 86400.0  # in half a year mountings sink and lamps are changed
POOR_PX = 1.5
POOR_CM = 3.0

_ROOM = "calibrate --step room"


def check_calibration(facts: CalibrationFacts) -> Finding:
    """Checks the calibration that a new daemon would use."""
    about = "calibration"
    if facts.trouble is not None:
        return bad(about, f"{facts.path}: {facts.trouble.what}", facts.trouble.fix)
    if facts.path is None:
        return warn(about, "none is saved", user_command("calibrate"))
    days = int(facts.age_s / 86400.0)
    summary = (
        f"{facts.path}: {facts.cameras} camera{'s' if facts.cameras > 1 else ''}, {days} days old"
    )
    summary += f", {facts.rms_px:.2f} px" if facts.rms_px is not None else ""
    summary += f", {facts.play_area_cm:.1f} cm" if facts.play_area_cm is not None else ""
    if facts.age_s < -86400.0:
        return warn(about, f"{facts.path} is of the future", "set the clock: timedatectl")
    if (facts.rms_px or 0.0) > POOR_PX or (facts.play_area_cm or 0.0) > POOR_CM:
        return warn(about, f"{summary}: it fits badly", user_command(_ROOM))
    if facts.age_s > OLD_S:
        fix = f"{user_command(_ROOM)}, and --step colour if the lamps changed"
        return warn(about, f"{summary}: it is old", fix)
    return ok(about, summary)
