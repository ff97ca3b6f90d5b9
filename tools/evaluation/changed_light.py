"""Reference scenes under light that they were not calibrated for, made by touchline-relight."""
import concurrent.futures
import math

import judging
import scenes

LIGHT = {"right": 99.0, "wrong": 0}
BALL = {"wrong": 0, "ball": 99.9}
# Name, options of touchline-relight, goals.
CASES = (
    ("light x 0.5", ("--light", 0.5), LIGHT),
    ("light x 0.75", ("--light", 0.75), {**LIGHT, **BALL}),
    ("light x 1.5", ("--light", 1.5), LIGHT),
    ("light x 2", ("--light", 2), LIGHT),
    ("pixel values x 0.5", ("--values", "0.5,0.5,0.5"), LIGHT),
    ("red +15 %, blue -15 %", ("--values", "1.15,1,0.85"), LIGHT),
    ("red -15 %, blue +15 %", ("--values", "0.85,1,1.15"), LIGHT),
    ("shadow x 0.35 on half", ("--shadow", 0.35), {"right": 95.0, "wrong": 0}),
    ("JPEG quality 60", ("--jpeg", 60), BALL),
    ("blur 1.5 px", ("--blur", 1.5), BALL),
)
QUICK = ("light x 0.5", "light x 2", "shadow x 0.35 on half")
# Folders of a set that are changed. The others are sequences.
PARTS = ("layouts", "touching")
# In m: as touchline-evaluate.
REACH = 0.02
WORKERS = 2


def truth_of(picture):
    ball = picture["ball"]
    return {"ball": None if ball is None else (ball["x"], ball["y"]),
            "ball_px": None if ball is None else (ball["u"], ball["v"]),
            "robots": [{"team": r["team"], "id": r["id"], "at": (r["x"], r["y"]),
                        "px": judging.mean([r["team_px"], r["ident_px"]])} for r in picture["robots"]]}


def judge(truth, part):
    return judging.judge(truth, part, judging.field_place, REACH, REACH)


def outline_px(scene):
    """Radius of a robot's circle in pixels."""
    a, b = scene["corners_px"][:2]
    return 0.053 * math.dist(a, b) / scene["field"][0]


def pictures_of(tools, folder, name, options, limit):
    """Changes the pictures of a set; returns pairs of picture and truth."""
    out = []
    for part in PARTS:
        if not (folder / part).is_dir():
            continue
        target = tools.out / "changed" / f"{folder.name}-{name}-{part}"
        tools.run("relight", folder / part, *options, "--out", target)
        pairs = [(target / f"{one['file'].rsplit('.', 1)[0]}.png", truth_of(one)) for one in scenes.truth_of(folder / part)]
        out += pairs[:limit]
    return out


def after_a_second(tools, pictures, venue, team, name):
    """Returns what is judged in the last frame, and the number of wrong reports in the frames before."""
    def one(number_and_pair):
        number, (picture, truth) = number_and_pair
        lines = tools.replay_standing(picture, venue, team, f"{name}-{number}")
        judged = [judge(truth, line["sightings"]) for line in lines]
        (tools.out / f"{name}-{number}.jsonl").unlink()
        return judged[-1], judging.add_up(judged[:-1])["wrong"]
    with concurrent.futures.ThreadPoolExecutor(WORKERS) as pool:
        results = list(pool.map(one, enumerate(pictures)))
    return [last for last, _ in results], sum(wrong for _, wrong in results)


def in_single_pictures(tools, pictures, venue, team, name):
    """Without adaptation, all pictures of a folder can be replayed at once."""
    by_folder = {}
    for picture, truth in pictures:
        by_folder.setdefault(picture.parent, {})[picture.name] = truth
    judged = []
    for folder, truths in by_folder.items():
        _, lines = tools.replay(folder, venue, team, name, "--set", "adaptation.mode=off")
        judged += [judge(truths[line["file"]], line["sightings"]) for line in lines if line["file"] in truths]
    return judged


def evaluate(tools, report, folder, venue, team, quick):
    """Adds the rows of all cases, with adaptation after one second and without it."""
    radius = outline_px(scenes.scene_of(folder))
    for case, options, goal in CASES:
        if quick and case not in QUICK:
            continue

        def measure(case=case, options=options, goal=goal):
            name = case.replace(" ", "-").replace("%", "").replace(",", "")
            pictures = pictures_of(tools, folder, name, options, 2 if quick else None)
            off = in_single_pictures(tools, pictures, venue, team, f"{folder.name}-{name}-off")
            judged, earlier = after_a_second(tools, pictures, venue, team, f"{folder.name}-{name}")
            report.reliability.add_judged(judged)
            row, row_off = judging.add_up(judged), judging.add_up(off)
            worse = (row["right"] < row_off["right"] or row["wrong"] > row_off["wrong"]
                     or row["balls_seen"] < row_off["balls_seen"])
            report.add(folder.name, f"{case}, after 1 s", row | {"wrong_earlier": earlier, "worse_than_off": worse}, goal)
            report.add(folder.name, f"{case}, adaptation off", row_off, {})
            picture, truth = pictures[0]
            report.picture(folder.name, case, picture, judged[0], radius, truth)
        report.attempt(folder.name, case, goal, measure)
