#!/usr/bin/env python3
"""Tests how tools/evaluate-all judges, and what it keeps when a set fails. Runs none of Touchline's programs."""
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tools" / "evaluation"))
import changed_light  # noqa: E402
import glare  # noqa: E402
import judging  # noqa: E402
import motion  # noqa: E402
import real_sets  # noqa: E402
import table  # noqa: E402
import truth  # noqa: E402

REACH = 10


def robot(team, number, at):
    return {"team": team, "id": number, "at": at}


def report(team, number, at, confidence=0.9):
    return {"team": team, "id": number, "x": at[0], "y": at[1], "confidence": confidence}


def judge(robots, reports, ball=None, seen_ball=None):
    return judging.judge({"robots": robots, "ball": ball}, {"robots": reports, "ball": seen_ball}, judging.field_place,
                         REACH, REACH)


def counts(*args, **named):
    return {k: v for k, v in judging.add_up([judge(*args, **named)]).items() if v}


class Judging(unittest.TestCase):
    def test_each_verdict(self):
        robots = [robot("blue", i, (100 * i, 0)) for i in range(5)]
        reports = [report("blue", 0, (3, 0)), report("blue", None, (103, 0)), report("blue", 1, (203, 0)),
                   report("yellow", 3, (303, 0)), report("blue", 7, (0, 500))]
        self.assertEqual(counts(robots, reports),
                         {"robots": 5, "right": 1, "unknown": 1, "wrong": 2, "missed": 1, "ghosts": 1})

    def test_sightings_far_from_the_truth(self):
        robots = [robot("blue", i, (0.1 * i, 0)) | {"theta": 3.1} for i in range(4)]
        reports = [report("blue", i, at) | {"theta": -3.1} for i, at in ((0, (0.001, 0)), (1, (0.1, 0.003)), (7, (0.21, 0)))]
        judged = [judging.judge({"robots": robots, "ball": None}, {"robots": reports, "ball": None}, judging.field_place, 0.03, 0.03)]
        row = changed_light.far_row("set", judged)
        self.assertEqual((row["count"], row["value"]), (2, 50))  # wrong and missed robots have no place that counts
        self.assertAlmostEqual(row["each"][0], 3)
        self.assertAlmostEqual(row["each"][1], 4.766, 3)
        self.assertIsNone(changed_light.far_row("set", [])["value"])

    def test_an_id_that_is_reported_twice_is_right_once(self):
        robots = [robot("blue", 0, (0, 0)), robot("blue", 1, (100, 0))]
        self.assertEqual(counts(robots, [report("blue", 0, (1, 0)), report("blue", 0, (99, 0))]),
                         {"robots": 2, "right": 1, "wrong": 1})

    def test_a_report_belongs_to_the_nearest_robot(self):
        robots = [robot("blue", 0, (0, 0)), robot("blue", 1, (12, 0))]
        self.assertEqual(counts(robots, [report("blue", 1, (7, 0)), report("blue", 0, (1, 0))]), {"robots": 2, "right": 2})

    def test_robots_that_do_not_count_are_neither_missed_nor_ghosts(self):
        hidden = robot("blue", 0, (0, 0)) | {"counted": False}
        self.assertEqual(counts([hidden], []), {})
        self.assertEqual(counts([hidden], [report("blue", 0, (1, 0))]), {})

    def test_an_unknown_id_is_right_for_a_robot_that_is_not_in_the_team_file(self):
        without_id = robot("blue", None, (0, 0))
        self.assertEqual(counts([without_id], [report("blue", None, (0, 0))])["right"], 1)
        self.assertEqual(counts([without_id], [report("blue", 2, (0, 0))])["wrong"], 1)

    def test_balls(self):
        self.assertEqual(counts([], [], ball=(0, 0), seen_ball={"x": 1, "y": 1}), {"balls": 1, "balls_seen": 1})
        self.assertEqual(counts([], [], ball=(0, 0), seen_ball={"x": 50, "y": 1}), {"balls": 1, "ball_ghosts": 1})
        self.assertEqual(counts([], [], seen_ball={"x": 50, "y": 1}), {"ball_ghosts": 1})

    def test_reliability(self):
        all_reports = judging.Reliability()
        for i in range(10):
            all_reports.add_judged([judge([robot("blue", 0, (0, 0))], [report("blue", 0 if i else 1, (0, 0), 0.85)])])
        self.assertEqual([(r["from"], r["reports"], round(r["right"], 3)) for r in all_reports.rows()], [(0.8, 10, 0.9)])
        without_id = judging.Reliability()
        without_id.add_judged([judge([robot("blue", 0, (0, 0))], [report("blue", None, (0, 0), 1.0)])])
        self.assertEqual([(r["kind"], r["from"], r["right"]) for r in without_id.rows()], [("sightings without id", 0.9, 1.0)])


