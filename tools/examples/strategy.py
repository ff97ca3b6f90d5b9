#!/usr/bin/env python3
"""A strategy of your own. The robot nearest to the ball pushes it to the other goal, another one guards our goal.

  touchline run --board boards/mock/board.toml --publish json --accept json    # in one terminal
  tools/examples/strategy.py                                                   # in another
"""
import json
import math
import socket

TEAM = "blue"
GOAL_X = 1.1  # of the other team, m; ours is at -GOAL_X

frames = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
frames.bind(("127.0.0.1", 9870))


def attack(robot, ball):
    """Where the robot drives: around the ball, then behind it, then through it into a half of the goal."""
    aim = math.atan2(math.copysign(0.12, ball["y"]) - ball["y"], GOAL_X - ball["x"]) if abs(ball["y"]) < 0.8 else 0.0
    cos, sin = math.cos(aim), math.sin(aim)
    dx, dy = robot["x"] - ball["x"], robot["y"] - ball["y"]
    along, across = dx * cos + dy * sin, dy * cos - dx * sin
    if along < -0.02 and abs(across) < 0.02 - 0.2 * along:
        return {"x": ball["x"] + 0.4 * cos, "y": ball["y"] + 0.4 * sin}
    beside = 0.0 if along < -0.06 else math.copysign(0.12, across)
    return {"x": ball["x"] - 0.13 * cos - beside * sin, "y": max(-0.84, min(0.84, ball["y"] - 0.13 * sin + beside * cos))}


while True:
    frame = json.loads(frames.recv(65536))
    ball, robots = frame["tracks"]["ball"], frame["robots"][TEAM]
    if ball is None or not robots:
        continue  # without commands, robots stop after 0.2 s
    keeper = min(robots, key=lambda i: math.hypot(robots[i]["x"] + GOAL_X, robots[i]["y"]))
    attacker = min(robots, key=lambda i: math.hypot(robots[i]["x"] - ball["x"], robots[i]["y"] - ball["y"]) + (i == keeper))
    commands = [{"id": int(attacker), **attack(robots[attacker], ball)}]
    if keeper != attacker:
        commands.append({"id": int(keeper), "x": -GOAL_X + 0.07, "y": max(-0.2, min(0.2, ball["y"])), "theta": math.pi / 2})
    frames.sendto(json.dumps({"commands": commands}).encode(), ("127.0.0.1", 20012))
