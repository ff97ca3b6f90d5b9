"""Games for learning programs, with the methods of Gymnasium. The package gymnasium is used if it is installed, but not needed."""
from __future__ import annotations

import importlib
import math
import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Optional

from .arena import FilePath
from .command import Command, Velocity, Wheels
from .errors import TouchlineError
from .frame import Frame, Robot
from .simulation import Simulation

try:
    _gymnasium: Any = importlib.import_module("gymnasium")
except ImportError:
    _gymnasium = None
_Base: Any = object if _gymnasium is None else _gymnasium.Env

# Values of an observation beyond this are cut off; only a ball that is hit hard or a robot that spins comes near it.
MAX_VALUE = 5.0
BALL_VALUES, ROBOT_VALUES = 5, 7
GOAL_REWARD = 10.0
# Reward of a meter that the nearest robot comes nearer to the ball. It is less than that of the ball's way (1 per m), so that pushing pays
# more than reaching.
APPROACH_REWARD = 0.5
# Distances that random starts keep: between objects, so that a robot can turn between them, and from the walls.
START_DISTANCE, WALL_DISTANCE = 0.15, 0.15

# Ranges that differ between real robots and halls. Those of robots, floor and delay have the value of boards/mock near their middle. Losses and
# late frames begin at none. Noise begins at three to five times that of boards/mock, which has good light and a sharp lens.
TYPICAL_RANGES: Mapping[str, tuple[float, float]] = {
    "arena.physics.wheel_lag_s": (0.05, 0.12), "arena.physics.wheel_error": (0.0, 0.04), "arena.physics.wheel_slip": (0.0, 0.06),
    "arena.physics.tire_friction": (0.6, 1.0), "arena.physics.ball_deceleration_mps2": (0.08, 0.2),
    "arena.radio.delay_s": (0.005, 0.03), "arena.radio.loss": (0.0, 0.1), "arena.view.robot_noise_m": (0.0001, 0.001),
    "arena.view.ball_noise_m": (0.0002, 0.002), "arena.view.late": (0.0, 0.02)}


@dataclass(frozen=True)
class Randomization:
    """What differs from game to game.

    `starts`: robots and ball begin at random places, else where the board file and the kick-off put them. `ball_speed`: the ball begins
    with a random velocity of up to this, in m/s. `settings`: keys of the three files with their lowest and highest value, such as
    TYPICAL_RANGES; each game draws them uniformly.
    """

    starts: bool = True
    ball_speed: float = 0.0
    settings: Mapping[str, tuple[float, float]] = field(default_factory=dict)


@dataclass(frozen=True)
class Side:
    """A learning side: its team's color and that of the others, the ids of the robots that it drives, and of all robots."""

    team: str
    others: str
    driven: Sequence[int]
    own_ids: Sequence[int]
    other_ids: Sequence[int]


Observe = Callable[[Frame, Side], Sequence[float]]
Reward = Callable[[Frame, Frame, Side], float]
Terminated = Callable[[Frame, Frame], bool]


def observation_length(own: int, others: int) -> int:
    return BALL_VALUES + ROBOT_VALUES * (own + others)


def _limited(value: float) -> float:
    return max(-MAX_VALUE, min(MAX_VALUE, value))


def observe_all(frame: Frame, side: Side) -> list[float]:
    """Ball and all robots: those of the own team first, by id.

    Ball: x and y as shares of half the field's length and width, vx and vy in m/s, 1 if it is tracked. Robot: x and y as those of the
    ball, cosine and sine of the heading, v in m/s, w in 10 rad/s, 1 if it is tracked. All are 0 if it is lost.
    """
    half_length, half_width = frame.field["length"] / 2, frame.field["width"] / 2
    ball = frame.ball
    out = [0.0] * BALL_VALUES if ball is None else [ball.x / half_length, ball.y / half_width, ball.vx, ball.vy, 1.0]
    for team, ids in ((side.team, side.own_ids), (side.others, side.other_ids)):
        robots = frame.robots.get(team, {})
        for robot_id in ids:
            robot = robots.get(robot_id)
            if robot is None or robot.theta is None:
                out += [0.0] * ROBOT_VALUES
            else:
                out += [robot.x / half_length, robot.y / half_width, math.cos(robot.theta), math.sin(robot.theta), robot.v,
                        robot.w / 10, 1.0]
    return [_limited(value) for value in out]


