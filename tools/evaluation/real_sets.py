"""Real pictures with truth: colors from one or two of them, or from a recipe's clicks, judged in all others.

A set of pictures is split in two halves, every second picture in sorted order; a video in its first and its second half.
"""
import json
import re
import shutil

import footage
import judging
import programs
import truth

# A wrong id is the worst result. The ball's goal is for sets that show one.
IDS = {"right": 95.0, "wrong": 0}
SETS = {
    # name: recipe in tests/footage, truth, pictures, reach of a robot in px (half its side), radius of its circle,
    # pictures to learn from (None: the first with all robots and the ball), radius of a patch for clicks
    "mirosot-triangles": ("mirosot-triangles", "mirosot-triangles", "mirosot-triangles/*.png", 11, 15, ["r0.png"], 12),
    "vsss-bar-normal": ("vsss-bar-normal", "vsss-bar", "vsss-bar/normal_*.png", 14, 19, None, 16),
    "vsss-bar-dark": ("vsss-bar-dark", "vsss-bar", "vsss-bar/dark_*.png", 11, 15, None, 12),
    "vsss-halves": ("vsss-halves", "vsss-halves", "vsss-halves/*.jpg", 14, 20, None, 20),
}
VIDEOS = {
    # name: reach in px, radius of a circle, frames to learn from
    "vss-overhead": (12, 17, (0, 100)),
    "pushed-robots": (25, 17, (0, 48)),
}
BALL_REACH = 8
REFUSED = "self-check refuses the colors"


def field_only(made, venue):
    """Copies a venue file without its light map and colors."""
    parts = re.split(r"(?m)^(?=\[)", made.read_text())
    venue.write_text("".join(p for p in parts if not p.startswith(("[light]", "[colors]", "[[color"))))
    return venue


def fullest(truths):
    """Names of the pictures with the most robots and a ball, in sorted order."""
    most = max(len(t["robots"]) for t in truths.values())
    return [name for name, t in sorted(truths.items()) if len(t["robots"]) == most and t["ball"] is not None]


def learn(tools, venue, team, pictures):
    """Colors without a click; returns whether the self-check accepts them."""
    options = [option for p in pictures for option in ("--picture", p)]
    return tools.colors("--venue", venue, "--team", team, *options, "--yes")


def turns(names, calibrate, judge):
    """Uses each picture, or each group of them, in turn as the only one that the colors are from.

    `calibrate`: of a name, returns the reason of a refusal or None. `judge`: of a name, returns the verdicts in all other
    pictures. Returns the row of all accepted calibrations, whose note counts them, and the details of each.
    """
    judged, details = [], {}
    for name in names:
        refused = calibrate(name)
        if refused is None:
            here = judge(name)
            judged += here
            details[name] = judging.add_up(here)
        else:
            details[name] = {"refused": refused}
    accepted = [name for name in names if "refused" not in details[name]]
    refusals = ", ".join(name.split(".")[0] for name in names if name not in accepted)
    note = f"{len(accepted)} of {len(names)} accepted" + (f", refused: {refusals}" if refusals else "")
    return judging.add_up(judged) | {"note": note}, details


def with_halves(parts, goal):
    """Returns the row of two halves of judged pictures, and its goal."""
    row = judging.add_up([one for part in parts for one in part])
    sums = [judging.add_up(part) for part in parts]
    row["halves"] = [100 * s["right"] / s["robots"] if s["robots"] else None for s in sums]
    return row, goal if row["balls"] == 0 or goal is None else {**goal, "ball": 98.0}


