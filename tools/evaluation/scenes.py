"""Reference scenes: calibration from `empty`, `grey` and `samples`, numbers from all other folders of a set."""
import json
import math
import re

# Goals of the known sets; other sets have none.
GOALS = {
    "plain": {"seen": 99.9, "ball_seen": 100, "position": (0.7, 2.5), "angle": (0.7, 3), "ball": 1.0,
              "noise": (0.25, 0.25), "filtered": (0.12, 0.12)},
    "patchy": {"seen": 99.5, "ball_seen": 99.5, "position": (1.2, 4), "angle": (1.0, 4), "ball": 1.5, "touching": 99},
    "small-field": {"seen": 99.9, "ball_seen": 100, "position": (0.8, 3), "angle": (0.6, 2.5), "ball": 1.0},
    "fisheye": {"seen": 99.9, "ball_seen": 100, "position": (0.9, 3), "angle": (0.8, 3), "ball": 1.2},
}


def half(value):
    return round(2 * value) / 2


def scene_of(folder):
    return json.loads((folder / "empty" / "scene.json").read_text())


def truth_of(folder):
    return [json.loads(line) for line in (folder / "truth.jsonl").read_text().splitlines()]


def write_team(scene, robots, path):
    """Returns the team file that matches the robots of the set."""
    ids = {}
    for robot in robots:
        ids.setdefault(robot["team"], {})[robot["id"]] = robot["ident"]
    teams = sorted(ids)
    side, patch = scene["robot_m"], scene["patch_m"]
    middle = scene["quadrant_m"] / 2
    lines = ["version = 1", "[[layout]]", 'name = "set"', f"robot_side_m = {side}",
             f"height_m = {scene['robot_height_m']}"]
    for role, sign in (("team", 1), ("identification", -1)):
        lines += ["[[layout.patch]]", f'role = "{role}"', 'outline = "square"', f"x_m = {sign * middle}",
                  f"y_m = {sign * middle}", f"length_m = {patch}", f"width_m = {patch}"]
    for section, team in zip(("own", "opponent"), teams):
        lines += [f"[{section}]", 'layout = "set"', f'color = "{team}"', f"max_robots = {len(ids[team])}"]
        for number, color in sorted(ids[team].items()):
            lines += [f"[[{section}.robot]]", f"id = {number}", f'colors = ["{color}"]']
    lines += ["[ball]", 'color = "orange"', f"radius_m = {scene['ball_radius_m']}"]
    path.write_text("\n".join(lines) + "\n")


def write_clicks(truth, path):
    clicks = []
    for picture in truth:
        def click(color, pixel):
            clicks.append({"image": picture["file"], "color": color, "u": half(pixel[0]), "v": half(pixel[1])})
        if picture["ball"]:
            click("orange", (picture["ball"]["u"], picture["ball"]["v"]))
        for robot in picture["robots"]:
            click(robot["team"], robot["team_px"])
            click(robot["ident"], robot["ident_px"])
    path.write_text(json.dumps({"samples": clicks}))


def pictures_of(folder):
    return sorted(p for p in folder.iterdir() if p.suffix in (".png", ".ppm", ".jpg"))


def calibrate(tools, folder, team, clicks, venue, no_height):
    """Writes the venue file; returns how the field was found."""
    venue.unlink(missing_ok=True)
    scene = scene_of(folder)
    empty = [option for p in pictures_of(folder / "empty") for option in ("--picture", p)]
    field = ["field", "--venue", venue, *empty, "--length", scene["field"][0], "--width", scene["field"][1]]
    if not no_height:
        field += ["--camera-height", round(scene["camera_m"][2], 2)]
    how = "no click"
    if tools.run("calibrate", *field, may_fail=True) is None:
        how = "corners clicked"
        tools.run("calibrate", *field, "--corners", *(f"{half(u)},{half(v)}" for u, v in scene["corners_px"]))
    grey = [option for p in pictures_of(folder / "grey") for option in ("--picture", p)]
    tools.run("calibrate", "light", "--venue", venue, *grey)
    learn_colors(tools, folder, team, clicks, venue)
    return how


def learn_colors(tools, folder, team, clicks, venue):
    return tools.colors("--venue", venue, "--samples", clicks, "--images", folder / "samples", "--team", team)


def without_section(text, section):
    """Returns a TOML text without one of its sections."""
    return re.sub(rf"(?m)^\[{section}\]\n(?:(?!\[).*\n)*", "", text)


