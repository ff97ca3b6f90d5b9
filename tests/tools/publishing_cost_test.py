#!/usr/bin/env python3
"""The arithmetic of tools/publishing-cost, with times of known distribution."""
import io
import pathlib
import random
import statistics
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools/evaluation"))
import publishing_cost as cost  # noqa: E402


def rounds_of(count, frames, factor, seed, drift=0.0):
    """Times with a long tail; those with outputs are `factor` times as long. `drift`: between rounds, as a share."""
    chance = random.Random(seed)

    def one_run(scale):
        return [round(scale * 250000 * chance.lognormvariate(0, 0.1)) for _ in range(frames)]

    rounds = []
    for _ in range(count):
        speed = 1 + drift * chance.random()
        rounds.append((one_run(speed), one_run(speed * factor)))
    return rounds


class Percentile(unittest.TestCase):
    def test_is_the_nearest_rank(self):
        values = list(range(1, 1001))
        random.Random(1).shuffle(values)
        for percent, expected in ((50, 500), (90, 900), (99, 990), (99.9, 999), (100, 1000), (0, 1)):
            self.assertEqual(cost.percentile(values, percent), expected)
        self.assertEqual(cost.percentile([7], 99.9), 7)
        self.assertEqual(cost.percentile([7, 9], 99.9), 9)

    def test_of_a_pool_is_that_of_all_its_values(self):
        chance = random.Random(2)
        runs = [[chance.randrange(10000) for _ in range(chance.randrange(50, 400))] for _ in range(7)]
        for percent in (50, 99, 99.9):
            pool = cost.Pool(runs, percent)
            for _ in range(50):
                selection = chance.choices(range(7), k=7)
                together = [value for i in selection for value in runs[i]]
                self.assertEqual(pool.percentile(selection), cost.percentile(together, percent))


class Difference(unittest.TestCase):
    def test_finds_a_planted_cost(self):
        found = cost.Difference(rounds_of(20, 500, 1.10, 3), 99.9, resamples=500)
        self.assertAlmostEqual(found.value, 0.10, delta=0.03)
        self.assertLess(found.low, 0.10)
        self.assertGreater(found.high, 0.10)
        self.assertTrue(found.verdict().startswith("more than 2%"), found.verdict())

    def test_finds_that_there_is_none(self):
        found = cost.Difference(rounds_of(40, 1000, 1.0, 4), 50, resamples=500)
        self.assertLess(abs(found.value), 0.005)
        self.assertEqual(found.verdict(), "within 2%")

    def test_seldom_decides_if_the_cost_is_the_limit(self):
        verdicts = [cost.Difference(rounds_of(20, 60, 1 + cost.LIMIT, 300 + seed), 90, resamples=100).verdict() for seed in range(20)]
        self.assertGreaterEqual(sum(verdict.startswith("undecided") for verdict in verdicts), 16)

    def test_pairs_cancel_what_both_runs_of_a_round_share(self):
        # The computer's speed changes by half between rounds, which is far more than the cost.
        found = cost.Difference(rounds_of(20, 500, 1.05, 6, drift=0.5), 50, resamples=500)
        self.assertAlmostEqual(found.value, 0.05, delta=0.01)
        self.assertLess(found.high - found.low, 0.06)

    def test_the_interval_contains_the_truth_in_most_experiments(self):
        # 95 % are promised; a bootstrap of 20 rounds keeps a little less.
        hits = 0
        for seed in range(40):
            found = cost.Difference(rounds_of(20, 60, 1.03, 100 + seed), 90, resamples=100)
            hits += found.low <= 0.03 <= found.high
        self.assertGreaterEqual(hits, 33)
        self.assertLess(hits, 40)

    def test_the_interval_is_as_wide_as_the_estimate_scatters(self):
        found = [cost.Difference(rounds_of(20, 60, 1.0, 200 + seed), 90, resamples=100) for seed in range(40)]
        scatter = statistics.stdev(one.value for one in found)
        width = statistics.mean(one.high - one.low for one in found)
        self.assertAlmostEqual(width / (2 * 1.96 * scatter), 1.0, delta=0.25)


class Report(unittest.TestCase):
    def test_names_frames_differences_and_verdict(self):
        self.assertIn("3000 frames without clients of the console, 3000 with 4\n", cost.report(rounds_of(10, 300, 1.2, 7), 0, 4))
        text = cost.report(rounds_of(10, 300, 1.2, 7), 0)
        for expected in ("3000 frames without outputs, 3000 with 4 outputs and 3 listeners", "p99.9", "allocations in the loop: 0",
                         "the cost at p99.9 is more than 2%"):
            self.assertIn(expected, text)

    def test_a_wrong_command_line_gives_exit_code_64(self):
        sys.stderr, errors = io.StringIO(), sys.stderr
        self.addCleanup(setattr, sys, "stderr", errors)
        for arguments in (["--rounds", "7"], ["--seconds", "0"], ["--no-such-option"]):
            with self.assertRaises(SystemExit) as end:
                cost.parse(arguments)
            self.assertEqual(end.exception.code, 64)
        self.assertEqual(cost.parse(["--rounds", "8", "--", "--set", "a=1"]).options, ["--set", "a=1"])


if __name__ == "__main__":
    unittest.main()
