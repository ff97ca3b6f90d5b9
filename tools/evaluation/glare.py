"""Glare: lamps mirrored in the tops of robots, in rendered games of the arena whose commands are unknown."""
import json
import math
import random

import judging
import scenes

NAME = "glare"
# Nothing was developed on games with these seeds.
SEEDS, QUICK_SEEDS = (523, 524, 525), (523,)
FRAMES, RATE = 90, 60
# Each third of the robots is struck for a third of a second in turn, after frames without glare.
BLOCK, FREE = 20, 10
ROBOT_SIDE, PATCHES_APART = 0.075, 0.053  # m
# Share of the light of a pixel value of 255 that is added, and the goal.
CASES = ((0.15, {"right": 95.0, "wrong": 0}), (0.5, {"right": 50.0, "wrong": 0}))
REACH = 0.0375  # m


def spot_on(robot, light, draw):
    """A spot of one to three robot sides in diameter near the center of a robot."""
    patches = [robot["team_px"], *robot["ident_px"]]
    side = ROBOT_SIDE / PATCHES_APART * math.dist(patches[0], patches[1])
    u, v = judging.mean(patches)
    return {"kind": "glare", "u": u + side * draw.uniform(-0.3, 0.3), "v": v + side * draw.uniform(-0.3, 0.3),
            "size": side * draw.uniform(1, 3), "light": light}


def strike(truth, light, seed):
    """Returns the spots and the numbers of the struck robots by file. A spot keeps its place on the robot for a block of frames."""
    spots, struck = {}, {}
    for frame, one in enumerate(truth[FREE:]):
        block = frame // BLOCK
        struck[one["file"]] = [i for i in range(len(one["robots"])) if (i + block) % 3 == 0]
        spots[one["file"]] = [spot_on(one["robots"][i], light, random.Random(f"{seed} {block} {i}")) for i in struck[one["file"]]]
    return spots, struck


def game_of(tools, board, seed):
    folder = tools.out / "games" / f"glare-{seed}"
    tools.run("arena", "--board", board, "--out", folder, "--count", FRAMES, "--seed", seed, "--quiet", "match")
    return folder, scenes.truth_of(folder)


def judged_game(tools, board, seed, light):
    """Returns the judged pictures; only struck robots count."""
    folder, truth = game_of(tools, board, seed)
    spots, struck = strike(truth, light, seed)
    changed = tools.out / "changed" / f"glare-{seed}-{light}"
    things = tools.out / f"glare-{seed}-{light}.json"
    things.write_text(json.dumps(spots))
    tools.run("relight", folder, "--things", things, "--out", changed)
    _, lines = tools.replay(changed, board.parent / "venue.toml", board.parent / "team.toml", changed.name, "--rate", RATE)
    seen = {line["file"]: line["sightings"] for line in lines}
    out = []
    for one in truth:
        robots = [{"team": r["team"], "id": r["id"], "at": (r["x"], r["y"]), "counted": i in struck.get(one["file"], ())}
                  for i, r in enumerate(one["robots"])]
        ball = (one["ball"]["x"], one["ball"]["y"]) if one["ball"] else None
        out.append(judging.judge({"robots": robots, "ball": ball}, seen[one["file"]], judging.field_place, REACH, REACH))
    return out


def evaluate(tools, report, board, quick):
    for light, goal in CASES:
        case = f"struck robots, white + {100 * light:g} %"

        def measure(light=light, goal=goal, case=case):
            judged = [one for seed in (QUICK_SEEDS if quick else SEEDS) for one in judged_game(tools, board, seed, light)]
            report.reliability.add_judged(judged)
            report.add(NAME, case, judging.add_up(judged), goal)
        report.attempt(NAME, case, goal, measure)
