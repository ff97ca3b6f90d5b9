"""Real pictures: repeatability for stationary robots, and recognition after a change of the lamps."""
import json
import math
import os
import re
import shutil
import subprocess

import programs
import scenes

# The picture that the colors are learned from; the other pictures have other lamps.
MIROSOT_LEARNED = "r0"
MIROSOT_ROBOTS = 10
# Number of robots and balls in all pictures of an exposure, counted by hand.
BAR_COUNTS = {"dark": (28, 5), "normal": (70, 12)}
# Number of times that a picture is repeated, so that the adaptation can converge.
REPEATS = 60


def ids_of(line):
    """Returns the number of different ids and the number of ids that were reported twice."""
    ids = [(r["team"], r["id"]) for r in line["sightings"]["robots"] if r["id"] is not None]
    return len(set(ids)), len(ids) - len(set(ids))


def spread_px(lines, names):
    """Returns the RMS distance of each robot's team patch from its mean in pixels."""
    out = {}
    for name in names:
        team, number = name.split()
        points = [(p["u"], p["v"]) for line in lines for r in line["sightings"]["robots"]
                  if r["team"] == team and r["id"] == int(number) for p in r["patches"] if p["role"] == "team"]
        u, v = (sum(p[k] for p in points) / len(points) for k in (0, 1))
        out[name] = math.sqrt(sum((p[0] - u) ** 2 + (p[1] - v) ** 2 for p in points) / len(points))
    return out


def stationary_spread(tools, pictures, venue, team, name, moving=()):
    """Returns the spread of all stationary robots and balls in mm, degrees and pixels."""
    result, lines = tools.replay(pictures, venue, team, name)
    spread = tools.evaluate("--spread", result)["spread"]
    robots = [s["name"] for s in spread if s["name"] != "ball" and s["name"] not in moving]
    pixels = spread_px(lines, robots)
    return [{"name": s["name"], "frames": s["frames"], "of": len(lines), "mm": 1e3 * s["position_rms_m"],
             "degrees": math.degrees(s["angle_rms_rad"]), "px": pixels.get(s["name"])}
            for s in spread if s["name"] not in moving]