def _to_goal(frame: Frame) -> Optional[float]:
    """The ball's distance from the other team's goal, which is at positive x."""
    return None if frame.ball is None else math.hypot(frame.field["length"] / 2 - frame.ball.x, frame.ball.y)


def _to_ball(frame: Frame, side: Side) -> Optional[float]:
    """The distance of the nearest driven robot from the ball."""
    robots: Mapping[int, Robot] = frame.robots.get(side.team, {})
    near = [robots[i] for i in side.driven if i in robots]
    if frame.ball is None or not near:
        return None
    return min(math.hypot(robot.x - frame.ball.x, robot.y - frame.ball.y) for robot in near)


def goals(before: Frame, after: Frame) -> int:
    """Our goals minus those of the others between two frames."""
    return int(after.score["own"] - before.score["own"]) - int(after.score["opponent"] - before.score["opponent"])


def push_reward(before: Frame, after: Frame, side: Side) -> float:
    """10 for a goal, -10 for one of the others; 1 for each m that the ball came nearer to their goal, 0.5 for each m of a robot's way to it."""
    scored = goals(before, after)
    if scored:
        return GOAL_REWARD * scored
    reward = 0.0
    for weight, former, now in ((1.0, _to_goal(before), _to_goal(after)),
                                (APPROACH_REWARD, _to_ball(before, side), _to_ball(after, side))):
        if former is not None and now is not None:
            reward += weight * (former - now)
    return reward


def any_goal(before: Frame, after: Frame) -> bool:
    return bool(before.score != after.score)


def _box(low: float, high: float, length: int) -> Any:
    if _gymnasium is not None:
        return _gymnasium.spaces.Box(low=low, high=high, shape=(length,))
    return {"type": "box", "low": low, "high": high, "shape": [length]}


def _array(values: Sequence[float]) -> Any:
    """A numpy array for gymnasium, else a list."""
    if _gymnasium is None:
        return list(values)
    return importlib.import_module("numpy").asarray(values, dtype="float32")


