"""Things beside the robots that are neither robots nor ball: papers, hands, gloves, shoes, robots of a third color."""
import json
import math
import random

import changed_light
import judging
import scenes

CASE = "things beside the robots"
GOAL = {"right": 99.0, "wrong": 0, "false": 0, "ball": 99.9}
# Surfaces under the light in the middle of the field: 8-bit values.
SKINS = ((205, 150, 120), (165, 110, 85), (105, 70, 55))
SLEEVES = ((30, 30, 35), (215, 215, 205), (60, 75, 110), (110, 40, 45), (90, 100, 85))
SHOES = ((225, 225, 220), (35, 35, 40), (120, 120, 125))
BLACK = (18, 18, 20)
# Team colors of no team: white, lime, brown, gray.
THIRD = ((225, 225, 215), (150, 190, 70), (120, 75, 45), (120, 125, 120))
ROBOT_SIDE = 0.075  # m
DRAWS = 300


def rgb(value):
    return {"rgb": value}


def like(pixel):
    return {"like": pixel}


def to_segment(p, a, b):
    """Distance of a point from a segment."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    along = max(0.0, min(1.0, ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy)))
    return math.hypot(p[0] - a[0] - along * dx, p[1] - a[1] - along * dy)


def shapes(draw, picture, side):
    """Things without a place: pairs of thing and radius; a hand has an arm."""
    robots = picture["robots"]
    for team in sorted({r["team"] for r in robots}):
        robot = draw.choice([r for r in robots if r["team"] == team])
        size, width = draw.uniform(0.3, 1.6), draw.uniform(0.5, 1.0)
        yield {"kind": "paper", "size": size * side, "width": width, "colors": [like(robot["team_px"])]}, 0.8 * size * side
    # An adult's palm is 0.1 m long, a shoe 0.28 m.
    yield {"kind": "hand", "size": 1.3 * side, "colors": [rgb(draw.choice(SKINS)), rgb(draw.choice(SLEEVES))]}, 1.6 * side
    if picture["ball"]:
        ball = like([picture["ball"]["u"], picture["ball"]["v"]])
        yield {"kind": "hand", "size": 1.3 * side, "colors": [ball, rgb(draw.choice(SLEEVES))]}, 1.6 * side
    stripes = like(draw.choice(robots)[draw.choice(("team_px", "ident_px"))])
    yield {"kind": "shoe", "size": 3.7 * side, "colors": [rgb(draw.choice(SHOES)), stripes]}, 1.9 * side
    mark = like(draw.choice(robots)["ident_px"])
    yield {"kind": "robot", "size": side, "colors": [rgb(BLACK), rgb(draw.choice(THIRD)), mark]}, 0.75 * side


def center_of(robot):
    return judging.mean([robot["team_px"], robot["ident_px"]])


def taken_off(draw, picture, corners, side):
    """Chooses half of the robots that stand alone; returns their numbers, and things like the floor that cover them."""
    middle = judging.mean(corners)
    places = [center_of(r) for r in picture["robots"]]
    if picture["ball"]:
        places.append((picture["ball"]["u"], picture["ball"]["v"]))
    numbers, covers = [], []
    for i, at in enumerate(places[:len(picture["robots"])]):
        away = max(1.0, math.dist(at, middle))
        floor = [at[k] + 1.7 * side * (middle[k] - at[k]) / away for k in (0, 1)]
        if draw.random() < 0.5 or any(math.dist(p, at) < 2.6 * side or math.dist(p, floor) < 1.3 * side
                                      for j, p in enumerate(places) if j != i):
            continue
        numbers.append(i)
        covers.append({"kind": "paper", "u": at[0], "v": at[1], "size": 2 * side, "seed": draw.getrandbits(32),
                       "colors": [like(floor)]})
    return numbers, covers


def things_of(picture, corners, side, seed):
    """Returns things at random places of a picture, and the numbers of the robots that were taken off.

    The things touch neither each other nor robots nor ball. Robots are taken off because those of a complete team leave no room for
    a false one.
    """
    draw = random.Random(seed)
    gone, out = taken_off(draw, picture, corners, side)
    taken = [(center_of(r), 0.75 * side) for i, r in enumerate(picture["robots"]) if i not in gone]
    if picture["ball"]:
        taken.append(((picture["ball"]["u"], picture["ball"]["v"]), 0.4 * side))
    for thing, radius in shapes(draw, picture, side):
        for _ in range(DRAWS):
            s, t, angle = draw.uniform(0.05, 0.95), draw.uniform(0.05, 0.95), draw.uniform(-math.pi, math.pi)
            # Bilinear between the field's corners.
            at = [(1 - t) * ((1 - s) * corners[0][k] + s * corners[1][k]) + t * ((1 - s) * corners[3][k] + s * corners[2][k])
                  for k in (0, 1)]
            reach = 4 * thing["size"] if thing["kind"] == "hand" else 0.1
            arm = (at[0] - reach * math.cos(angle), at[1] - reach * math.sin(angle))
            if all(math.dist(at, p) > radius + r and to_segment(p, at, arm) > 0.45 * thing["size"] + r for p, r in taken):
                out.append({**thing, "u": at[0], "v": at[1], "angle": angle, "seed": draw.getrandbits(32)})
                taken.append((at, radius))
                break
    return out, gone


def pictures_of(tools, folder, seed):
    """Paints things into the pictures of a set; returns pairs of picture and truth, and the number of things."""
    scene = scenes.scene_of(folder)
    side = changed_light.outline_px(scene) / 0.053 * ROBOT_SIDE
    out, count = [], 0
    for part in changed_light.PARTS:
        if not (folder / part).is_dir():
            continue
        target, things = tools.out / "changed" / f"{folder.name}-things-{part}", {}
        for one in scenes.truth_of(folder / part):
            painted, gone = things_of(one, scene["corners_px"], side, f"{seed} {folder.name} {part} {one['file']}")
            things[one["file"]] = painted
            count += len(painted) - len(gone)
            left = {**one, "robots": [r for i, r in enumerate(one["robots"]) if i not in gone]}
            out.append((target / f"{one['file'].rsplit('.', 1)[0]}.png", changed_light.truth_of(left)))
        file = tools.out / f"{folder.name}-{part}-things.json"
        file.write_text(json.dumps(things))
        tools.run("relight", folder / part, "--things", file, "--out", target)
    return out, count


def false_reports(judged):
    """Returns the robots without an id, the ids and the balls that are none."""
    ghosts = [one["report"] for picture in judged for one in picture["robots"] if one["verdict"] == "ghost"]
    return ([g for g in ghosts if g["id"] is None], [g for g in ghosts if g["id"] is not None],
            sum(picture["ball_right"] is False for picture in judged))


def evaluate(tools, report, folder, venue, team, seed=1):
    """Adds a row: robots, ball and false reports in single pictures in which things lie beside the robots."""
    def measure():
        pictures, count = pictures_of(tools, folder, seed)
        judged = changed_light.in_single_pictures(tools, pictures, venue, team, f"{folder.name}-things")
        report.reliability.add_judged(judged)
        robots, ids, balls = false_reports(judged)
        report.add(folder.name, CASE, judging.add_up(judged) | {"false": len(ids) + balls}, GOAL)
        likely = sum(r["confidence"] >= 0.5 for r in robots)
        report.note(f"{count} things; false: {len(ids)} ids, {balls} balls, {len(robots)} robots without an id ({likely} of them "
                    "with a confidence of 0.5 and more)")
        picture, truth = pictures[0]
        report.picture(folder.name, CASE, picture, judged[0], changed_light.outline_px(scenes.scene_of(folder)), truth)
    report.attempt(folder.name, CASE, GOAL, measure)
