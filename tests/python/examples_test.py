#!/usr/bin/env python3
"""The laws of the examples without an arena: the univector field leads to the ball in the right direction, the keeper to the ball's way."""
import json
import math
import unittest

import package  # noqa: F401
import keeper
import univector
from touchline import Ball, Place, Velocity, parse_frame


def frame(ball, blue, yellow=()):
    """Robots as (x, y, theta), at rest."""
    def robots(poses):
        return {str(i): {"x": x, "y": y, "theta": theta, "v": 0.0, "w": 0.0, "confidence": 1.0, "seen": True}
                for i, (x, y, theta) in enumerate(poses)}

    place = ball and {"x": ball[0], "y": ball[1], "vx": 0.0, "vy": 0.0, "confidence": 1.0}
    return parse_frame(json.dumps({"frame": 0, "t": 0.0, "tracks": {"ball": place, "robots": []},
                                   "robots": {"blue": robots(blue), "yellow": robots(yellow)}}))


def arrival(x, y, length=2.0, step=0.002):
    """Follows the field. Returns the smallest distance from the origin, the heading there, and the length of the way to it."""
    nearest = (math.inf, 0.0, 0.0)
    for i in range(int(length / step)):
        heading = univector.to_origin(x, y)
        nearest = min(nearest, (math.hypot(x, y), math.remainder(heading, math.tau), i * step))
        x, y = x + step * math.cos(heading), y + step * math.sin(heading)
    return nearest


class Univector(unittest.TestCase):
    def test_each_way_arrives_in_the_direction_of_the_goal(self):
        for i in range(24):
            angle, distance = math.tau * (i + 0.5) / 24, 0.3 + 0.03 * i
            rest, heading, way = arrival(distance * math.cos(angle), distance * math.sin(angle))
            # From the front, the way leads around one spiral, which it approaches but does not reach.
            self.assertLess(rest, 0.01, i)
            self.assertLess(abs(heading), 0.15, i)
            self.assertLess(way, distance + 0.25, i)

    def test_the_field_is_symmetric_and_continuous(self):
        for x in (-0.4, -0.05, 0.03, 0.3):
            for y in (0.0, 0.02, univector.D_E, 0.1):
                self.assertAlmostEqual(math.remainder(univector.to_origin(x, y) + univector.to_origin(x, -y), math.tau), 0.0)
            across = univector.to_origin(x, univector.D_E + 1e-9) - univector.to_origin(x, univector.D_E - 1e-9)
            self.assertAlmostEqual(math.remainder(across, math.tau), 0.0, places=5)

    def test_a_near_robot_is_avoided_and_a_far_one_is_not(self):
        near, far = (univector.around((0.0, 0.0), 0.0, [(x, -0.01)]) for x in (0.03, 0.4))
        self.assertGreater(abs(near), 2.5)
        self.assertAlmostEqual(far, 0.0, places=6)

    def test_drives_ahead_behind_the_ball(self):
        for theta, sign in ((0.0, 1), (math.pi, -1)):  # with either end
            command = univector.attack(frame((0.3, 0.0), [(-0.3, 0.0, theta)]))[0]
            self.assertGreater(sign * command.v, 0.45)
            self.assertLess(abs(command.w), 0.1)

    def test_the_nearest_robot_attacks_and_a_lost_ball_stops_it(self):
        self.assertEqual(list(univector.attack(frame((0.3, 0.0), [(-0.9, 0, 0), (0.1, 0.1, 0)], [(0.3, 0.1, 0)]))), [1])
        self.assertEqual(univector.attack(frame(None, [(-0.9, 0, 0)])), {})
        self.assertEqual(univector.attack(frame((0.0, 0.0), [])), {})


class Keeper(unittest.TestCase):
    def test_expects_the_ball_where_it_crosses_the_line(self):
        self.assertAlmostEqual(keeper.crossing(Ball(-0.54, 0.15, -1.0, -0.5, 1.0)), -0.1)
        self.assertEqual(keeper.crossing(Ball(-0.54, 0.15, 1.0, -0.5, 1.0)), 0.15)  # it rolls away
        self.assertEqual(keeper.crossing(Ball(0.0, 0.15, -1.0, 5.0, 1.0)), keeper.POST_Y)

    def test_moves_along_its_line_with_either_end(self):
        for theta, sign in ((math.pi / 2, 1), (-math.pi / 2, -1)):
            command = keeper.keep(frame((-0.5, 0.1), [(0.5, 0, 0), (keeper.LINE_X, 0.0, theta)]))[1]
            self.assertIsInstance(command, Velocity)
            self.assertGreater(sign * command.v, 0.3)
            self.assertLess(abs(command.w), 0.01)

    def test_corrects_its_heading(self):
        for theta, turn in ((math.pi / 2 - 0.2, 1), (math.pi / 2 + 0.2, -1), (-math.pi / 2 - 0.2, 1), (-math.pi / 2 + 0.2, -1)):
            self.assertGreater(turn * keeper.keep(frame((-0.5, 0.0), [(keeper.LINE_X, 0.0, theta)]))[0].w, 0.5)

    def test_returns_to_its_line(self):
        self.assertEqual(keeper.keep(frame((-0.5, 0.1), [(-0.8, 0.3, 0.0)])), {0: Place(keeper.LINE_X, 0.1, math.pi / 2)})


if __name__ == "__main__":
    unittest.main()