class _Game(_Base):  # type: ignore[misc]
    """What environments with one and with two learning sides share."""

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(self, *, controlled: int = 1, robots: Optional[int] = None, own: str = "external", opponent: str = "stand",
                 frames_per_step: int = 4, duration: float = 20.0, action: str = "velocity", max_speed: float = 1.0,
                 max_turn: float = 10.0, observe: Observe = observe_all, observation_size: Optional[int] = None,
                 reward: Reward = push_reward, terminated: Terminated = any_goal, randomization: Randomization = Randomization(),
                 settings: Optional[Mapping[str, object]] = None, program: Optional[FilePath] = None, board: Optional[FilePath] = None,
                 silence: float = 0.0) -> None:
        if action not in ("velocity", "wheels"):
            raise ValueError(f'action = {action!r} is not "velocity" or "wheels"')
        self.controlled, self.robots = controlled, robots or controlled
        if not 1 <= controlled <= self.robots:
            raise ValueError(f"controlled = {controlled} is not within 1 to the number of robots, {self.robots}")
        self._own, self._opponent = own, opponent
        self._frames_per_step, self._duration = frames_per_step, duration
        self._action, self._max_speed, self._max_turn = action, max_speed, max_turn
        self._observe, self._reward, self._terminated = observe, reward, terminated
        self._randomization, self._settings = randomization, dict(settings or {})
        self._observation_size = observation_size or observation_length(self.robots, self.robots)
        self._random = random.Random(1)
        self.simulation = Simulation(program, board=board, silence=silence)
        self._frame: Optional[Frame] = None
        self._frames_left = 0

    def close(self) -> None:
        """Ends the game and its program."""
        self.simulation.close()

    def _begin(self, seed: Optional[int], options: Optional[Mapping[str, Any]]) -> tuple[Frame, list[Side]]:
        if _gymnasium is not None:
            super().reset(seed=seed)
        if seed is not None:
            self._random = random.Random(seed)
        drawn = {key: self._random.uniform(low, high) for key, (low, high) in self._randomization.settings.items()}
        about = self.simulation.begin(
            self._random.getrandbits(31), own=self._own, opponent=self._opponent, robots=self.robots, robots_return=False,
            settings={**self._settings, **drawn})
        places = (options or {}).get("place") or self._places(about)
        if places:
            self.simulation.place(places)
        self._frame = self.simulation.step()
        self._frames_left = round(self._duration * about["rate_hz"])
        own, others = about["own"], about["opponent"]
        ids = about["robots"]
        return self._frame, [Side(own, others, ids[own][:self.controlled], ids[own], ids[others]),
                             Side(others, own, ids[others][:self.controlled], ids[others], ids[own])]

    def _places(self, about: Mapping[str, Any]) -> Optional[dict[str, Any]]:
        """Random places for this game; None: those of the board file."""
        if not self._randomization.starts and not self._randomization.ball_speed:
            return None
        x, y = about["field"]["length"] / 2 - WALL_DISTANCE, about["field"]["width"] / 2 - WALL_DISTANCE
        taken: list[tuple[float, float]] = []

        def draw() -> dict[str, float]:
            while True:
                at = self._random.uniform(-x, x), self._random.uniform(-y, y)
                if all(math.dist(at, other) >= START_DISTANCE for other in taken):
                    taken.append(at)
                    return {"x": at[0], "y": at[1]}

        speed, direction = self._random.uniform(0, self._randomization.ball_speed), self._random.uniform(-math.pi, math.pi)
        moves = {"vx": speed * math.cos(direction), "vy": speed * math.sin(direction)}
        if not self._randomization.starts:
            return {"ball": {"x": 0.0, "y": 0.0, **moves}}
        return {"ball": {**draw(), **moves},
                "robots": {team: {str(i): {**draw(), "theta": self._random.uniform(-math.pi, math.pi)} for i in ids}
                           for team, ids in about["robots"].items()}}

    def _commands(self, action: Sequence[float], side: Side) -> dict[int, Command]:
        values = [max(-1.0, min(1.0, float(value))) for value in action]
        if len(values) != 2 * self.controlled:
            raise ValueError(f"an action has {2 * self.controlled} numbers, not {len(values)}")
        pairs = zip(values[::2], values[1::2])
        if self._action == "wheels":
            return {i: Wheels(self._max_speed * left, self._max_speed * right) for i, (left, right) in zip(side.driven, pairs)}
        return {i: Velocity(self._max_speed * v, self._max_turn * w) for i, (v, w) in zip(side.driven, pairs)}

    def _let_pass(self) -> int:
        """The number of frames of the next step."""
        if self._frame is None:
            raise TouchlineError("call reset() before the first step()")
        frames = max(1, min(self._frames_per_step, self._frames_left))
        self._frames_left -= frames
        return frames

    def _info(self, frame: Frame, events: Sequence[Any] = ()) -> dict[str, Any]:
        return {"frame": frame, "score": frame.score, "t": frame.t, "events": list(events or frame.events)}


