"""What Touchline publishes for each frame: the JSON lines of docs/network.md as dataclasses.

Meters, radians, seconds; origin in the center of the field, angles counter-clockwise from x. Members that a line does not have are None.
"""
from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Optional, Union

from .errors import MalformedFrameError

SCHEMA = 1

HALT_REASONS = {
    1: "no frames", 2: "emergency stop", 4: "emergency line cannot be read", 8: "start button not pressed", 16: "restarted after a crash",
    32: "referee", 64: "team colors or heights of the referee cannot be used", 128: "no message of the referee",
    256: "stopped from the console", 512: "the board is being set up", 1024: "the camera repeats its pictures",
    2048: "too many colored regions in the picture", 4096: "the field is not recognizable", 8192: "robots do not move as commanded"}


@dataclass(frozen=True)
class Ball:
    x: float
    y: float
    vx: float
    vy: float
    confidence: Optional[float]


@dataclass(frozen=True)
class Robot:
    """A tracked robot. `v` is along its heading; `seen` is False if the place is predicted."""

    team: str
    id: Optional[int]
    x: float
    y: float
    theta: Optional[float]
    v: float
    w: float
    confidence: Optional[float]
    seen: Optional[bool]


@dataclass(frozen=True)
class SentCommand:
    """What Touchline told a robot in this frame: m/s and rad/s, and the speeds of the wheels' rims in m/s."""

    v: float
    w: float
    left: float
    right: float


@dataclass(frozen=True)
class Telemetry:
    """What a robot last reported, `age` seconds ago: volts, percent, and m/s of the wheels."""

    battery: Optional[float]
    link: Optional[float]
    age: float
    left: Optional[float] = None
    right: Optional[float] = None


@dataclass(frozen=True)
class Event:
    """What happened in a simulation: "goal", "touch", "contact", "free_ball" or "restart". `team`: whose; None: nobody's, or both."""

    kind: str
    team: Optional[str]


@dataclass(frozen=True)
class Frame:
    """One frame. `robots[color][id]` has the robots of known id, `unidentified` the others.

    `score`, `side`, `field` and `referee` are the members of the line as they are, None if Touchline does not send them. Only a
    Simulation sends `events` and, if it is asked to, `truth`. `raw` is the whole line.
    """

    number: int
    t: float
    timestamp: Optional[float]
    sent: Optional[float]
    ball: Optional[Ball]
    robots: Mapping[str, Mapping[int, Robot]]
    unidentified: tuple[Robot, ...]
    stop: Optional[bool]
    halt: Optional[int]
    phase: Optional[str]
    commands: Mapping[int, SentCommand]
    telemetry: Mapping[int, Telemetry]
    score: Any
    side: Any
    field: Any
    referee: Any
    raw: Mapping[str, Any]
    events: tuple[Event, ...] = ()
    truth: Any = None

    @property
    def restart(self) -> Optional[str]:
        """The restart that follows, or that is being taken: "kick-off", "free ball", "penalty", "goal kick" or "free kick".

        None: the referee does not say, or there is none.
        """
        return self._of_referee("restart")

    @property
    def taken_by(self) -> Optional[str]:
        """Who takes the restart: "own" or "opponent". None: nobody does, as at a free ball, or the referee does not say."""
        return self._of_referee("taken_by")

    def _of_referee(self, name: str) -> Optional[str]:
        value = self.referee.get(name) if isinstance(self.referee, dict) else None
        return value if isinstance(value, str) else None

    @property
    def halt_reasons(self) -> tuple[str, ...]:
        """Why robots are stopped, in words; empty if they may move."""
        bits = self.halt or 0
        return tuple(HALT_REASONS.get(1 << i, f"reason {1 << i}") for i in range(bits.bit_length()) if bits >> i & 1)


