"""Reference scenes under light that they were not calibrated for, made by touchline-relight."""
import concurrent.futures
import math
import typing

import judging
import scenes

LIGHT = {"right": 99.0, "wrong": 0}
BALL = {"wrong": 0, "ball": 99.9}


class Case(typing.NamedTuple):
    name: str
    options: tuple  # of touchline-relight
    goal: dict
    seconds: int = 1
    before: int = 0  # frames before the change
    limit: int | None = None  # pictures of each folder


CASES = (
    Case("light x 0.5", ("--light", 0.5), LIGHT),
    Case("light x 0.75", ("--light", 0.75), {**LIGHT, **BALL}),
    Case("light x 1.5", ("--light", 1.5), LIGHT),
    Case("light x 2", ("--light", 2), LIGHT),
    Case("pixel values x 0.5", ("--values", "0.5,0.5,0.5"), LIGHT),
    Case("red +15 %, blue -15 %", ("--values", "1.15,1,0.85"), LIGHT),
    Case("red -15 %, blue +15 %", ("--values", "0.85,1,1.15"), LIGHT),
    Case("shadow x 0.35 on half", ("--shadow", 0.35), {"right": 95.0, "wrong": 0}),
    Case("JPEG quality 60", ("--jpeg", 60), BALL),
    Case("blur 1.5 px", ("--blur", 1.5), BALL),
    # A change while the game runs, and a long one, in which an adaptation could confirm its own mistakes.
    Case("step to light x 0.5", ("--light", 0.5), LIGHT, before=15, limit=4),
    Case("step to light x 2", ("--light", 2), LIGHT, before=15, limit=4),
    Case("light x 2", ("--light", 2), LIGHT, seconds=25, limit=2),
    Case("red +15 %, blue -15 %", ("--values", "1.15,1,0.85"), LIGHT, seconds=25, limit=2),
)
QUICK = ("light x 0.5", "light x 2", "shadow x 0.35 on half")
# Share in % of the sightings that are more than FAR_MM from the truth.
FAR = {"value": (0, 0.02)}
FAR_MM = 2
# Folders of a set that are changed. The others are sequences.
PARTS = ("layouts", "touching")
# In m: half a robot. The place of a robot of which only one patch is seen is that of the patch.
REACH = 0.0375
BALL_REACH = 0.02
WORKERS = 2


def truth_of(picture):
    ball = picture["ball"]
    return {"ball": None if ball is None else (ball["x"], ball["y"]),
            "ball_px": None if ball is None else (ball["u"], ball["v"]),
            "robots": [{"team": r["team"], "id": r["id"], "at": (r["x"], r["y"]), "theta": r["theta"],
                        "px": judging.mean([r["team_px"], r["ident_px"]])} for r in picture["robots"]]}


def judge(truth, part):
    return judging.judge(truth, part, judging.field_place, REACH, BALL_REACH)


def outline_px(scene):
    """Radius of a robot's circle in pixels."""
    a, b = scene["corners_px"][:2]
    return 0.053 * math.dist(a, b) / scene["field"][0]


def pictures_of(tools, folder, name, options, limit):
    """Changes the pictures of a set; returns pairs of picture and truth, and the unchanged pictures."""
    out, originals = [], []
    for part in PARTS:
        if not (folder / part).is_dir():
            continue
        target = tools.out / "changed" / f"{folder.name}-{name}-{part}"
        tools.run("relight", folder / part, *options, "--out", target)
        for one in scenes.truth_of(folder / part)[:limit]:
            out.append((target / f"{one['file'].rsplit('.', 1)[0]}.png", truth_of(one)))
            originals.append(folder / part / one["file"])
    return out, originals


def after_a_while(tools, pictures, originals, venue, team, name, case):
    """Returns what is judged in the last frame, and the number of wrong reports since the change."""
    def one(number_and_pair):
        number, (picture, truth) = number_and_pair
        before = originals[number] if case.before else None
        lines = tools.replay_standing(picture, venue, team, f"{name}-{number}", frames=60 * case.seconds,
                                      before=(before, case.before))
        judged = [judge(truth, line["sightings"]) for line in lines[case.before:]]
        (tools.out / f"{name}-{number}.jsonl").unlink()
        return judged[-1], judging.add_up(judged[:-1])["wrong"]
    pool = concurrent.futures.ThreadPoolExecutor(WORKERS)
    try:
        results = list(pool.map(one, enumerate(pictures)))
    finally:
        # After Ctrl-C, without the pictures that are left.
        pool.shutdown(cancel_futures=True)
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


def far_row(name, judged):
    """Returns the row of the places of robots with a right id. Beside it are the largest errors, in mm and degrees."""
    pairs = [(one["truth"], one["report"]) for picture in judged for one in picture["robots"]
             if one["verdict"] == "right" and one["report"].get("theta") is not None]
    mm = [1000 * math.dist(truth["at"], judging.field_place(report)) for truth, report in pairs]
    degrees = [abs(math.degrees(math.remainder(report["theta"] - truth["theta"], math.tau))) for truth, report in pairs]
    return {"set": name, "case": f"all light, adaptation off, % over {FAR_MM} mm off", "count": len(pairs),
            "value": 100 * sum(one > FAR_MM for one in mm) / len(mm) if mm else None,
            "each": [max(mm, default=None), max(degrees, default=None)], "goal": FAR}


def evaluate(tools, report, folder, venue, team, quick):
    """Adds the rows of all cases, with adaptation after one second and without it, and the row of far sightings without it."""
    radius = outline_px(scenes.scene_of(folder))
    all_off = []
    for case in CASES:
        if quick and (case.name not in QUICK or case.seconds > 1):
            continue
        title = f"{case.name}, after {case.seconds} s"

        def measure(case=case, title=title):
            name = f"{folder.name}-{case.name}".replace(" ", "-").replace("%", "").replace(",", "")
            pictures, originals = pictures_of(tools, folder, name, case.options, 2 if quick else case.limit)
            single = in_single_pictures(tools, pictures, venue, team, f"{name}-off")
            off = judging.add_up(single)
            judged, earlier = after_a_while(tools, pictures, originals, venue, team, name, case)
            report.reliability.add_judged(judged)
            row = judging.add_up(judged)
            worse = row["right"] < off["right"] or row["wrong"] > off["wrong"] or row["balls_seen"] < off["balls_seen"]
            report.add(folder.name, title, row | {"wrong_earlier": earlier, "worse_than_off": worse}, case.goal)
            if case.limit is None:
                all_off.extend(single)
                report.add(folder.name, f"{case.name}, adaptation off", off, {})
                picture, truth = pictures[0]
                report.picture(folder.name, title, picture, judged[0], radius, truth)
        report.attempt(folder.name, title, case.goal, measure)
    report.measured(far_row(folder.name, all_off))
