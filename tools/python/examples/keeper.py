#!/usr/bin/env python3
"""A goalkeeper: it moves along its goal line to where the ball will cross it. The arena's other team attacks.

  tools/python/examples/keeper.py [SEED [SECONDS [lock-step]]]

In lock-step, the game has no pictures and waits for this program, so that it is many times faster and can be repeated.
"""
import math
import sys

import touchline
from touchline import Place, Velocity

TEAM = "blue"
LINE_X = -1.04  # in front of our goal at x = -1.1 m, so that half a robot (0.0375 m) does not touch the wall
POST_Y = 0.2
GAIN = 5.0  # 1/s. The chain answers after about 0.1 s; a gain of more than 1 / (2 * 0.1 s) would overshoot
MAX_V = 1.0  # m/s


def crossing(ball: touchline.Ball) -> float:
    """Where the ball will cross the line, within the goal; where it is now if it does not come."""
    y = ball.y
    if ball.vx < -0.1:
        y += ball.vy * (LINE_X - ball.x) / ball.vx
    return max(-POST_Y, min(POST_Y, y))


def keep(frame: touchline.Frame) -> dict[int, touchline.Command]:
    """The command of the robot nearest to our goal; none if the ball or the robots are lost: then it stops after 0.2 s."""
    robots = frame.robots.get(TEAM)
    if frame.ball is None or not robots:
        return {}
    keeper = min(robots.values(), key=lambda robot: math.hypot(robot.x - LINE_X, robot.y))
    assert keeper.id is not None
    y = crossing(frame.ball)
    if keeper.theta is None or abs(keeper.x - LINE_X) > 0.03 or abs(math.cos(keeper.theta)) > 0.3:
        return {keeper.id: Place(LINE_X, y, math.pi / 2)}  # Touchline drives it back to its line
    along = math.copysign(1.0, math.sin(keeper.theta))  # 1: its front is towards +y
    v = max(-MAX_V, min(MAX_V, GAIN * (y - keeper.y)))
    return {keeper.id: Velocity(v * along, GAIN * math.cos(keeper.theta) * along)}


def main(seed: int = 1, seconds: int = 30, *, lock_step: bool = False) -> None:
    if lock_step:
        with touchline.Simulation() as game:
            frame = game.reset(seed, opponent="follow")
            for _ in range(round(seconds * game.description["rate_hz"])):
                frame = game.step(keep(frame))
            print("goals", (frame.score["own"], frame.score["opponent"]), "game", game.hash())
        return
    with touchline.Arena(seed=seed, duration=seconds) as arena:
        for frame in arena.client:
            arena.client.send(keep(frame))
    print("goals", arena.goals())


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]), lock_step="lock-step" in sys.argv[3:])