class Truth(unittest.TestCase):
    def test_a_robot_moves_on_a_line_between_its_keys(self):
        keys = [[0, 10, 20], [10, 20, 40]]
        self.assertEqual(truth.place_at(keys, 5), (15, 30))
        self.assertEqual(truth.place_at(keys, 20), (20, 40))

    def test_all_files_agree_with_their_team_files(self):
        footage = ROOT / "tests" / "footage"
        for name, team in (("mirosot-triangles", "mirosot-triangles"), ("vsss-halves", "vsss-halves")):
            for picture in truth.pictures(footage / f"{name}-truth.json", footage / f"{team}-team.toml").values():
                self.assertEqual(len({(r["team"], r["id"]) for r in picture["robots"]}), len(picture["robots"]))
                self.assertNotIn(None, [r["id"] for r in picture["robots"]])
        for name in ("vss-overhead", "pushed-robots"):
            frames = truth.frames(footage / f"{name}-truth.json", footage / f"{name}-team.toml")
            self.assertNotIn(None, [r["id"] for r in frames[0]["robots"]])
        hidden = truth.frames(footage / "pushed-robots-truth.json", footage / "pushed-robots-team.toml")[190]
        self.assertEqual([r["counted"] for r in hidden["robots"]], [False, True])


class Table(unittest.TestCase):
    ROW = {"set": "a", "case": "b", "robots": 10, "right": 9, "unknown": 1, "wrong": 0, "missed": 0, "ghosts": 0, "balls": 2,
           "balls_seen": 1, "ball_ghosts": 0, "goal": {"right": 95.0, "wrong": 0, "ball": 98.0}}

    def test_marks_what_is_not_reached(self):
        self.assertEqual(table.missed_goals(self.ROW), ["right", "ball"])
        self.assertEqual(table.missed_goals(self.ROW | {"wrong_earlier": 1, "right": 10, "balls_seen": 2}), ["wrong"])
        self.assertEqual(table.text_of(self.ROW, {}).count("!"), 2)
        self.assertIn("80.0, 3, -", table.text_of(self.ROW, {"a: b": {"right": 80.0, "wrong": 3, "ball": None}}))

    def test_a_failure_is_a_line_with_its_reason(self):
        failed = {"set": "a", "case": "b", "failed": "program --options\ntouchline-program: no patch:\n  click", "goal": {}}
        self.assertIn("failed: no patch; click", table.text_of(failed, {}))
        self.assertEqual(table.summary([failed]), {"a: b": {"failed": "failed"}})


class Motion(unittest.TestCase):
    @staticmethod
    def game(error, nees, count=10):
        def errors(rms):
            if count == 0:
                return {"count": 0, "rms": None, "p95": None, "max": None}
            return {"count": count, "rms": rms, "p95": 2 * rms, "max": 3 * rms}
        robots = [{"name": name, "sighting_m": errors(0.001), "track_m": errors(error), "sighting_rad": errors(0.01),
                   "track_rad": errors(0.01), "at_action_m": errors(error), "at_action_rad": errors(0.01), "nees_position": nees,
                   "nees_heading": 1.0, "nis": 1.0}
                  for name in ("own robots", "opponents", "at rest", "own at 1 m/s", "opponents at 1 m/s")]
        balls = [{"name": name, "sighting_m": errors(error), "track_m": errors(error), "lost": 0, "nees": nees, "nis": 1.0}
                 for name in ("ball", "ball within 60 mm of a wall")]
        impacts = [{"name": name, "frames_after": after, "track_m": errors(error), "speed_mps": errors(0.1), "lost": 0}
                   for name in ("own robots", "opponents", "ball") for after in (0, 1, 2)]
        return {"robots": robots, "balls": balls, "impacts": impacts}

    def row(self, games, case):
        return next(row for row in motion.rows_of(games) if row["case"] == case)

    def test_pools_games_by_their_number_of_samples(self):
        games = [self.game(0.001, 1.0), self.game(0.003, 2.0, count=30)]
        self.assertAlmostEqual(self.row(games, "own robots, when the command acts, mm")["value"], 7 ** 0.5)
        self.assertAlmostEqual(self.row(games, "own robots, NEES of the position")["value"], 1.75)
        self.assertAlmostEqual(self.row(games, "own robots, 1 frame after an impact, max mm")["value"], 9.0)
        self.assertEqual(self.row(games, "ball, NEES")["each"], [1.0, 2.0])

    def test_marks_what_is_outside_of_its_goal(self):
        good, bad = [self.game(0.0005, 1.0)], [self.game(0.0021, 0.6)]
        self.assertEqual([r["case"] for r in motion.rows_of(good) if table.missed_goals(r)], [])
        missed = [r["case"] for r in motion.rows_of(bad) if table.missed_goals(r)]
        for case in ("own robots, when the command acts, mm", "opponents, track / sighting, position", "ball, NEES",
                     "ball within 60 mm of a wall, sighting, mm"):
            self.assertIn(case, missed)
        row = self.row(bad, "ball, NEES")
        self.assertIn("0.60 !", table.text_of(row, {}))
        self.assertIn("goal: 0.7 to 1.5, before: 1.10", table.text_of(row, {"motion: ball, NEES": {"value": 1.1}}))
        self.assertEqual(table.summary([row]), {"motion: ball, NEES": {"value": 0.6}})

    def test_a_game_without_errors_does_not_count(self):
        games = [self.game(None, None, count=0), self.game(0.003, 2.0)]
        for row, value in (("own robots, when the command acts, mm", 3.0), ("own robots, NEES of the position", 2.0)):
            self.assertAlmostEqual(self.row(games, row)["value"], value)
            self.assertIsNone(self.row(games, row)["each"][0])

    def test_a_game_without_impacts_has_no_value(self):
        empty = self.row([self.game(0.001, 1.0, count=0)], "own robots, 1 frame after an impact, max mm")
        self.assertIsNone(empty["value"])
        self.assertEqual(table.missed_goals(empty), [])


