#!/usr/bin/env python3
"""The examples in games that wait for them: the attacker scores, the keeper follows the ball, and the policy search improves.

usage: examples_in_lock_step.py TOUCHLINE_SIMULATE
"""
import math
import os
import pathlib
import sys

import package
import keeper
import policy_search
import univector
from touchline import Simulation

GOALS_SEEDS = (1, 2)


def check(condition, text):
    if not condition:
        sys.exit("FAILED: " + text)


def mean(values):
    return sum(values) / len(values)


def attack(program, seed, seconds=40):
    """Plays until there is a goal or the time is over. Returns the score."""
    with Simulation(program) as game:
        frame = game.reset(seed, opponent="stand")
        for _ in range(60 * seconds):
            frame = game.step(univector.attack(frame))
            if frame.score != {"own": 0, "opponent": 0}:
                break
    return frame.score


def keep(program):
    """Returns the mean distance of the keeper from where the ball will cross its line, and that of a keeper in the middle."""
    own, middle = [], []
    with Simulation(program) as game:
        frame = game.reset(seed=1, opponent="follow")
        for _ in range(60 * 8):
            frame = game.step(keeper.keep(frame))
            robot = frame.robots[keeper.TEAM].get(0)
            if frame.t > 4 and robot is not None and frame.ball is not None:  # after the way from its start
                wanted = keeper.crossing(frame.ball)
                own.append(math.hypot(robot.x - keeper.LINE_X, robot.y - wanted))
                middle.append(abs(wanted))
    return mean(own), mean(middle)


def main():
    program = sys.argv[1]
    scores = [attack(program, seed) for seed in GOALS_SEEDS]
    check(any(score["own"] == 1 for score in scores), f"the attacker scored in no game: {scores}")
    check(not any(score["opponent"] for score in scores), f"the attacker scored an own goal: {scores}")
    own, middle = keep(program)
    check(own < 0.05 < middle, f"the keeper is {own:.3f} m from where the ball will cross its line; one in the middle {middle:.3f} m")
    # The processes of the search find the program by PATH, because the clone may be built elsewhere.
    os.environ["PATH"] = f"{pathlib.Path(program).resolve().parent}:{os.environ['PATH']}"
    os.environ["PYTHONPATH"] = os.pathsep.join(map(str, (package.PACKAGE, package.PACKAGE / "examples")))
    progress = policy_search.search(generations=2, games=6, processes=2)
    # A goal is 10; reaching the ball is about 0.4, and pushing it to the goal 1.
    check(max(progress) > progress[0] + 1.0, f"the search does not improve: {progress}")
    print(f"scores {scores}; the keeper was {own:.3f} m from its place, one in the middle {middle:.3f} m; rewards {progress}")


if __name__ == "__main__":  # the processes of the search import this file
    main()
