#!/usr/bin/env python3
"""The arena as a child process, with the program of the argument: frames and commands, two at a time, its end, and errors.

usage: arena_test.py TOUCHLINE
"""
import contextlib
import io
import os
import pathlib
import re
import stat
import sys
import tempfile
import time
import unittest
from unittest import mock

import package
import touchline
from touchline import Arena, ArenaError, Place, Release, Velocity, Wheels
from touchline.arena import find_board, find_program

PROGRAM = sys.argv.pop(1)


def open_descriptors():
    return len(os.listdir("/proc/self/fd"))


class Arenas(unittest.TestCase):
    def test_gives_frames_and_drives_robots(self):
        descriptors = open_descriptors()
        with Arena(PROGRAM, duration=3, opponents="stand") as arena:
            driven = 0
            for frame in arena.client:
                # All kinds at the limits that the package permits: the program must not refuse any.
                arena.client.send({0: Velocity(0, 100), 1: Wheels(-10, 10), 2: Place(-20, 20, 1000), 3: Place(0.0, 0.0), 4: Release()})
                driven += 0 in frame.commands and frame.commands[0].w > 1
        self.assertEqual((len(frame.robots["blue"]), len(frame.robots["yellow"])), (5, 5))
        self.assertGreater(driven, 30)  # of 180 frames
        self.assertGreater(frame.robots["blue"][0].w, 1)
        output = arena.output()
        self.assertNotIn("malformed", output)
        self.assertIn("end       limit of frames or duration reached", output)
        self.assertIsNotNone(arena.goals())
        self.assertEqual(open_descriptors(), descriptors)

    def test_plays_the_strategy_of_the_documentation(self):
        text = (package.ROOT / "docs/python.md").read_text()
        strategy = re.search(r"```python\n(.*?arena\.goals.*?)```", text, re.DOTALL)[1].replace("duration=30", "duration=1")
        printed = io.StringIO()
        with mock.patch("touchline.arena.find_program", return_value=pathlib.Path(PROGRAM)), contextlib.redirect_stdout(printed):
            exec(strategy, {})
        self.assertEqual(printed.getvalue(), "(0, 0)\n")

    def test_two_play_at_the_same_time_and_end_when_they_are_closed(self):
        with Arena(PROGRAM, seed=1) as one, Arena(PROGRAM, seed=2) as other:
            folders = [arena._output.parent for arena in (one, other)]
            balls = [arena.client.next_frame().ball for arena in (one, other)]
            self.assertNotEqual(*balls)
            processes = [one._process, other._process]
        self.assertEqual([process.returncode for process in processes], [0, 0])
        self.assertFalse(any(folder.exists() for folder in folders))

    def test_a_wrong_key_is_an_error_with_the_programs_words(self):
        with self.assertRaisesRegex(ArenaError, r'(?s)ended with 1 before its first frame.*arena\.opponents: "foo" is not one of'):
            Arena(PROGRAM, opponents="foo")

    def test_a_program_that_is_killed_is_an_error(self):
        with self.assertRaisesRegex(ArenaError, r"(?s)^the arena ended with -9; its last lines:\n.*publish: json to unix://"):
            with Arena(PROGRAM) as arena:
                arena._process.kill()
                for _ in arena.client:
                    pass
                self.assertRaises(touchline.ClosedError, arena.client.next_frame)


class Programs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name).resolve()

    def program(self, path, text="#!/bin/sh\necho cannot do it; exit 3\n"):
        path = self.folder / path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return path

    def find(self, *arguments, clone, path=""):
        with mock.patch("touchline.arena._clone", return_value=self.folder / clone), mock.patch.dict(os.environ, PATH=path):
            return find_program(*arguments)

    def test_is_the_named_one_else_that_of_the_clone_else_that_of_path(self):
        named, built, installed = map(self.program, ("named", "clone/build/release/firmware/touchline", "bin/touchline"))
        path = str(installed.parent)
        self.assertEqual(self.find(named, clone="clone", path=path), named)
        self.assertEqual(self.find(clone="clone", path=path), built)
        self.assertEqual(self.find(clone="no_clone", path=path), installed)
        self.assertRaisesRegex(ArenaError, "no touchline in PATH, and none at .*; build it", self.find, clone="no_clone")
        self.assertRaisesRegex(ArenaError, "missing is not a program", self.find, "missing", clone="clone")

    def test_has_its_board_beside_it(self):
        installed = self.program("usr/bin/touchline")
        board = self.folder / "usr/share/touchline/boards/mock/board.toml"
        with mock.patch("touchline.arena._clone", return_value=self.folder):
            self.assertRaisesRegex(ArenaError, "no boards/mock/board.toml beside it; name the board file", find_board, installed)
            board.parent.mkdir(parents=True)
            board.touch()
            self.assertEqual(find_board(installed), board)

    def test_that_fails_is_an_error_with_its_last_lines(self):
        with self.assertRaises(ArenaError) as raised:
            Arena(self.program("fails"), board="board.toml")
        self.assertEqual(str(raised.exception), "the arena ended with 3 before its first frame; its last lines:\n  cannot do it")

    def test_that_sends_nothing_is_an_error_and_is_ended(self):
        begin = time.monotonic()
        with self.assertRaisesRegex(ArenaError, "^the arena did not start in time: unix://.*no Touchline answers.*; it printed nothing$"):
            Arena(self.program("sleeps", "#!/bin/sh\nexec sleep 60\n"), board="board.toml", timeout=0.3)
        self.assertLess(time.monotonic() - begin, 20)


if __name__ == "__main__":
    unittest.main()
