#!/usr/bin/env python3
"""Commands become the messages of the documentation; what Touchline would refuse is refused with the reason."""
import json
import math
import re
import unittest

from package import ROOT
from touchline import Place, RefusedCommandError, Release, Velocity, Wheels
from touchline.command import LIMITS, MAX_ROBOTS, command_message


class Commands(unittest.TestCase):
    def test_are_the_message_of_the_documentation(self):
        text = (ROOT / "docs/network.md").read_text()
        documented = re.search(r"```json\n(\{\"commands\".*?)```", text, re.DOTALL)[1]
        message = command_message({1: Velocity(0.3, 0), 2: Wheels(0.2, 0.3), 3: Place(0.1, -0.2, 1.57), 4: Release()})
        self.assertEqual(json.loads(message), json.loads(documented))
        self.assertNotIn(b"\n", message)

    def test_a_heading_may_be_left_out(self):
        self.assertEqual(json.loads(command_message({0: Place(1, 2)})), {"commands": [{"id": 0, "x": 1, "y": 2}]})

    def test_have_the_ranges_of_the_documentation(self):
        text = (ROOT / "docs/network.md").read_text()
        found = {}
        for names, ranges in re.findall(r"^\| (`[a-z`, ]+.*?) \|.*\| (-\d.*) \|$", text, re.MULTILINE):
            limits = [float(limit) for limit in re.findall(r" to (\d+)", ranges)]
            members = re.findall(r"`(\w+)`", names)
            found.update(zip(members, limits if len(members) == len(limits) else [limits[0]] * 2 + limits[1:]))
        self.assertEqual(found, LIMITS)

    def test_refusals_say_why(self):
        for commands, message in [
                ({3: Velocity(12, 0)}, "robot 3: v = 12 is not within -10 to 10"),
                ({3: Velocity(0, math.nan)}, "robot 3: w = nan is not within -100 to 100"),
                ({0: Wheels(0, -10.5)}, "robot 0: right = -10.5 is not within -10 to 10"),
                ({0: Place(0, math.inf)}, "robot 0: y = inf is not within -20 to 20"),
                ({0: Place(0, 0, 2000)}, "robot 0: theta = 2000 is not within -1000 to 1000"),
                ({0: Velocity("fast", 0)}, "robot 0: v = 'fast' is not a number"),
                ({0: Velocity(True, 0)}, "robot 0: v = True is not a number"),
                ({128: Release()}, "128 is not the id of a robot: ids are integers from 0 to 127"),
                ({"0": Release()}, "'0' is not the id of a robot: ids are integers from 0 to 127"),
                ({0: (1, 2)}, "(1, 2) is not a command: use Velocity, Wheels, Place or Release"),
                ({i: Release() for i in range(MAX_ROBOTS + 1)}, "commands for 12 robots; a message has at most 11")]:
            with self.assertRaises(RefusedCommandError) as raised:
                command_message(commands)
            self.assertEqual(str(raised.exception), message)


if __name__ == "__main__":
    unittest.main()
