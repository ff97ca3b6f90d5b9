#!/usr/bin/env python3
"""Lines become frames: that of the documentation, older and newer ones, and lines that are none."""
import json
import re
import unittest

from package import ROOT
from touchline import MalformedFrameError, parse_frame

FEWEST = {"frame": 1, "t": 0.5}
ROBOT = {"x": 0.1, "y": 0.2, "theta": 0.3, "v": 0.4, "w": 0.5, "confidence": 0.9, "seen": True}


def frame(**members):
    return parse_frame(json.dumps({**FEWEST, **members}))


class Frame(unittest.TestCase):
    def test_reads_the_line_of_the_documentation(self):
        text = (ROOT / "docs/network.md").read_text()
        read = parse_frame(re.search(r"```json\n(\{\"schema\".*?)```", text, re.DOTALL)[1])
        self.assertEqual((read.number, read.t, read.timestamp, read.sent), (41, 12.25, 1700000000.123456, 1700000000.136))
        robot = read.robots["blue"][3]
        self.assertEqual((robot.team, robot.id, robot.x, robot.y, robot.theta, robot.v, robot.w, robot.confidence, robot.seen),
                         ("blue", 3, 0.6615, 0.5005, -2.02, 0.5, 1.25, 0.9995, True))
        self.assertEqual(read.robots["yellow"], {})
        self.assertEqual((read.stop, read.halt, read.halt_reasons, read.phase), (False, 0, (), "running"))
        command, report = read.commands[3], read.telemetry[3]
        self.assertEqual((command.v, command.w, command.left, command.right), (0.4, 1.0, 0.365, 0.435))
        self.assertEqual((report.battery, report.link, report.age), (7.412, 98, 0.25))
        self.assertIsNone(read.ball)

    def test_reads_the_line_of_a_replay(self):
        text = (ROOT / "docs/replay.md").read_text()
        read = parse_frame(re.search(r"```json\n(\{\"frame\".*?)```", text, re.DOTALL)[1])
        self.assertEqual((read.number, read.ball.x, read.ball.vy, read.ball.confidence), (0, -0.70393, 0.0, 0.99))
        self.assertEqual((read.robots, read.stop, read.timestamp), ({}, None, None))

    def test_what_is_missing_is_none(self):
        read = frame(tracks={"ball": None, "robots": []}, score=None)
        for name in ("timestamp", "sent", "ball", "stop", "halt", "phase", "score", "side", "field", "referee"):
            self.assertIsNone(getattr(read, name), name)
        self.assertEqual((read.robots, read.unidentified, read.commands, read.telemetry), ({}, (), {}, {}))

    def test_new_members_are_ignored_or_kept_as_they_are(self):
        read = frame(robots={"blue": {"1": {**ROBOT, "new": 1}}}, weather="fine", score={"blue": 1})
        self.assertEqual((read.robots["blue"][1].x, read.score, read.raw["weather"]), (0.1, {"blue": 1}, "fine"))

    def test_the_referee_tells_restart_and_taker(self):
        told = frame(referee={"phase": "prepare", "age": 0.1, "restart": "penalty", "taken_by": "opponent"})
        self.assertEqual((told.restart, told.taken_by), ("penalty", "opponent"))
        for referee in (None, {"phase": "running", "age": 0.1}, {"restart": None, "taken_by": None}):
            self.assertEqual((frame(referee=referee).restart, frame(referee=referee).taken_by), (None, None))

    def test_robots_without_an_id_are_listed(self):
        unknown = {**ROBOT, "team": "yellow", "id": None, "theta": None}
        read = frame(tracks={"robots": [{**ROBOT, "team": "blue", "id": 2}, unknown]})
        self.assertEqual([(robot.team, robot.id, robot.theta) for robot in read.unidentified], [("yellow", None, None)])

    def test_halt_reasons_are_words(self):
        self.assertEqual(frame(halt=2 + 256 + (1 << 20)).halt_reasons, ("emergency stop", "stopped from the console", "reason 1048576"))

    def test_halt_reasons_are_those_of_the_documentation(self):
        row = next(line for line in (ROOT / "docs/network.md").read_text().splitlines() if line.startswith("| `halt` |"))
        documented = re.findall(r"(\d+) ([a-z ]+)", row)
        self.assertGreater(len(documented), 10)
        for bit, text in documented:
            self.assertEqual(frame(halt=int(bit)).halt_reasons, (text.strip(),))

    def test_errors_name_the_member(self):
        for members, message in [
                ({"robots": {"blue": {"3": {**ROBOT, "x": "a"}}}}, 'robots.blue.3.x = "a" is not a number'),
                ({"robots": {"blue": {"3": {"x": 1}}}}, "robots.blue.3.y is missing"),
                ({"robots": {"blue": {"x": {}}}}, "robots.blue.x is not the id of a robot"),
                ({"robots": {"blue": 5}}, "robots.blue is not an object: 5"),
                ({"frame": True}, "frame = true is not an integer"),
                ({"stop": 1}, "stop = 1 is not true or false"),
                ({"tracks": {"robots": {}, "ball": {"x": 0}}}, "tracks.ball.y is missing"),
                ({"tracks": {"robots": 7}}, "tracks.robots = 7 is not a list"),
                ({"schema": 2}, "schema = 2, but this package reads 1; install the package of the Touchline that is running")]:
            with self.assertRaises(MalformedFrameError) as raised:
                frame(**members)
            self.assertEqual(str(raised.exception), message)

    def test_lines_that_are_no_json(self):
        for line in ("", "{", b"\xff\xfe\x00", "[" * 100000, "[1]", "null"):
            with self.assertRaises(MalformedFrameError):
                parse_frame(line)


if __name__ == "__main__":
    unittest.main()
