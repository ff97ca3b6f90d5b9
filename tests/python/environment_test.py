#!/usr/bin/env python3
"""Environments with Gymnasium's methods, with the program of the argument; without gymnasium, and with a stand-in for it.

usage: environment_test.py TOUCHLINE_SIMULATE
"""
import importlib
import sys
import types
import unittest
from unittest import mock

import package  # noqa: F401
from touchline import Environment, Randomization, TouchlineError, TwoSidedEnvironment
from touchline.environment import MAX_VALUE, TYPICAL_RANGES, observation_length

PROGRAM = sys.argv.pop(1)
STILL = Randomization(starts=False)


def play(environment, seed, action=(0.6, 0.1), steps=15):
    """Returns all observations and rewards of a short game."""
    observation, _ = environment.reset(seed=seed)
    out = [observation]
    for _ in range(steps):
        observation, reward, terminated, truncated, _ = environment.step(action)
        out += [observation, reward]
        if terminated or truncated:
            break
    return out


class OneSide(unittest.TestCase):
    def make(self, **options):
        environment = Environment(program=PROGRAM, **options)
        self.addCleanup(environment.close)
        return environment

    def test_the_same_seed_and_actions_give_the_same_game(self):
        environment = self.make(opponent="follow", randomization=Randomization(ball_speed=1.0, settings=TYPICAL_RANGES))
        first = play(environment, 3)
        self.assertEqual(play(environment, 3), first)
        self.assertNotEqual(play(environment, 4), first)
        self.assertNotEqual(play(environment, None), first, "a reset without a seed goes on with other random numbers")
        self.assertEqual(play(self.make(opponent="follow", randomization=Randomization(ball_speed=1.0, settings=TYPICAL_RANGES)), 3), first)

    def test_spaces_are_plain_data_that_observations_and_actions_fit(self):
        environment = self.make(controlled=2, robots=3)
        self.assertEqual(environment.action_space, {"type": "box", "low": -1.0, "high": 1.0, "shape": [4]})
        length = observation_length(3, 3)
        self.assertEqual(environment.observation_space, {"type": "box", "low": -MAX_VALUE, "high": MAX_VALUE, "shape": [length]})
        for value in play(environment, 1, (1, -1, 0, 5), 5):
            if isinstance(value, list):
                self.assertEqual(len(value), length)
                self.assertLessEqual(max(map(abs, value)), MAX_VALUE)
        self.assertRaisesRegex(ValueError, "an action has 4 numbers, not 2", environment.step, [0, 0])

    def test_an_action_drives_the_controlled_robots_only(self):
        environment = self.make(controlled=1, robots=2, randomization=STILL, action="wheels", max_speed=0.4)
        environment.reset(seed=1)
        for _ in range(8):
            _, _, _, _, info = environment.step([1, 1])
        own = info["frame"].robots["blue"]
        self.assertGreater(own[0].x, -0.95)
        self.assertAlmostEqual(own[1].x, -0.55, places=2)

    def test_a_goal_terminates_and_is_rewarded(self):
        environment = self.make(randomization=STILL, duration=5)
        places = {"ball": {"x": 0.9, "y": 0.1, "vx": 3}, "robots": {"yellow": {0: {"x": 0.3, "y": 0.3}}}}
        environment.reset(seed=1, options={"place": places})
        for _ in range(10):
            _, reward, terminated, truncated, info = environment.step([0, 0])
            if terminated:
                break
        self.assertEqual((terminated, truncated, reward, info["score"]), (True, False, 10.0, {"own": 1, "opponent": 0}))
        self.assertEqual([event.kind for event in info["events"]][:1], ["goal"])
        environment.reset(seed=1, options={"place": {"ball": {"x": -0.9, "y": 0.1, "vx": -3}}})
        while not terminated or reward == 10.0:
            _, reward, terminated, _, _ = environment.step([0, 0])
        self.assertEqual(reward, -10.0)

    def test_a_game_is_truncated_after_its_duration(self):
        environment = self.make(duration=0.5, frames_per_step=4)
        environment.reset(seed=1)
        ends = []
        while not ends or not ends[-1]:
            _, _, _, truncated, info = environment.step([0, 0])
            ends.append(truncated)
        self.assertEqual(len(ends), 8)  # 30 frames
        self.assertEqual(info["frame"].number, 30)

    def test_observation_reward_and_end_can_be_replaced(self):
        environment = self.make(observe=lambda frame, side: [frame.ball.x], observation_size=1, reward=lambda before, after, side: side.driven[0] + 7,
                                terminated=lambda before, after: after.number >= 9)
        self.assertEqual(environment.observation_space["shape"], [1])
        observation, _ = environment.reset(seed=1)
        self.assertEqual(len(observation), 1)
        self.assertEqual([environment.step([0, 0])[1:3] for _ in range(3)], [(7.0, False), (7.0, False), (7.0, True)])

    def test_errors(self):
        self.assertRaisesRegex(TouchlineError, "call reset", self.make().step, [0, 0])
        self.assertRaisesRegex(ValueError, "controlled = 3 is not within 1 to the number of robots, 2", Environment, controlled=3, robots=2)
        self.assertRaisesRegex(ValueError, "action = 'legs'", Environment, action="legs")


class TwoSides(unittest.TestCase):
    def test_both_see_themselves_attacking_and_rewards_are_opposite(self):
        environment = TwoSidedEnvironment(program=PROGRAM, randomization=STILL, robots=1, duration=3)
        self.addCleanup(environment.close)
        (own, others), _ = environment.reset(seed=2, options={"place": {"ball": {"x": 0.7, "y": 0.1, "vx": 2}, "robots": {
            "yellow": {0: {"x": 0.3, "y": 0.3}}}}})
        self.assertAlmostEqual(own[0], -others[0], delta=0.05)
        terminated = False
        while not terminated:
            (own, others), rewards, terminated, _, _ = environment.step([[1, 0], [1, 0]])
        self.assertEqual(rewards, (10.0, -10.0))
        self.assertEqual([space["shape"] for space in environment.action_space["spaces"]], [[2], [2]])


class Box:
    def __init__(self, low, high, shape):
        self.low, self.high, self.shape = low, high, shape


class WithGymnasium(unittest.TestCase):
    """A stand-in for the package, because it is not installed here: what the environment uses of it."""

    def test_environments_are_gymnasiums_with_its_spaces_and_arrays(self):
        gymnasium, numpy = types.ModuleType("gymnasium"), types.ModuleType("numpy")

        class Env:
            seeds = []

            def reset(self, *, seed=None, options=None):
                self.seeds.append(seed)

        gymnasium.Env = Env
        gymnasium.spaces = types.SimpleNamespace(Box=Box, Tuple=tuple)
        numpy.asarray = lambda values, dtype: (dtype, list(values))
        import touchline.environment as module
        try:
            with mock.patch.dict(sys.modules, gymnasium=gymnasium, numpy=numpy):
                importlib.reload(module)
                environment = module.Environment(program=PROGRAM)
                self.addCleanup(environment.close)
                self.assertIsInstance(environment, Env)
                self.assertEqual((environment.action_space.shape, environment.action_space.low), ((2,), -1.0))
                observation, _ = environment.reset(seed=5)
                self.assertEqual((observation[0], len(observation[1]), Env.seeds), ("float32", 19, [5]))
                self.assertEqual(environment.step([0, 0])[0][0], "float32")
                two = module.TwoSidedEnvironment(program=PROGRAM)
                self.addCleanup(two.close)
                self.assertEqual(len(two.observation_space), 2)
        finally:
            importlib.reload(module)


if __name__ == "__main__":
    unittest.main()
