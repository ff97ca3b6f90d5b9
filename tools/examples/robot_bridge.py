#!/usr/bin/env python3
"""A bridge to robots that no radio format describes (a queue of motions, MQTT, Bluetooth LE). Replace send().

  touchline run --board boards/mock/board.toml --publish json                  # in one terminal
  tools/examples/robot_bridge.py                                               # in another

On a real board, set radio.backend = "null" in the board file: the bridge is the radio.
"""
import json
import select
import socket

SILENCE_S = 0.2  # without frames for this long, all robots stop
frames = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
frames.bind(("127.0.0.1", 9870))
frames.setblocking(False)


def send(robot, v, w):
    """Drives a robot at v m/s and w rad/s. It must not wait for an answer. GRITSBot 2: publish this text by MQTT."""
    print(robot, json.dumps({"method": "write", "body": {"v": v, "w": w, "type": "motor"}}), flush=True)


def newest_frame():
    """The last frame that has arrived: older ones would only delay the robots. None: there is none."""
    data = None
    if select.select([frames], [], [], SILENCE_S)[0]:
        try:
            while True:
                data = frames.recv(65536)
        except BlockingIOError:
            pass
    return json.loads(data) if data else None


robots = set()
while True:
    frame = newest_frame()
    commands = frame["commands"] if frame and not frame["stop"] else {}
    robots |= set(commands)
    for robot in sorted(robots):
        command = commands.get(robot, {"v": 0.0, "w": 0.0})
        send(robot, round(command["v"], 3), round(command["w"], 3))