class Sum:
    """Pools the numbers of several folders."""

    def __init__(self):
        self.counts, self.errors = {}, {}

    def add(self, sightings):
        for key in ("robots", "right", "unknown", "swapped", "missed", "ghosts", "balls", "balls_seen", "ball_ghosts"):
            self.counts[key] = self.counts.get(key, 0) + sightings[key]
        for key in ("position_m", "angle_rad", "ball_m"):
            one = sightings[key]
            count, squares, most = self.errors.get(key, (0, 0.0, 0.0))
            self.errors[key] = (count + one["count"], squares + one["count"] * one["rms"] ** 2, max(most, one["max"]))

    def rms_and_max(self, key, unit):
        count, squares, most = self.errors[key]
        return (unit * math.sqrt(squares / count), unit * most) if count else (None, None)

    def numbers(self):
        c = self.counts
        return {
            "robots": c["robots"], "seen": 100 * c["right"] / max(1, c["robots"]), "unknown": c["unknown"],
            "swapped": c["swapped"], "missed": c["missed"], "ghosts": c["ghosts"] + c["ball_ghosts"],
            "balls": c["balls"], "ball_seen": 100 * c["balls_seen"] / max(1, c["balls"]),
            "position": self.rms_and_max("position_m", 1e3), "angle": self.rms_and_max("angle_rad", 180 / math.pi),
            "ball": self.rms_and_max("ball_m", 1e3)}


def recognize(tools, folder, venue, team, name, *options):
    """Returns the numbers of all folders except those for calibration, pooled and per folder, and the results by folder."""
    total, each, results = Sum(), {}, {}
    for part in sorted(p for p in folder.iterdir() if (p / "truth.jsonl").exists()):
        if part.name in ("empty", "grey", "samples"):
            continue
        result, lines = tools.replay(part, venue, team, f"{name}-{part.name}", *options)
        numbers = tools.evaluate(part / "truth.jsonl", result)
        total.add(numbers["sightings"])
        one = Sum()
        one.add(numbers["sightings"])
        each[part.name] = one.numbers()
        results[part.name] = (lines, numbers)
    return total.numbers(), each, results


def row_of(results):
    """Returns the counts of all folders."""
    names = {"wrong": "swapped"}
    keys = ("robots", "right", "unknown", "wrong", "missed", "ghosts", "balls", "balls_seen", "ball_ghosts")
    return {key: sum(numbers["sightings"][names.get(key, key)] for _, numbers in results.values()) for key in keys}


def mean_angle(angles):
    return math.atan2(sum(map(math.sin, angles)), sum(map(math.cos, angles)))