class Environment(_Game):
    """One learning side against a strategy, or against a team file.

        environment = touchline.Environment(opponent="univector", randomization=touchline.Randomization())
        observation, info = environment.reset(seed=1)
        terminated = truncated = False
        while not (terminated or truncated):
            observation, reward, terminated, truncated, info = environment.step([1.0, 0.2])
        environment.close()

    An action has two numbers from -1 to 1 for each of the `controlled` robots: shares of `max_speed` and `max_turn` ("velocity"), or
    of `max_speed` for the left and right wheel ("wheels"). It holds for `frames_per_step` frames. The own robots that are not
    controlled stand, or are driven by the strategy `own`, such as "play". A game ends (terminated) with a goal and (truncated) after
    `duration` seconds. `observe`, `reward` and `terminated` can be replaced; `observation_size` is the length of what `observe`
    returns. The same seed and actions give the same game.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.action_space = _box(-1.0, 1.0, 2 * self.controlled)
        self.observation_space = _box(-MAX_VALUE, MAX_VALUE, self._observation_size)
        self._side: Optional[Side] = None

    def reset(self, *, seed: Optional[int] = None, options: Optional[Mapping[str, Any]] = None) -> tuple[Any, dict[str, Any]]:
        """Begins a game. `options`: {"place": ...} as in Simulation.reset(), instead of random places."""
        frame, (self._side, _) = self._begin(seed, options)
        return _array(self._observe(frame, self._side)), self._info(frame)

    def step(self, action: Sequence[float]) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        frames, before, side = self._let_pass(), self._frame, self._side
        assert before is not None and side is not None
        after = self._frame = self.simulation.step(self._commands(action, side), frames=frames)
        return (_array(self._observe(after, side)), float(self._reward(before, after, side)), bool(self._terminated(before, after)),
                self._frames_left <= 0, self._info(after))


class TwoSidedEnvironment(_Game):
    """Two learning sides. Observations, actions and rewards are pairs; each side sees itself attacking towards positive x."""

    def __init__(self, **options: Any) -> None:
        options["opponent"] = "external"
        super().__init__(**options)
        actions, observations = _box(-1.0, 1.0, 2 * self.controlled), _box(-MAX_VALUE, MAX_VALUE, self._observation_size)
        self.action_space = self._pair_of(actions)
        self.observation_space = self._pair_of(observations)
        self._sides: list[Side] = []
        self._opponent_frame: Optional[Frame] = None

    @staticmethod
    def _pair_of(space: Any) -> Any:
        return _gymnasium.spaces.Tuple((space, space)) if _gymnasium is not None else {"type": "tuple", "spaces": [space, space]}

    def reset(self, *, seed: Optional[int] = None,
              options: Optional[Mapping[str, Any]] = None) -> tuple[tuple[Any, Any], dict[str, Any]]:
        """Begins a game, as Environment.reset()."""
        frame, self._sides = self._begin(seed, options)
        self._opponent_frame = self._opposite()
        return self._observations(frame), self._info(frame)

    def step(self, action: Sequence[Sequence[float]]) -> tuple[tuple[Any, Any], tuple[float, float], bool, bool, dict[str, Any]]:
        frames, before, others_before = self._let_pass(), self._frame, self._opponent_frame
        assert before is not None and others_before is not None
        own, others = self._sides
        after = self._frame = self.simulation.step(self._commands(action[0], own), self._commands(action[1], others), frames=frames)
        others_after = self._opponent_frame = self._opposite()
        rewards = float(self._reward(before, after, own)), float(self._reward(others_before, others_after, others))
        return (self._observations(after), rewards, bool(self._terminated(before, after)), self._frames_left <= 0, self._info(after))

    def _opposite(self) -> Frame:
        frame = self.simulation.opponent_frame
        # A late frame of the other side is missing in the first step.
        while frame is None:
            self._frame = self.simulation.step()
            frame = self.simulation.opponent_frame
        return frame

    def _observations(self, frame: Frame) -> tuple[Any, Any]:
        assert self._opponent_frame is not None
        return _array(self._observe(frame, self._sides[0])), _array(self._observe(self._opponent_frame, self._sides[1]))