class PictureSet:
    def __init__(self, tools, report, folder, recipes, name):
        recipe, of, pattern, self.reach, self.radius, learned, self.patch = SETS[name]
        self.tools, self.report, self.folder, self.recipes, self.name, self.recipe = (tools, report, folder, recipes, name,
                                                                                     recipe)
        self.team = recipes / f"{recipe}-team.toml"
        self.made = tools.out / f"{recipe}-venue.toml"
        self.pictures = sorted(folder.glob(pattern))
        if not self.pictures:
            raise programs.Failed(f"no pictures {folder / pattern}")
        truths = truth.pictures(recipes / f"{of}-truth.json", self.team)
        self.truths = {p.name: truths[p.name] for p in self.pictures}
        self.learned = learned or fullest(self.truths)[:2]

    def judge(self, name, line):
        return judging.judge(self.truths[name], line["sightings"], judging.pixel_center, self.reach, BALL_REACH)

    def measure(self, case, venue_of, left_out, second=False, goal=None, shown=False, options=()):
        """Judges all pictures except those that the colors are from. `venue_of`: the venue file of a picture."""
        parts, earlier = ([], []), 0
        for i, picture in enumerate(self.pictures):
            if picture.name in left_out:
                continue
            venue = venue_of(picture)
            if second:
                lines = self.tools.replay_standing(picture, venue, self.team, f"{self.name}-standing", *options)
                earlier += judging.add_up([self.judge(picture.name, line) for line in lines[:-1]])["wrong"]
            else:
                _, lines = self.tools.replay(picture, venue, self.team, f"{self.name}-single", *options)
            judged = self.judge(picture.name, lines[-1])
            parts[i % 2].append(judged)
            if shown:
                self.report.picture(self.name, case, picture, judged, self.radius, self.truths[picture.name])
        row, goal = with_halves(parts, goal)
        self.report.reliability.add_judged([one for part in parts for one in part])
        self.report.add(self.name, case, row | {"wrong_earlier": earlier}, goal or {})

    def both(self, case, venue, left_out, goal, shown, accepted=True):
        """Single pictures, and the same after one second."""
        self.measure(case, lambda _: venue, left_out, goal=goal)
        if not accepted:
            self.report.note(REFUSED)
        self.measure(f"{case}, after 1 s", lambda _: venue, left_out, second=True, goal=goal, shown=shown)

    def unclicked(self, count):
        """Colors from the first pictures without a click."""
        def run():
            venue = field_only(self.made, self.tools.out / f"{self.name}-unclicked-{count}-venue.toml")
            names = self.learned[:count]
            accepted = learn(self.tools, venue, self.team, [p for p in self.pictures if p.name in names])
            self.both(case, venue, names, IDS, count == 1, accepted)
        case = f"no clicks, {' and '.join(n.split('.')[0] for n in self.learned[:count])}"
        self.report.attempt(self.name, case, IDS, run)

    def each_in_turn(self, count):
        """Colors from each picture, or from each two successive ones (`count` 2), without a click.

        Refused ones are judged by their advice only, which is in the details.
        """
        def run():
            venue = self.tools.out / f"{self.name}-each-venue.toml"
            names = [p.stem for p in self.pictures]
            groups = {" and ".join(names[i:i + count]): self.pictures[i:i + count] for i in range(len(names) - count + 1)}

            def calibrate(group):
                field_only(self.made, venue)
                return self.tools.unclicked_colors(venue, self.team, groups[group])

            def judge(group):
                judged = []
                for other in self.pictures:
                    if other not in groups[group]:
                        _, lines = self.tools.replay(other, venue, self.team, f"{self.name}-each")
                        judged.append(self.judge(other.name, lines[-1]))
                return judged
            row, details = turns(list(groups), calibrate, judge)
            self.report.add(self.name, case, row, {"wrong": 0})
            self.report.details.setdefault(of, {})[self.name] = details
        of = "each picture" if count == 1 else "each two successive pictures"
        case = f"no clicks, {of} in turn"
        self.report.attempt(self.name, case, {"wrong": 0}, run)

    def clicked(self):
        """Colors from the recipe's clicks."""
        def run():
            clicks = json.loads((self.recipes / f"{self.recipe}-clicks.json").read_text())["samples"]
            self.both("recipe's clicks", self.made, {c["image"].split("/")[-1] for c in clicks}, None,
                      not self.report.shows(self.name))
        self.report.attempt(self.name, "recipe's clicks", {}, run)

    def clicked_once(self):
        """Colors from clicks in the first picture; with `border`, a light map from the border of each picture."""
        def run():
            venue = field_only(self.made, self.tools.out / f"{self.name}-clicked-venue.toml")
            footage.learn_from_clicks(self.tools, venue, self.team, self.recipes, self.folder, self.recipe, self.learned[0],
                                      self.patch)
            self.both(case, venue, self.learned[:1], IDS, False)
        case = f"clicks in {self.learned[0].split('.')[0]}"
        self.report.attempt(self.name, case, IDS, run)

    def border_light(self):
        """As clicked_once(), with a light map from the border of each picture."""
        def run():
            learned = next(p for p in self.pictures if p.name == self.learned[0])
            mapped = field_only(self.made, self.tools.out / f"{self.name}-border-venue.toml")
            footage.light_from_border(self.tools, mapped, learned)
            footage.learn_from_clicks(self.tools, mapped, self.team, self.recipes, self.folder, self.recipe, learned.name,
                                      self.patch)

            def venue_of(picture):
                venue = footage.copy_venue(mapped, self.tools.out / f"{self.name}-border-of-venue.toml")
                footage.light_from_border(self.tools, venue, picture, "--keep-normal")
                return venue
            self.measure(case, venue_of, self.learned[:1], second=True, goal=IDS)
        case = f"clicks in {self.learned[0].split('.')[0]}, border light, after 1 s"
        self.report.attempt(self.name, case, IDS, run)

    def run(self, quick):
        if quick:
            step = max(1, len(self.pictures) // 4)
            self.pictures = [p for i, p in enumerate(self.pictures) if i % step == 0 or p.name in self.learned]
        self.unclicked(1)
        if len(self.learned) > 1 and not quick:
            self.unclicked(2)
        if not quick:
            self.each_in_turn(1)
            self.each_in_turn(2)
        if self.name == "mirosot-triangles":
            self.clicked_once()
            if not quick:
                self.border_light()
        else:
            self.clicked()


def affine_of(lines):
    """Returns the map of field positions to pixels that fits all sightings best (least squares)."""
    sums = [[0.0] * 5 for _ in range(3)]
    for line in lines:
        for robot in line["sightings"]["robots"]:
            u, v = judging.pixel_center(robot)
            basis = (robot["x"], robot["y"], 1.0)
            for i in range(3):
                for j, value in enumerate((*basis, u, v)):
                    sums[i][j] += basis[i] * value
    # Gauss-Jordan without pivots: the matrix is positive definite.
    for i in range(3):
        if abs(sums[i][i]) < 1e-12:
            return None
        sums[i] = [value / sums[i][i] for value in sums[i]]
        for k in range(3):
            if k != i:
                sums[k] = [a - sums[k][i] * b for a, b in zip(sums[k], sums[i])]
    return lambda x, y: tuple(sums[0][j] * x + sums[1][j] * y + sums[2][j] for j in (3, 4))


class Video:
    def __init__(self, tools, report, folder, recipes, name):
        self.reach, self.radius, self.learned = VIDEOS[name]
        self.tools, self.report, self.name = tools, report, name
        self.recipes, self.video = recipes, folder / f"{name}.mp4"
        self.team = recipes / f"{name}-team.toml"
        self.made = tools.out / f"{name}-venue.toml"
        self.truths = truth.frames(recipes / f"{name}-truth.json", self.team)

    def frame(self, number):
        """The picture of a frame."""
        folder = self.tools.out / f"{self.name}-frames"
        if not folder.is_dir():
            step = self.learned[1]
            self.tools.run("relight", self.video, "--every", step, "--out", folder)
        return folder / f"{number:06d}.png"

    def judged(self, lines):
        """Returns the verdicts in sightings and in tracks."""
        to_pixels = affine_of(lines)

        def track_place(robot):
            return to_pixels(robot["x"], robot["y"])
        sightings, tracks = [], []
        for line in lines:
            one = self.truths[line["frame"]]
            sightings.append(judging.judge(one, line["sightings"], judging.pixel_center, self.reach, BALL_REACH))
            if to_pixels is not None:
                of_tracks = judging.judge({**one, "ball": None}, {**line["tracks"], "ball": None}, track_place, self.reach, 0)
                tracks.append(of_tracks)
        return sightings, tracks

    def measure(self, case, venue, goal, shown):
        _, lines = self.tools.replay(self.video, venue, self.team, f"{self.name}-video")
        sightings, tracks = self.judged(lines)
        for source, judged in (("sightings", sightings), ("tracks", tracks)):
            if not judged:
                raise programs.Failed("no robot in any frame")
            self.report.reliability.add_judged(judged, source)
            middle = len(judged) // 2
            row, wanted = with_halves((judged[:middle], judged[middle:]), goal)
            if wanted and source == "tracks" and self.name == "pushed-robots":
                wanted = {**wanted, "right": 99.0}
            self.report.add(self.name, f"{case}, {source}", row, wanted or {})
            if self.name == "pushed-robots":
                self.each_robot(f"{case}, {source}", judged, wanted)
        if shown:
            for number in sorted(int(p.stem) for p in self.frame(0).parent.glob("*.png")):
                self.report.picture(self.name, f"{case}, sightings", self.frame(number), sightings[number], self.radius,
                                    self.truths[number])

    def each_robot(self, case, judged, goal):
        """One row for each robot, because the goal is for each."""
        names = sorted({r["truth"]["colors"] for one in judged for r in one["robots"] if r["truth"]})
        for name in names:
            of_robot = [{"robots": [r for r in one["robots"] if r["truth"] and r["truth"]["colors"] == name],
                         "ball": None, "ball_truth": None, "ball_right": None} for one in judged]
            middle = len(of_robot) // 2
            row, wanted = with_halves((of_robot[:middle], of_robot[middle:]), goal)
            self.report.add(self.name, f"{case}: {name}", row, wanted or {})

    def unclicked(self, count):
        def run():
            venue = field_only(self.made, self.tools.out / f"{self.name}-unclicked-{count}-venue.toml")
            accepted = learn(self.tools, venue, self.team, [self.frame(n) for n in self.learned[:count]])
            self.measure(case, venue, IDS, count == 1)
            if not accepted:
                self.report.note(REFUSED)
        case = f"no clicks, frame {' and '.join(map(str, self.learned[:count]))}"
        self.report.attempt(self.name, case, IDS, run)

    def run(self, quick):
        self.unclicked(1)
        if not quick:
            self.unclicked(2)
        self.report.attempt(self.name, "recipe's clicks", {}, lambda: self.measure(
            "recipe's clicks", self.made, None, not self.report.shows(self.name)))


def names():
    return [*SETS, *VIDEOS]


def evaluate(tools, report, folder, recipes, name, quick):
    kind = PictureSet if name in SETS else Video
    shutil.rmtree(tools.out / f"{name}-frames", ignore_errors=True)
    kind(tools, report, folder, recipes, name).run(quick)