def stationary_noise(lines, source):
    """Returns the RMS deviation from each robot's mean in mm and degrees; for tracks over the second half of the frames."""
    robots = {}
    for line in lines[len(lines) // 2 if source == "tracks" else 0:]:
        for robot in line[source]["robots"]:
            if robot["id"] is not None and robot["theta"] is not None:
                robots.setdefault((robot["team"], robot["id"]), []).append(robot)
    squares, turns, count = 0.0, 0.0, 0
    for seen in robots.values():
        x, y = (sum(r[k] for r in seen) / len(seen) for k in "xy")
        theta = mean_angle([r["theta"] for r in seen])
        squares += sum((r["x"] - x) ** 2 + (r["y"] - y) ** 2 for r in seen)
        turns += sum(math.remainder(r["theta"] - theta, 2 * math.pi) ** 2 for r in seen)
        count += len(seen)
    if count == 0:
        return None
    return 1e3 * math.sqrt(squares / count), math.degrees(math.sqrt(turns / count))


def times_bound(tools, folder, result, venue, team):
    """Returns the ratio of the noise of stationary robots to the Cramer-Rao bound: position, angle; RMS over the robots."""
    robots = tools.evaluate(folder / "truth.jsonl", result, "--pictures", folder, "--venue", venue, "--team",
                            team)["bound"]

    def times(measured, least):
        return math.sqrt(sum(r[measured] ** 2 for r in robots) / sum(r[least] ** 2 for r in robots))
    return times("position_rms_m", "position_m"), times("angle_rms_rad", "angle_rad")


def calibrated(tools, folder, no_height):
    """Returns venue and team file of a set, and how its field was found."""
    name = folder.name
    scene = scene_of(folder)
    samples = truth_of(folder / "samples")
    team, clicks = tools.out / f"{name}-team.toml", tools.out / f"{name}-clicks.json"
    write_team(scene, samples[0]["robots"], team)
    write_clicks(samples, clicks)
    venue = tools.out / f"{name}-venue.toml"
    return venue, team, calibrate(tools, folder, team, clicks, venue, no_height)


def evaluate(tools, folder, venue, team, field):
    """Returns the numbers of the clean pictures, and the results by folder: lines and numbers."""
    name = folder.name
    clicks = tools.out / f"{name}-clicks.json"
    out = {"field": field}
    out["all"], out["folders"], results = recognize(tools, folder, venue, team, name)
    if "static" in results:
        lines, _ = results["static"]
        out["noise"] = stationary_noise(lines, "sightings")
        out["filtered"] = stationary_noise(lines, "tracks")
        out["times_bound"] = times_bound(tools, folder / "static", tools.out / f"{name}-static.jsonl", venue, team)
    out["paper_model"], _, _ = recognize(tools, folder, venue, team, f"{name}-paper", "--set", "camera_model.kind=paper")
    # Learns the colors again without the light map.
    without = tools.out / f"{name}-without-light.toml"
    without.write_text(without_section(venue.read_text(), "light"))
    learn_colors(tools, folder, team, clicks, without)
    out["without_light"], _, _ = recognize(tools, folder, without, team, f"{name}-without-light", "--set",
                                      "adaptation.mode=off")
    return out, results


def print_table(sets):
    if not sets:
        return
    names = list(sets)
    width = max(16, *(len(n) + 2 for n in names))

    def row(title, cell):
        print(f"{title:<34}" + "".join(f"{cell(n):>{width}}" for n in names).rstrip())

    def mark(reached):
        return "" if reached else " !"

    def share(key, goal):
        def cell(name):
            value, wanted = sets[name]["all"][key], GOALS.get(name, {}).get(goal)
            return f"{value:.2f} %" + mark(wanted is None or value >= wanted - 1e-9)
        return cell

    def rms_and_max(key, part="all"):
        def cell(name):
            rms, most = sets[name][part][key]
            if rms is None:
                return "-"
            wanted = GOALS.get(name, {}).get(key) if part == "all" else None
            low, high = wanted if isinstance(wanted, tuple) else (wanted, None)
            return f"{rms:.2f} / {most:.2f}" + mark((low is None or rms <= low) and (high is None or most <= high))
        return cell

    def pair(key):
        def cell(name):
            value = sets[name].get(key)
            if value is None:
                return "-"
            wanted = GOALS.get(name, {}).get(key)
            return f"{value[0]:.3f} / {value[1]:.3f}" + mark(wanted is None or all(v <= w for v, w in zip(value, wanted)))
        return cell

    def count(*keys):
        def cell(name):
            value = sum(sets[name]["all"][k] for k in keys)
            return f"{value}" + mark(value == 0)
        return cell

    def touching(name):
        part = sets[name]["folders"].get("touching")
        if part is None:
            return "-"
        wanted = GOALS.get(name, {}).get("touching")
        good = part["swapped"] == 0 and (wanted is None or part["seen"] >= wanted)
        return f"{part['seen']:.2f} %, {part['swapped']}" + mark(good)

    print("\nscenes: robots and balls in single pictures, without tracking; RMS / max; !: goal not reached")
    row("", lambda n: n)
    row("field found by", lambda n: sets[n]["field"])
    row("robots", lambda n: str(sets[n]["all"]["robots"]))
    row("robots seen", share("seen", "seen"))
    row("ball seen", share("ball_seen", "ball_seen"))
    row("swapped ids, ghosts", count("swapped", "ghosts"))
    row("robot position, mm", rms_and_max("position"))
    row("angle, degrees", rms_and_max("angle"))
    row("ball position, mm", rms_and_max("ball"))
    row("touching robots seen, swapped", touching)
    row("stationary: noise, mm / degrees", pair("noise"))
    row("stationary: filtered, mm / degrees", pair("filtered"))
    row("stationary: noise / Cramer-Rao bound", pair("times_bound"))
    row("without light map: robots seen", lambda n: f"{sets[n]['without_light']['seen']:.2f} %")
    row("without light map: ball seen", lambda n: f"{sets[n]['without_light']['ball_seen']:.2f} %")
    row("the paper's camera model, mm", rms_and_max("position", "paper_model"))
    row("the paper's camera model, degrees", rms_and_max("angle", "paper_model"))