class _Object:
    """An object of the line and its place in it, so that errors name the member."""

    def __init__(self, value: Any, place: str) -> None:
        if not isinstance(value, dict):
            raise MalformedFrameError(f"{place or 'the line'} is not an object: {_shown(value)}")
        self.value: dict[str, Any] = value
        self.place = place

    def _error(self, name: str, wanted: str) -> MalformedFrameError:
        place = f"{self.place}.{name}" if self.place else name
        if name not in self.value:
            return MalformedFrameError(f"{place} is missing")
        return MalformedFrameError(f"{place} = {_shown(self.value[name])} is not {wanted}")

    def number(self, name: str) -> float:
        value = self.value.get(name)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return value
        raise self._error(name, "a number")

    def integer(self, name: str) -> int:
        value = self.value.get(name)
        if isinstance(value, int) and not isinstance(value, bool):
            return value
        raise self._error(name, "an integer")

    def text(self, name: str) -> str:
        value = self.value.get(name)
        if isinstance(value, str):
            return value
        raise self._error(name, "a text")

    def boolean(self, name: str) -> bool:
        value = self.value.get(name)
        if isinstance(value, bool):
            return value
        raise self._error(name, "true or false")

    def has(self, name: str) -> bool:
        return self.value.get(name) is not None

    def child(self, name: str) -> _Object:
        """The object with this name; an empty one if it is missing."""
        return _Object(self.value[name] if self.has(name) else {}, f"{self.place}.{name}" if self.place else name)

    def by_id(self) -> list[tuple[int, _Object]]:
        for name in self.value:
            if not (name.isascii() and name.isdigit()):
                raise MalformedFrameError(f"{self.place}.{name} is not the id of a robot")
        return [(int(name), self.child(name)) for name in self.value]


def _shown(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _optional_number(source: _Object, name: str) -> Optional[float]:
    return source.number(name) if source.has(name) else None


def _robot(source: _Object, team: str, robot_id: Optional[int]) -> Robot:
    return Robot(team, robot_id, source.number("x"), source.number("y"), _optional_number(source, "theta"), source.number("v"),
                 source.number("w"), _optional_number(source, "confidence"), source.boolean("seen") if source.has("seen") else None)


def _unidentified(tracks: _Object) -> tuple[Robot, ...]:
    robots = tracks.value.get("robots") or []
    if not isinstance(robots, list):
        raise MalformedFrameError(f"tracks.robots = {_shown(robots)} is not a list")
    members = [_Object(robot, f"tracks.robots[{i}]") for i, robot in enumerate(robots)]
    return tuple(_robot(member, member.text("team"), None) for member in members if not member.has("id"))


def _ball(tracks: _Object) -> Optional[Ball]:
    if not tracks.has("ball"):
        return None
    ball = tracks.child("ball")
    return Ball(ball.number("x"), ball.number("y"), ball.number("vx"), ball.number("vy"), _optional_number(ball, "confidence"))


def _events(whole: _Object) -> tuple[Event, ...]:
    events = whole.value.get("events") or []
    if not isinstance(events, list):
        raise MalformedFrameError(f"events = {_shown(events)} is not a list")
    members = [_Object(event, f"events[{i}]") for i, event in enumerate(events)]
    return tuple(Event(member.text("kind"), member.text("team") if member.has("team") else None) for member in members)


def parse_frame(line: Union[str, bytes]) -> Frame:
    """Reads one line. Unknown members are ignored. Raises MalformedFrameError, which names the member."""
    try:
        value = json.loads(line)
    except (ValueError, RecursionError) as error:  # also text that is not UTF-8
        raise MalformedFrameError(f"the line is not JSON: {error}") from None
    return frame_of(value)


def frame_of(value: Any) -> Frame:
    """Reads the object of a line. Raises MalformedFrameError."""
    whole = _Object(value, "")
    if whole.has("schema") and whole.integer("schema") != SCHEMA:
        raise MalformedFrameError(f"schema = {_shown(whole.value['schema'])}, but this package reads {SCHEMA}; install the package of the "
                                  "Touchline that is running")
    tracks, robots = whole.child("tracks"), whole.child("robots")
    teams = {team: {i: _robot(robot, team, i) for i, robot in robots.child(team).by_id()} for team in robots.value}
    commands = {i: SentCommand(one.number("v"), one.number("w"), one.number("left"), one.number("right"))
                for i, one in whole.child("commands").by_id()}
    telemetry = {i: Telemetry(_optional_number(one, "battery"), _optional_number(one, "link"), one.number("age"),
                              _optional_number(one, "left"), _optional_number(one, "right"))
                 for i, one in whole.child("telemetry").by_id()}
    return Frame(
        number=whole.integer("frame"), t=whole.number("t"), timestamp=_optional_number(whole, "timestamp"),
        sent=_optional_number(whole, "sent"), ball=_ball(tracks), robots=teams, unidentified=_unidentified(tracks),
        stop=whole.boolean("stop") if whole.has("stop") else None, halt=whole.integer("halt") if whole.has("halt") else None,
        phase=whole.text("phase") if whole.has("phase") else None, commands=commands, telemetry=telemetry,
        score=value.get("score"), side=value.get("side"), field=value.get("field"), referee=value.get("referee"), raw=value,
        events=_events(whole), truth=value.get("truth"))
