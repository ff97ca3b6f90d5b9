#!/usr/bin/env python3
"""An attacker in a univector field: each point of the field has a heading that leads around other robots to the ball, towards the goal.

  tools/python/examples/univector.py [SEED [SECONDS [lock-step]]]

In lock-step, the game has no pictures and waits for this program, so that it is many times faster and can be repeated.

The heading to the ball is that of Y.-J. Kim, J.-H. Kim, D.-S. Kwon: "Evolutionary programming-based univector field navigation method for
fast mobile robots", IEEE Trans. Systems, Man, and Cybernetics B 31 (2001). The way around moving robots is that of Y.-S. Lim, S.-H. Choi,
J.-H. Kim, D.-H. Kim: "Evolutionary univector field-based navigation with collision avoidance for mobile robot", IFAC World Congress 2008.
"""
import dataclasses
import math
import sys
from collections.abc import Sequence

import touchline
from touchline import Velocity

TEAM = "blue"
GOAL_X = 1.1  # of the other team, m

# Lim et al. found these by evolutionary programming.
D_E, K_R = 0.0537, 0.0415  # m: radius of the spirals, and how smoothly they begin
D_MIN, DELTA = 0.0348, 0.0457  # m: nearer than D_MIN to a robot, only its avoidance counts; DELTA is the width of the transition
K_O = 0.12  # s: another robot is avoided where it will be after this time
# Those of Neon FC's robots (project-neon/NeonFC, controller/uni_controller.py).
MAX_WHEEL_SPEED = 0.5  # m/s
MAX_TURN = 5 * MAX_WHEEL_SPEED  # m/s^2: limit of v * w
K_W = 3.5  # rad/s for a heading error of 1 rad
# Of the arena's robots.
WHEEL_BASE = 0.07  # m
DELAY = 0.1  # s from a frame to the wheels: about 0.03 s to the robot, then its lag of 0.08 s

Point = tuple[float, float]


def spiral(x: float, y: float, turn: int) -> float:
    """The heading at (x, y) on the way into a circle of radius D_E around the origin; turn is 1 for counter-clockwise, -1 for clockwise."""
    distance = math.hypot(x, y)
    share = 2.0 - (D_E + K_R) / (distance + K_R) if distance > D_E else math.sqrt(distance / D_E)
    return math.atan2(y, x) + turn * math.pi / 2 * share


def to_origin(x: float, y: float) -> float:
    """The heading at (x, y) that leads to the origin and arrives there with heading 0, between two spirals."""
    if abs(y) >= D_E:
        side = 1 if y > 0 else -1
        return spiral(x, y - side * D_E, side)
    left, right = spiral(x, y - D_E, 1), spiral(x, y + D_E, -1)
    up, down = D_E + y, D_E - y
    return math.atan2(up * math.sin(left) + down * math.sin(right), up * math.cos(left) + down * math.cos(right))


def around(point: Point, heading: float, obstacles: Sequence[Point]) -> float:
    """Turns the heading away from the nearest obstacle, by the shorter way."""
    if not obstacles:
        return heading
    dx, dy = min(((point[0] - x, point[1] - y) for x, y in obstacles), key=lambda way: math.hypot(*way))
    share = math.exp(-max(0.0, math.hypot(dx, dy) - D_MIN) ** 2 / (2 * DELTA**2))
    away = math.atan2(dy, dx)
    return heading + share * math.remainder(away - heading, math.tau)


def expected_place(robot: touchline.Robot, other: touchline.Robot) -> Point:
    """Where the other robot will be relative to this one: moved by their relative velocity, but never past this robot."""
    def velocity(of: touchline.Robot) -> Point:
        theta = of.theta or 0.0
        return of.v * math.cos(theta), of.v * math.sin(theta)

    (vx, vy), (ux, uy) = velocity(other), velocity(robot)
    sx, sy = K_O * (vx - ux), K_O * (vy - uy)
    distance, shift = math.hypot(other.x - robot.x, other.y - robot.y), math.hypot(sx, sy)
    scale = min(1.0, distance / shift) if shift > 0 else 0.0
    return other.x + scale * sx, other.y + scale * sy


def ahead_of_time(robot: touchline.Robot) -> touchline.Robot:
    """The robot when the command will act on it: on the arc that it drives now."""
    theta = (robot.theta or 0.0) + DELAY * robot.w
    middle, way = theta - DELAY * robot.w / 2, DELAY * robot.v
    return dataclasses.replace(robot, x=robot.x + way * math.cos(middle), y=robot.y + way * math.sin(middle), theta=theta)


def follow(robot: touchline.Robot, ball: Point, obstacles: Sequence[Point]) -> Velocity:
    """The velocities that follow the field: as fast as the wheels and the tires permit."""
    # At a wall the ball cannot be driven around, so it is pushed along the wall.
    aim = math.atan2(-ball[1], GOAL_X - ball[0]) if abs(ball[1]) < 0.8 else 0.0
    cos, sin = math.cos(aim), math.sin(aim)

    def field(point: Point) -> float:
        dx, dy = point[0] - ball[0], point[1] - ball[1]
        return around(point, aim + to_origin(dx * cos + dy * sin, dy * cos - dx * sin), obstacles)

    theta, wanted, step = robot.theta or 0.0, field((robot.x, robot.y)), 0.001
    # Both ends of the robot are alike. It changes to the other one only if that is clearly better, because turning takes time.
    backward = math.cos(wanted - theta) + robot.v < 0
    heading = theta + math.pi if backward else theta
    error = math.remainder(wanted - heading, math.tau)
    turn = K_W * math.sqrt(abs(error))
    ahead = field((robot.x + step * math.cos(heading), robot.y + step * math.sin(heading)))
    curvature = math.remainder(ahead - wanted, math.tau) / step
    bend = max(abs(curvature), 1e-6)
    v = min((2 * MAX_WHEEL_SPEED - WHEEL_BASE * turn) / (2 + WHEEL_BASE * bend),
            (math.sqrt(turn**2 + 4 * MAX_TURN * bend) - turn) / (2 * bend))
    return Velocity(-v if backward else v, v * curvature + math.copysign(turn, error))


def attack(frame: touchline.Frame) -> dict[int, touchline.Command]:
    """The command of our robot nearest to the ball; none if the ball or the robots are lost: then it stops after 0.2 s."""
    own = frame.robots.get(TEAM)
    if frame.ball is None or not own:
        return {}
    ball = frame.ball.x + DELAY * frame.ball.vx, frame.ball.y + DELAY * frame.ball.vy
    robot = min(own.values(), key=lambda one: math.hypot(one.x - ball[0], one.y - ball[1]))
    others = [other for team in frame.robots.values() for other in team.values() if other is not robot]
    assert robot.id is not None
    return {robot.id: follow(ahead_of_time(robot), ball, [expected_place(robot, other) for other in others])}


def main(seed: int = 1, seconds: int = 30, *, lock_step: bool = False) -> None:
    if lock_step:
        with touchline.Simulation() as game:
            frame = game.reset(seed, opponent="stand")
            for _ in range(round(seconds * game.description["rate_hz"])):
                frame = game.step(attack(frame))
            print("goals", (frame.score["own"], frame.score["opponent"]), "game", game.hash())
        return
    with touchline.Arena(seed=seed, duration=seconds, opponents="stand") as arena:
        for frame in arena.client:
            arena.client.send(attack(frame))
    print("goals", arena.goals())


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]), lock_step="lock-step" in sys.argv[3:])
