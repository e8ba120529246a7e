"""What is written on the screen at an instant. Pure."""

from dataclasses import dataclass

from goalkeeper.app.high_scores import Placed
from goalkeeper.core.events import Conceded, Event, Saved
from goalkeeper.core.match import LOST, Match, Phase
from goalkeeper.render.hud_lines import HudText
from goalkeeper.streams.sighting import StreamState

POPUP_S = 1.1
_KEYS = (
    "V view   P pause   C calibrate   D difficulty   plus, minus volume   F full screen   Esc quit"
)
_START = """GOALKEEPER

Stand three big steps from your cameras, where they see all of you,
and face them. As soon as you are seen, stretch both arms out
to the sides: that measures how far you reach.

Then keep the balls out with hands, arms, head and body."""
_ASK_FOR_T = "You are seen. Stretch both arms out to the sides"
_LEVELS = {"easy": 0.1, "normal": 0.25, "hard": 0.55}
MOST_NAME = 16


def level_of(difficulty: str) -> float:
    """Level of the first shots."""
    return _LEVELS[difficulty]


def next_difficulty(difficulty: str) -> str:
    """The one after it, round."""
    names = list(_LEVELS)
    return names[(names.index(difficulty) + 1) % len(names)]


class Popups:
    """The words over a save or a goal, for a moment."""

    def __init__(self) -> None:
        self._text, self._until_s = "", 0.0

    def heard(self, events: list[Event], now_s: float) -> None:
        """What happened since the last picture."""
        for event in events:
            if isinstance(event, Saved):
                streak = f"   {event.streak} in a row" if event.streak > 2 else ""
                self._text = f"SAVED  +{event.points}{streak}"
            elif isinstance(event, Conceded):
                self._text = f"GOAL  {event.outcome.speed_mps * 3.6:.0f} km/h"
            else:
                continue
            self._until_s = now_s + POPUP_S

    def text(self, now_s: float) -> str:
        """What is over the picture now."""
        return self._text if now_s < self._until_s else ""


@dataclass(frozen=True, slots=True)
class PlayerSettings:
    """What the player chose: difficulty, volume 0..1, and the name that is typed at the end; types: it is just typed."""

    difficulty: str = "normal"
    volume: float = 1.0
    name: str = ""
    types: bool = False


def hud_text(
    match: Match,
    foot: str,
    stream: StreamState,
    popup: str,
    placed: Placed | None,
    settings: PlayerSettings = PlayerSettings(),
) -> HudText:
    """foot: rate and latency; stream: how it fares; placed: the table of high scores once the round is over."""
    score, phase = match.score, match.phase
    minutes, seconds = divmod(int(match.left_s + 0.999), 60)
    times = f"  x{score.multiplier}" if score.multiplier > 1 else ""
    big = message = table = ""
    if phase is Phase.CALIBRATING:
        done = round(100 * match.finder.progress)
        trouble = stream.trouble or _slow(stream)
        if match.is_seen:
            message = trouble or _ASK_FOR_T + (f"  {done} %" if done else "")
        else:
            table = _START + (f"\n\n{trouble}" if trouble else "")
    elif phase is Phase.COUNTDOWN:
        big = str(max(match.counted, 1))
    elif phase is Phase.PAUSED:
        lost = _slow(stream) if match.pause_reason == LOST else ""
        big, message = "PAUSE", stream.trouble or lost or match.pause_reason
    elif phase is Phase.PLAYING and stream.slow:
        foot = f"tracking is slow   {foot}"
    elif phase is Phase.REPLAY:
        message = "BEST SAVE"
    elif phase is Phase.OVER:
        table = _table(match, placed, settings)
    return HudText(
        score=f"{score.points}",
        clock=f"{minutes}:{seconds:02d}",
        streak=f"{score.saves} : {score.goals}{times}",
        foot=f"{settings.difficulty}   volume {100 * settings.volume:.0f} %   {foot}",
        keys=_KEYS,
        big=big,
        message=message,
        popup="" if message else popup,
        level=match.difficulty.level,
        table=table,
    )


def _slow(stream: StreamState) -> str:
    """For the player, what helps against too few poses: they did not leave the view."""
    fix = stream.slow.partition(" -- ")[2]
    return f"tracking is slow: {fix or stream.slow}" if stream.slow else ""


def _table(match: Match, placed: Placed | None, settings: PlayerSettings) -> str:
    """The end of a round: how it went, and the best ones."""
    score = match.score
    shots = score.saves + score.goals
    share = f"   {100 * score.saves / shots:.0f} % kept out" if shots else ""
    lines = [
        "FULL TIME",
        f"{score.points} points",
        f"{score.saves} saves   {score.goals} goals{share}",
        f"longest streak {score.best_streak}   level {100 * match.difficulty.level:.0f} of 100",
        "",
    ]
    if placed is not None:
        if placed.place is not None:
            mark = "_" if settings.types else ""
            lines += [f"Your name: {settings.name}{mark}   (N to type it)", ""]
        for place, one in enumerate(placed.scores[:6]):
            mark = "  (you)" if place == placed.place else ""
            name = settings.name if place == placed.place else one.name
            lines.append(
                f"{place + 1}.  {one.points}  {name or '-'}  {one.saves}:{one.goals}  {one.date}{mark}"
            )
        if placed.trouble:
            lines.append(placed.trouble[:60])
    return "\n".join([*lines, "", "Space: play again"])
