"""Tracks and collisions: games of the arena, compared with its truth by touchline-evaluate --game."""
import math

NAME = "motion"
# Nothing was developed on games with these seeds. A robot that stands long at a place with an unusual error makes the NEES of
# one game three times that of others, so there are many.
SEEDS, QUICK_SEEDS = tuple(range(401, 409)), (401,)
DURATION_S = 30
# Squared errors per variance that is stated, and the track's error relative to the sighting's.
CONSISTENT, NOT_WORSE = (0.7, 1.5), (0.0, 1.0)


def first(rows, name, frames_after=None):
    return next(r for r in rows if r["name"] == name and r.get("frames_after") == frames_after)


def pooled(summaries):
    """Returns the RMS of several games. Without errors, a game's is null."""
    count = sum(s["count"] for s in summaries)
    return math.sqrt(sum(s["count"] * s["rms"] ** 2 for s in summaries if s["count"]) / count) if count else None


def largest(summaries):
    return max((s["max"] for s in summaries if s["count"]), default=None)


def mean(rows, key, errors):
    """Returns the mean of a value per error of several games. Without values, a game's is null."""
    rows = [r for r in rows if r[key] is not None]
    count = sum(r[errors]["count"] for r in rows)
    return sum(r[errors]["count"] * r[key] for r in rows) / count if count else None


def ratio(rows, tracked, sighted):
    track, sighting = pooled([r[tracked] for r in rows]), pooled([r[sighted] for r in rows])
    return track / sighting if sighting else None


def scaled(value, unit):
    return None if value is None else value * unit


def measures():
    """Returns (case, goal, function of a list of games, function of the number of samples)."""
    out = []

    def add(case, goal, rows_of, value, count):
        out.append((case, goal, lambda games: value([rows_of(g) for g in games]),
                    lambda games: sum(rows_of(g)[count]["count"] for g in games)))

    for name in ("own robots", "opponents"):
        def robots(game, name=name):
            return first(game["robots"], name)
        add(f"{name}, when the command acts, mm", (0.0, 1.3), robots,
            lambda rows: scaled(pooled([r["at_action_m"] for r in rows]), 1e3), "at_action_m")
        add(f"{name}, when the command acts, degrees", (0.0, 0.9), robots,
            lambda rows: scaled(pooled([r["at_action_rad"] for r in rows]), 180 / math.pi), "at_action_rad")
    for name in ("own robots", "opponents", "at rest", "own at 1 m/s"):
        def robots(game, name=name):
            return first(game["robots"], name)
        add(f"{name}, track / sighting, position", NOT_WORSE, robots,
            lambda rows: ratio(rows, "track_m", "sighting_m"), "track_m")
        add(f"{name}, track / sighting, heading", NOT_WORSE, robots,
            lambda rows: ratio(rows, "track_rad", "sighting_rad"), "track_rad")
        add(f"{name}, NEES of the position", CONSISTENT, robots, lambda rows: mean(rows, "nees_position", "track_m"), "track_m")
        add(f"{name}, NEES of the heading", CONSISTENT, robots, lambda rows: mean(rows, "nees_heading", "track_m"), "track_m")
        add(f"{name}, NIS", CONSISTENT, robots, lambda rows: mean(rows, "nis", "track_m"), "track_m")
    for name in ("own robots", "opponents"):
        def impact(game, name=name):
            return first(game["impacts"], name, 1)
        add(f"{name}, 1 frame after an impact, max mm", (0.0, 10.0), impact,
            lambda rows: scaled(largest([r["track_m"] for r in rows]), 1e3), "track_m")
        add(f"{name}, 1 frame after an impact, m/s", (0.0, 0.3), impact,
            lambda rows: pooled([r["speed_mps"] for r in rows]), "speed_mps")

    def bounce(game):
        return first(game["impacts"], "ball", 1)

    def wall(game):
        return first(game["balls"], "ball within 60 mm of a wall")

    add("ball, 1 frame after a bounce, mm", (0.0, 10.0), bounce,
        lambda rows: scaled(pooled([r["track_m"] for r in rows]), 1e3), "track_m")
    add("ball within 60 mm of a wall, sighting, mm", (0.0, 2.0), wall,
        lambda rows: scaled(pooled([r["sighting_m"] for r in rows]), 1e3), "sighting_m")
    add("ball within 60 mm of a wall, track, mm", (0.0, 2.0), wall,
        lambda rows: scaled(pooled([r["track_m"] for r in rows]), 1e3), "track_m")
    for name in ("ball", "ball within 60 mm of a wall"):
        def ball(game, name=name):
            return first(game["balls"], name)
        add(f"{name}, NEES", CONSISTENT, ball, lambda rows: mean(rows, "nees", "track_m"), "track_m")
        add(f"{name}, NIS", CONSISTENT, ball, lambda rows: mean(rows, "nis", "track_m"), "track_m")
        add(f"{name}, track / sighting", NOT_WORSE, ball, lambda rows: ratio(rows, "track_m", "sighting_m"), "track_m")
    return out


def rows_of(games):
    """Returns a row for each measure: its value over all games, and in each game."""
    return [{"set": NAME, "case": case, "value": value(games), "count": count(games),
             "each": [value([game]) for game in games], "goal": {"value": goal}} for case, goal, value, count in measures()]


def sequence_rows(name, numbers):
    """Returns the rows of a rendered game whose commands are unknown."""
    rows = []
    for case, key in (("position", "position_m"), ("heading", "angle_rad")):
        sighted, tracked = numbers["sightings"][key], numbers["tracks"][key]
        value = tracked["rms"] / sighted["rms"] if sighted["rms"] else None
        rows.append({"set": name, "case": f"match, track / sighting, {case}", "value": value, "count": tracked["count"],
                     "each": [value], "goal": {"value": NOT_WORSE}})
    return rows


def evaluate(tools, results, board, quick):
    games = []
    for seed in QUICK_SEEDS if quick else SEEDS:
        numbers = results.attempt(NAME, f"game with seed {seed}", {}, lambda seed=seed: tools.evaluate(
            "--game", board, "--duration", DURATION_S, "--seed", seed))
        if numbers is not None:
            games.append(numbers)
    results.details[NAME] = games
    for row in rows_of(games) if games else ():
        results.measured(row)