class Turns(unittest.TestCase):
    def test_counts_accepted_pictures_and_keeps_reasons(self):
        judged = {"robots": [{"verdict": "right", "truth": {}, "report": None}, {"verdict": "wrong", "truth": {}, "report": None}],
                  "ball": None, "ball_truth": None, "ball_right": None}
        row, details = real_sets.turns(["a.png", "b.png", "c.png"], lambda name: "no ball" if name == "b.png" else None,
                                       lambda name: [judged] * (2 if name == "a.png" else 1))
        self.assertEqual((row["robots"], row["right"], row["wrong"]), (6, 3, 3))
        self.assertEqual(row["note"], "2 of 3 accepted, refused: b")
        self.assertEqual(details["b.png"], {"refused": "no ball"})
        self.assertEqual(details["a.png"]["right"], 2)
        self.assertEqual(table.missed_goals({**row, "goal": {"wrong": 0}}), ["wrong"])
        self.assertIn("2 of 3 accepted, refused: b", table.text_of({"set": "s", "case": "each", **row, "goal": {}}, {}))


class Glare(unittest.TestCase):
    def test_strikes_each_third_of_the_robots_in_turn(self):
        robot = {"team_px": [100, 100], "ident_px": [[110, 110]]}
        truth = [{"file": f"{k}.png", "robots": [robot] * 6} for k in range(glare.FREE + 3 * glare.BLOCK)]
        spots, struck = glare.strike(truth, 0.15, 7)
        self.assertNotIn(f"{glare.FREE - 1}.png", struck)
        self.assertEqual([struck[f"{glare.FREE + k * glare.BLOCK}.png"] for k in range(3)], [[0, 3], [2, 5], [1, 4]])
        first, last = (spots[f"{glare.FREE + k}.png"] for k in (0, glare.BLOCK - 1))
        self.assertEqual(first, last)
        side = 14.142 / glare.PATCHES_APART * glare.ROBOT_SIDE
        for spot in first:
            self.assertLessEqual(side, spot["size"] + 0.01)
            self.assertLessEqual(spot["size"], 3 * side + 0.01)
            self.assertLessEqual(math.dist((spot["u"], spot["v"]), (105, 105)), 0.3 * side * 1.415)


class Program(unittest.TestCase):
    def test_keeps_its_results_when_every_set_fails(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            for name in ("first", "second"):
                for part in ("empty", "grey", "samples"):
                    (folder / name / part).mkdir(parents=True)
            environment = {k: v for k, v in os.environ.items() if k != "TOUCHLINE_SHARED"}
            done = subprocess.run([ROOT / "tools" / "evaluate-all", "--scenes", folder / "first", folder / "second", "--footage",
                                   "none", "--out", folder / "out", "--build", folder], env=environment, capture_output=True,
                                  text=True, check=False)
            self.assertEqual(done.returncode, 1, done.stderr)
            rows = json.loads((folder / "out" / "evaluation.json").read_text())["rows"]
            self.assertEqual([r["set"] for r in rows if "failed" in r], ["first", "second"] + ["motion"] * len(motion.SEEDS) +
                             ["glare"] * len(glare.CASES))
            self.assertIn("second", (folder / "out" / "evaluation.html").read_text())
            self.assertIn("failed", done.stdout)


if __name__ == "__main__":
    unittest.main()