def make_venues(tools, recipes, shared):
    """Creates all venue files of the recipes with touchline-calibrate."""
    environment = dict(os.environ, TOUCHLINE_SHARED=str(shared))
    done = subprocess.run([recipes / "make-venues", tools.path("calibrate"), tools.out.resolve()], env=environment,
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise programs.Failed(f"{recipes / 'make-venues'}: {done.stderr.strip()}")


def copy_venue(source, target):
    """Copies a venue file with its light map and reference of the field, whose names contain that of the venue."""
    target.write_text(source.read_text().replace(f"{source.stem}-", f"{target.stem}-"))
    for picture in source.parent.glob(f"{source.stem}-*.png"):
        shutil.copy(picture, target.with_name(picture.name.replace(source.stem, target.stem, 1)))
    return target


def with_colors_of(venue, other):
    """Replaces the sections [colors] and [[color]] of a venue file by those of another one."""
    parts = re.split(r"(?m)^(?=\[)", venue.read_text())
    colors = [p for p in re.split(r"(?m)^(?=\[)", other.read_text()) if p.startswith(("[colors]", "[[color"))]
    venue.write_text("".join(p for p in parts if not p.startswith(("[colors]", "[[color"))) + "\n" + "".join(colors))


def repeated(tools, picture, name):
    """Makes a folder that contains the picture REPEATS times."""
    folder = tools.out / f"{name}-repeated"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    for i in range(REPEATS):
        (folder / f"{i:03d}{picture.suffix}").symlink_to(picture.resolve())
    return folder


def seen_in(tools, picture, venue, team, name, adapt):
    """Returns ids, doubled ids and ball of one picture; with `adapt`, after the adaptation has converged."""
    if adapt:
        _, lines = tools.replay(repeated(tools, picture, name), venue, team, name, "--rate", 10, "--set",
                                "adaptation.time_constant_s=1")
    else:
        _, lines = tools.replay(picture, venue, team, name, "--set", "adaptation.mode=off")
    ids, doubled = ids_of(lines[-1])
    return {"ids": ids, "doubled": doubled, "robots": len(lines[-1]["sightings"]["robots"]),
            "ball": lines[-1]["sightings"]["ball"] is not None}


def mirosot_fields(tools, pictures):
    """Finds the field without clicks in every picture; returns the residual and the straightness of the border."""
    out = {}
    for picture in pictures:
        venue = tools.out / "mirosot-field-venue.toml"
        venue.unlink(missing_ok=True)
        output = tools.run("calibrate", "field", "--venue", venue, "--picture", picture, "--field-preset",
                         "mirosot-middle", "--camera-height", 2.0, may_fail=True)
        if output is None:
            out[picture.stem] = None
            continue
        residual = re.search(r"([0-9.]+) px RMS", output)
        rows = re.findall(r"(?m)^full\s+\S+\s+(\d+)\s+\d+((?:\s+[0-9.]+)+)$",
                          tools.run("rectify", picture, "--venue", venue, "--out", tools.out / "rectified"))
        points = sum(int(n) for n, _ in rows)
        pooled = [math.sqrt(sum(int(n) * float(v.split()[k]) ** 2 for n, v in rows) / points) for k in (0, 4, 5)]
        out[picture.stem] = {"residual_px": float(residual[1]), "distorted_px": pooled[0], "straight_px": pooled[1],
                             "straight_mm": pooled[2]}
    return out


def learn_from_clicks(tools, venue, team, recipes, images, recipe, picture, radius):
    """Learns colors from the recipe's clicks in one picture."""
    clicks = tools.out / f"{recipe}-one-picture-clicks.json"
    all_clicks = json.loads((recipes / f"{recipe}-clicks.json").read_text())["samples"]
    clicks.write_text(json.dumps({"samples": [c for c in all_clicks if c["image"].endswith(picture)]}))
    return tools.colors("--venue", venue, "--samples", clicks, "--images", images, "--team", team, "--patch-radius", radius)


def light_from_border(tools, venue, picture, *options):
    """Measures the light on the border; returns whether that is possible."""
    return tools.run("calibrate", "light", "--venue", venue, "--surface", "border", "--picture", picture,
                     *options, may_fail=True) is not None


def mirosot_lamps(tools, pictures, recipes):
    """Uses colors learned under one lamp for all: without light map, with one from the picture's border, and adapted."""
    team = recipes / "mirosot-triangles-team.toml"
    learned = next(p for p in pictures if p.stem == MIROSOT_LEARNED)
    images = learned.parent.parent

    def colors(venue):
        learn_from_clicks(tools, venue, team, recipes, images, "mirosot-triangles", learned.name, 12)

    made = tools.out / "mirosot-triangles-venue.toml"
    # In RGB, because a lamp's tint is a factor per channel.
    even = copy_venue(made, tools.out / "mirosot-even-venue.toml")
    even.write_text(scenes.without_section(even.read_text(), "light").replace('space = "yuv"', 'space = "rgb"'))
    colors(even)
    mapped = copy_venue(even, tools.out / "mirosot-mapped-venue.toml")
    light_from_border(tools, mapped, learned)
    colors(mapped)
    out = {}
    for picture in pictures:
        venue = copy_venue(mapped, tools.out / "mirosot-lamp-venue.toml")
        measured = picture == learned or light_from_border(tools, venue, picture, "--keep-normal")
        cases = {"none": (even, False), "adapted": (even, True), "map": (venue, False), "map_adapted": (venue, True)}
        out[picture.stem] = {case: seen_in(tools, picture, file, team, f"mirosot-{case}", adapt)
                             for case, (file, adapt) in cases.items()}
        out[picture.stem]["map_measured"] = measured
    return out


def bars(tools, folder, recipes):
    """Uses colors learned in one exposure for the other one: unchanged and adapted."""
    out = {}
    for used, learned in (("dark", "normal"), ("normal", "dark")):
        team = recipes / f"vsss-bar-{used}-team.toml"
        own = tools.out / f"vsss-bar-{used}-venue.toml"
        foreign = copy_venue(own, tools.out / f"vsss-bar-{used}-foreign-venue.toml")
        with_colors_of(foreign, tools.out / f"vsss-bar-{learned}-venue.toml")
        pictures = sorted(folder.glob(f"{used}_*.png"))
        out[f"{learned} -> {used}"] = {
            case: [seen_in(tools, p, venue, team, f"bar-{case}", adapt) for p in pictures]
            for case, (venue, adapt) in {"own colors": (own, False), "foreign": (foreign, False),
                                         "foreign, adapted": (foreign, True)}.items()}
    return out


def parts(tools, folder, recipes):
    """Returns the measurements by name: functions without arguments."""
    pictures = scenes.pictures_of(folder / "mirosot-triangles")
    return {
        "overhead": lambda: stationary_spread(tools, folder / "vss-overhead.mp4", tools.out / "vss-overhead-venue.toml",
                                              recipes / "vss-overhead-team.toml", "vss-overhead", moving=("blue 0",)),
        "halves": lambda: stationary_spread(tools, folder / "vsss-halves", tools.out / "vsss-halves-venue.toml",
                                            recipes / "vsss-halves-team.toml", "vsss-halves"),
        "mirosot_fields": lambda: mirosot_fields(tools, pictures),
        "mirosot_lamps": lambda: mirosot_lamps(tools, pictures, recipes),
        "bars": lambda: bars(tools, folder / "vsss-bar", recipes),
    }


def print_stationary(title, rows):
    print(f"\n{title}: RMS deviation from the mean")
    for row in rows:
        pixels = "" if row["px"] is None else f"{row['px']:.3f} px, "
        turn = f", {row['degrees']:.3f} degrees" if row["name"] != "ball" else ""
        print(f"  {row['name']:<12} {row['frames']:>4} of {row['of']}: {pixels}{row['mm']:.3f} mm{turn}")


def print_fields(rows):
    print("\nmirosot-triangles: field found without clicks; deviation of the border from straight lines")
    for name, row in rows.items():
        print(f"  {name:<10} " + ("refused" if row is None else (
            f"residual {row['residual_px']:.2f} px; border {row['distorted_px']:.2f} px in the picture, rectified "
            f"{row['straight_px']:.2f} px, {row['straight_mm']:.2f} mm")))


def print_lamps(rows):
    print(f"\nmirosot-triangles: colors learned only in {MIROSOT_LEARNED}; ids of {MIROSOT_ROBOTS} (reported twice), robots "
          "seen, ball")
    cases = [case for case in next(iter(rows.values())) if case != "map_measured"]
    print(f"  {'':<10}" + "".join(f"{case:>22}" for case in cases))

    def text(one):
        return f"{one['ids']} ({one['doubled']}), {one['robots']}, {'ball' if one['ball'] else 'no ball'}"
    for name, row in rows.items():
        print(f"  {name:<10}" + "".join(f"{text(row[case]):>22}" for case in cases) + (
            "" if row["map_measured"] else "   without its own map: uses the map of the learned picture"))
    totals = {case: sum(r[case]["ids"] for r in rows.values()) for case in cases}
    whole = MIROSOT_ROBOTS * len(rows)
    print(f"  {'ids':<10}" + "".join(f"{100 * totals[case] / whole:>20.1f} %" for case in cases))


def print_bars(rows):
    print("\nvsss-bar: colors of one exposure used in the other; ids (reported twice), robots, balls")
    for name, row in rows.items():
        for case, seen in row.items():
            robots, balls = BAR_COUNTS[name.split()[-1]]
            print(f"  {name:<16} {case:<18} {sum(s['ids'] for s in seen)} ({sum(s['doubled'] for s in seen)}), "
                  f"{sum(s['robots'] for s in seen)} of {robots}, {sum(s['ball'] for s in seen)} of {balls}")


def print_tables(results):
    """Prints what was measured."""
    printers = {"overhead": lambda rows: print_stationary("vss-overhead.mp4, stationary robots and balls", rows),
                "halves": lambda rows: print_stationary("vsss-halves, one stationary scene", rows),
                "mirosot_fields": print_fields, "mirosot_lamps": print_lamps, "bars": print_bars}
    for name, rows in results.items():
        printers[name](rows)
