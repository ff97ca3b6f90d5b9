"""What a program may tell a robot: the JSON commands of docs/network.md. Values that Touchline would refuse are refused here."""
from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Optional, Union

from .errors import RefusedCommandError

# The ranges of docs/network.md, "JSON commands".
MAX_ID = 127
MAX_ROBOTS = 11
LIMITS = {"v": 10.0, "w": 100.0, "left": 10.0, "right": 10.0, "x": 20.0, "y": 20.0, "theta": 1000.0}


@dataclass(frozen=True)
class Velocity:
    """Drive with v m/s along the heading, and turn with w rad/s, counter-clockwise."""

    v: float
    w: float


@dataclass(frozen=True)
class Wheels:
    """Turn the wheels: speeds of their rims in m/s."""

    left: float
    right: float


@dataclass(frozen=True)
class Place:
    """Touchline drives the robot to this place in meters, around other robots, and turns it to theta if that is not None."""

    x: float
    y: float
    theta: Optional[float] = None


@dataclass(frozen=True)
class Release:
    """The built-in play drives the robot again."""


Command = Union[Velocity, Wheels, Place, Release]


def _members(command: Command) -> dict[str, Optional[float]]:
    if isinstance(command, Velocity):
        return {"v": command.v, "w": command.w}
    if isinstance(command, Wheels):
        return {"left": command.left, "right": command.right}
    if isinstance(command, Place):
        place: dict[str, Optional[float]] = {"x": command.x, "y": command.y}
        return place if command.theta is None else {**place, "theta": command.theta}
    if isinstance(command, Release):
        return {"release": True}
    raise RefusedCommandError(f"{command!r} is not a command: use Velocity, Wheels, Place or Release")


def _check(robot: int, name: str, value: object) -> None:
    if value is True and name == "release":
        return
    limit = LIMITS[name]
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise RefusedCommandError(f"robot {robot}: {name} = {value!r} is not a number")
    if not math.isfinite(value) or abs(value) > limit:
        raise RefusedCommandError(f"robot {robot}: {name} = {value:g} is not within {-limit:g} to {limit:g}")


def command_list(commands: Mapping[int, Command]) -> list[dict[str, Optional[float]]]:
    """Returns the commands of these robots, by id, as the list of a message. Raises RefusedCommandError."""
    if len(commands) > MAX_ROBOTS:
        raise RefusedCommandError(f"commands for {len(commands)} robots; a message has at most {MAX_ROBOTS}")
    out: list[dict[str, Optional[float]]] = []
    for robot, command in commands.items():
        if isinstance(robot, bool) or not isinstance(robot, int) or not 0 <= robot <= MAX_ID:
            raise RefusedCommandError(f"{robot!r} is not the id of a robot: ids are integers from 0 to {MAX_ID}")
        members = _members(command)
        for name, value in members.items():
            _check(robot, name, value)
        out.append({"id": robot, **members})
    return out


def command_message(commands: Mapping[int, Command]) -> bytes:
    """Returns the message for these robots, by id, without a line end. Raises RefusedCommandError."""
    return json.dumps({"commands": command_list(commands)}).encode()
