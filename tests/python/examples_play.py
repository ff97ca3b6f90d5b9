#!/usr/bin/env python3
"""The examples play in the arena, with the program of the argument: the attacker scores, the keeper follows the ball.

usage: examples_play.py TOUCHLINE
"""
import math
import sys

import package  # noqa: F401
import keeper
import univector
from touchline import Arena

# A ball can jam between two robots for as long as anybody pushes. Where it rolls depends on the time that messages take.
SEEDS = (2, 3, 4)
LIMIT_S = 40  # of a game
GOAL_LINE_X = 1.1


def check(condition, text):
    if not condition:
        sys.exit("FAILED: " + text)


def attack(seed):
    """Plays until there is a goal or the time is over. Returns whether it is ours."""
    with Arena(sys.argv[1], seed=seed, duration=LIMIT_S, opponents="stand") as arena:
        for frame in arena.client:
            arena.client.send(univector.attack(frame))
            if frame.ball is not None and abs(frame.ball.x) > GOAL_LINE_X:
                break
    check(frame.ball is None or frame.ball.x > -GOAL_LINE_X, f"seed {seed}: the attacker scored an own goal")
    return frame.ball is not None and frame.ball.x > GOAL_LINE_X


def mean(values):
    return sum(values) / len(values)


def keep():
    """Returns the mean distance of the keeper from where the ball will cross its line, and that of a keeper in the middle."""
    own, middle = [], []
    with Arena(sys.argv[1], seed=1, duration=8) as arena:
        for frame in arena.client:
            arena.client.send(keeper.keep(frame))
            robot = frame.robots[keeper.TEAM].get(0)
            if frame.t > 3 and robot is not None and frame.ball is not None:  # after the way from its start
                wanted = keeper.crossing(frame.ball)
                own.append(math.hypot(robot.x - keeper.LINE_X, robot.y - wanted))
                middle.append(abs(wanted))
    check(len(own) > 150, f"{len(own)} frames in 6 s")
    return mean(own), mean(middle)


own, middle = keep()
check(own < 0.05 < 0.1 < middle, f"the keeper is {own:.3f} m from where the ball will cross its line; one in the middle {middle:.3f} m")
scored = next((seed for seed in SEEDS if attack(seed)), None)
check(scored is not None, f"the attacker scored in none of {len(SEEDS)} games")
print(f"the keeper was {own:.3f} m from its place, one in the middle {middle:.3f} m; the attacker scored in the game of seed {scored}")
