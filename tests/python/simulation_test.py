#!/usr/bin/env python3
"""Games in lock-step with the program of the argument: they repeat on a busy machine, two programs play, errors are exceptions.

usage: simulation_test.py TOUCHLINE_SIMULATE
"""
import contextlib
import gc
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import unittest
from unittest import mock

import package
import touchline
from touchline import ArenaError, ClosedError, Place, RefusedCommandError, RefusedMessageError, Simulation, Velocity, Wheels

PROGRAM = sys.argv.pop(1)
BOARD = package.ROOT / "boards/mock/board.toml"


def chase(frame):
    return {0: Place(frame.ball.x, frame.ball.y), 1: Velocity(0.3, 1.0)} if frame.ball else {}


def play(frames=120):
    """Plays a short game; returns its hash and the last frame."""
    with Simulation(PROGRAM) as game:
        frame = game.reset(seed=4, opponent="univector", robots=3)
        for _ in range(frames):
            frame = game.step(chase(frame))
        return game.hash(), frame


class Games(unittest.TestCase):
    def test_repeats_bit_for_bit_on_an_idle_and_a_busy_machine(self):
        idle, frame = play()
        self.assertEqual(frame.number, 120)
        busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2 * (os.cpu_count() or 1))]
        try:
            self.assertEqual(play()[0], idle)
        finally:
            for process in busy:
                process.kill()
                process.wait()

    def test_frames_have_score_side_field_referee_events_and_truth(self):
        with Simulation(PROGRAM) as game:
            frame = game.reset(robots=2, robots_return=False, place={"ball": {"x": 0.9, "y": 0.1, "vx": 3}, "robots": {
                "yellow": {0: {"x": 0.5, "y": 0.5}}}})
            self.assertEqual((frame.score, frame.side["team"], frame.field["length"], frame.referee["phase"]),
                             ({"own": 0, "opponent": 0}, "blue", 2.2, "running"))
            frames = game.step_frames(frames=30, truth=True, sightings=True)
        self.assertEqual([frame.number for frame in frames], list(range(1, 31)))
        self.assertEqual(frames[-1].score["own"], 1)
        events = [(event.kind, event.team) for frame in frames for event in frame.events]
        self.assertIn(("goal", "blue"), events)
        self.assertAlmostEqual(frames[-1].truth["robots"]["yellow"]["0"]["y"], 0.5)
        self.assertEqual(len(frames[-1].raw["sightings"]["robots"]), 4)

    def test_places_throws_and_faults(self):
        with Simulation(PROGRAM) as game:
            game.reset(robots=1, robots_return=False)
            game.place({"robots": {"blue": {0: {"x": 0.2, "y": 0.3, "theta": 1.0}}}})
            for place in ({"x": -0.5}, {"y": -0.5}):
                with self.assertRaisesRegex(ValueError, "is missing; give both coordinates"):
                    game.throw(0.5, 0.0, **place)
            game.throw(0.5, 0.0, x=-0.5, y=-0.5)
            frame = game.step(frames=12)
            self.assertAlmostEqual(frame.robots["blue"][0].x, 0.2, places=2)
            self.assertGreater(frame.ball.x, -0.45)
            game.fault("hide_robot", 0.4, team="opponent", id=0)
            frame = game.step(frames=12)
            self.assertEqual([frame.robots[team][0].seen for team in ("blue", "yellow")], [True, False])
            before = frame.t
            game.fault("camera_stall", 0.5)
            self.assertGreater(game.step(frames=2).t - before, 0.5)

    def test_this_program_drives_both_sides(self):
        with Simulation(PROGRAM) as game:
            frame = game.reset(opponent="external", robots=2, robots_return=False)
            for _ in range(30):
                frame = game.step({0: Wheels(0.3, 0.3)}, {0: Wheels(0.3, 0.3)})
            self.assertEqual(game.opponent_frame.side["team"], "yellow")
            self.assertAlmostEqual(game.opponent_frame.robots["yellow"][0].x, frame.robots["blue"][0].x, delta=0.02)
            self.assertGreater(frame.robots["blue"][0].x, -0.95)

    def test_another_program_drives_the_opponents(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        address = f"unix://{folder.name}/game"
        server = subprocess.Popen([PROGRAM, "serve", "--board", BOARD, "--listen", address], stdout=subprocess.PIPE)
        self.addCleanup(server.stdout.close)
        server.stdout.readline()
        teams = []

        def opponent():
            with Simulation(address=address) as other:
                other.join()
                for _ in range(10):
                    teams.append(other.step({0: Wheels(0.3, 0.3)}).side["team"])

        with Simulation(address=address) as game:
            game.begin(opponent="program", robots=1, robots_return=False)
            thread = threading.Thread(target=opponent)
            thread.start()
            for _ in range(10):
                frame = game.step({0: Wheels(0.3, 0.3)})
            thread.join()
            self.assertEqual((frame.number, teams), (9, ["yellow"] * 10))
            # It has gone, and the game waits for nobody.
            with self.assertRaisesRegex(ClosedError, "the opponents' program has ended|touchline-simulate has ended"):
                game.step()
        self.assertEqual(server.wait(), 1)

    def test_errors_name_the_member_and_the_game_goes_on(self):
        with Simulation(PROGRAM) as game:
            with self.assertRaisesRegex(RefusedMessageError, "there is no game yet; send a reset first"):
                game.step()
            game.reset(robots=1)
            for wrong, message in [
                    (lambda: game.step({3: Velocity(0, 0)}), r"step\.commands\[0\]\.id = 3: team blue has no such robot"),
                    (lambda: game.step(frames=0), r"step\.frames = 0 is not within 1 to 600"),
                    (lambda: game.place({"ball": {"x": 9, "y": 0}}), r"ball\.x = 9 is not within"),
                    (lambda: game.reset(opponent="chess"), 'there is no strategy "chess"; there are'),
                    (lambda: game.reset(settings={"arena.nothing": 1}), "nothing")]:
                with self.assertRaisesRegex(RefusedMessageError, message):
                    wrong()
            with self.assertRaisesRegex(RefusedCommandError, "robot 0: v = 12 is not within -10 to 10"):
                game.step({0: Velocity(12, 0)})
            self.assertEqual(game.step().number, 1)

    def test_silence_ends_the_game_with_an_error(self):
        with Simulation(PROGRAM, silence=0.05) as game:
            game.reset(robots=1)
            game._process.wait()
            self.assertRaisesRegex(ClosedError, "the program was silent for 0.05 s; the game has ended", game.step)
            self.assertIn("the program was silent", game.output())

    def test_a_wrong_board_is_an_error(self):
        with Simulation(PROGRAM, board="missing.toml") as game:
            self.assertRaisesRegex(RefusedMessageError, "missing.toml", game.reset)

    def test_a_program_that_does_not_start_is_an_error_with_its_words(self):
        with self.assertRaisesRegex(ArenaError, "(?s)touchline-simulate ended with .*--silence"):
            Simulation(PROGRAM, silence=-1)

    def test_many_can_play_at_once_and_leave_nothing(self):
        descriptors = len(os.listdir("/proc/self/fd"))
        games = [Simulation(PROGRAM) for _ in range(3)]
        frames = [each.reset(seed) for seed, each in enumerate(games)]
        self.assertEqual(len({frame.ball.x for frame in frames}), 3)
        processes = [each._process for each in games]
        games[0].close()
        games[1].close()
        del games
        gc.collect()  # one was forgotten
        self.assertTrue(all(process.returncode is not None for process in processes))
        self.assertEqual(len(os.listdir("/proc/self/fd")), descriptors)
        self.assertEqual(list(pathlib.Path(tempfile.gettempdir()).glob("touchline-simulation-*/game")), [])

    def test_plays_the_game_of_the_documentation(self):
        text = (package.ROOT / "docs/python.md").read_text()
        strategy = re.search(r"```python\n([^`]*?touchline\.Simulation\(\).*?)```", text, re.DOTALL)[1]
        printed = io.StringIO()
        with mock.patch("touchline.simulation.find_program", return_value=pathlib.Path(PROGRAM)), contextlib.redirect_stdout(printed):
            exec(strategy, {"touchline": touchline})
        self.assertIn("goal after", printed.getvalue())


if __name__ == "__main__":
    unittest.main()
