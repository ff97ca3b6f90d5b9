#!/usr/bin/env python3
"""A small policy search: one robot learns to push the ball into the goal, by the cross-entropy method, without any package.

  tools/python/examples/policy_search.py [GENERATIONS [GAMES [PROCESSES [SEED]]]]

The policy has four numbers, which begin at zero: the robot drives slowly and straight to the ball. Each generation draws policies from a
normal distribution, lets each play some games, and moves the distribution to the best of them. Several arenas play at the same time, each in a process of its own.
The method: R. Y. Rubinstein, "The cross-entropy method for combinatorial and continuous optimization", Methodology and Computing in
Applied Probability 1 (1999); for policies: I. Szita, A. Lorincz, "Learning Tetris using the noisy cross-entropy method", Neural
Computation 18 (2006), from which the added noise comes.
"""
import math
import multiprocessing
import random
import statistics
import sys
import time
from collections.abc import Sequence
from typing import Optional

import touchline

POPULATION, BEST = 20, 5
NOISE = 0.2  # keeps the distribution from becoming narrow too early
SECONDS = 8.0  # of a game
FRAMES_PER_STEP = 3  # 20 decisions a second: the robots answer after about 0.1 s
MAX_SPEED, MAX_TURN = 1.0, 8.0
SLOW, TURN = 0.3, 3.0  # with which the search begins: share of the speed, and rad/s for an error of 1 rad
HALF_LENGTH, HALF_WIDTH = 1.1, 0.9  # of the field, m
SIZE = 4

Policy = Sequence[float]


def act(policy: Policy, observation: Sequence[float]) -> list[float]:
    """The action for an observation of touchline.environment.observe_all, for one robot.

    The robot drives to the ball on a curve that brings it behind the ball, seen from the goal. The four numbers: how far it turns from the
    direct way, and as logarithms how fast it turns, how fast it drives, and how much slower while it must turn.
    """
    ball_x, ball_y, _, _, seen = observation[:5]
    x, y, cos, sin = observation[5:9]
    if not seen:
        return [0.0, 0.0]
    curve, (turn, speed, caution) = policy[0], (math.exp(min(value, 5.0)) for value in policy[1:])
    to_ball = math.atan2(HALF_WIDTH * (ball_y - y), HALF_LENGTH * (ball_x - x))
    to_goal = math.atan2(-HALF_WIDTH * ball_y, HALF_LENGTH * (1 - ball_x))
    around = math.remainder(to_ball - to_goal, math.tau)
    error = math.remainder(to_ball + curve * max(-1.0, min(1.0, around)) - math.atan2(sin, cos), math.tau)
    ahead = 1.0
    if abs(error) > math.pi / 2:  # its back is nearer to the wanted heading
        error, ahead = math.remainder(error + math.pi, math.tau), -1.0
    return [ahead * min(1.0, SLOW * speed) * math.exp(-caution * abs(error)), TURN * turn * error / MAX_TURN]


def play(environment: touchline.Environment, policy: Policy, seed: int) -> tuple[float, int]:
    """Returns the sum of rewards, and our goals minus those of the other team."""
    observation, info = environment.reset(seed=seed)
    total, ended = 0.0, False
    while not ended:
        observation, reward, terminated, truncated, info = environment.step(act(policy, observation))
        total += reward
        ended = terminated or truncated
    return total, info["score"]["own"] - info["score"]["opponent"]


_environment: Optional[touchline.Environment] = None  # of this process


def _play(work: tuple[Policy, int]) -> tuple[float, int]:
    global _environment
    if _environment is None:
        _environment = touchline.Environment(duration=SECONDS, frames_per_step=FRAMES_PER_STEP, max_speed=MAX_SPEED, max_turn=MAX_TURN)
    return play(_environment, *work)


def evaluate(pool: "multiprocessing.pool.Pool", policies: Sequence[Policy], seeds: Sequence[int]) -> list[tuple[float, float]]:
    """Returns for each policy the means of reward and goals, with the same games for all."""
    results = pool.map(_play, [(policy, seed) for policy in policies for seed in seeds], chunksize=len(seeds))
    games = [results[i:i + len(seeds)] for i in range(0, len(results), len(seeds))]
    return [(statistics.fmean(reward for reward, _ in each), statistics.fmean(goals for _, goals in each)) for each in games]


def search(generations: int, games: int, processes: int, seed: int = 1) -> list[float]:
    """Returns the mean reward of the distribution's middle before the first and after each generation."""
    draw = random.Random(seed)
    middle, spread = [0.0] * SIZE, [1.0] * SIZE
    test_seeds = range(1000, 1000 + 2 * games)
    progress: list[float] = []
    # "spawn", so that no process inherits the connection of another one's arena.
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        begin = time.monotonic()
        for generation in range(generations + 1):
            reward, goals = evaluate(pool, [middle], test_seeds)[0]
            progress.append(reward)
            print(f"generation {generation:2}: reward {reward:6.2f}, goals {goals:5.2f} per game, {time.monotonic() - begin:5.1f} s", flush=True)
            if generation == generations:
                break
            policies = [[draw.gauss(m, s) for m, s in zip(middle, spread)] for _ in range(POPULATION)]
            seeds = [draw.randrange(1 << 30) for _ in range(games)]  # other games each time, so that luck is not learned
            ranked = sorted(zip(evaluate(pool, policies, seeds), policies), key=lambda pair: pair[0], reverse=True)
            best = [policy for _, policy in ranked[:BEST]]
            middle = [statistics.fmean(values) for values in zip(*best)]
            spread = [statistics.pstdev(values) + NOISE * 0.9**generation for values in zip(*best)]
    print("policy", [round(value, 3) for value in middle])
    return progress


def main(generations: int = 8, games: int = 6, processes: int = 2, seed: int = 1) -> None:
    search(generations, games, processes, seed)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:5]))
