"""Compares sightings and tracks with the truth, robot by robot: right, unknown, wrong, missed, ghost."""
import math

COUNTS = ("robots", "right", "unknown", "wrong", "missed", "ghosts", "balls", "balls_seen", "ball_ghosts")


def mean(points):
    return tuple(sum(p[k] for p in points) / len(points) for k in (0, 1))


def pixel_center(sighting):
    """The middle between the team patch and the mean of the identification patches."""
    team = [(p["u"], p["v"]) for p in sighting["patches"] if p["role"] == "team"]
    others = [(p["u"], p["v"]) for p in sighting["patches"] if p["role"] != "team"]
    return mean([mean(part) for part in (team, others) if part])


def field_place(seen):
    return seen["x"], seen["y"]


def judge(truth, seen, place, reach, ball_reach):
    """Returns the verdicts of one picture.

    `truth`: robots with team, id (None: not in the team file), at and optionally counted (False: may be seen or not), and
    ball, a point or None. `seen`: the sightings or tracks of one line of the replay. `place`: position of a robot in the
    unit of the truth; `reach` and `ball_reach`: largest distances of a report. An unknown id is right for a robot that is
    not in the team file.
    """
    pairs = sorted((math.dist(robot["at"], place(report)), i, j) for i, robot in enumerate(truth["robots"])
                   for j, report in enumerate(seen["robots"]))
    of_truth, of_report = {}, {}
    for distance, i, j in pairs:
        if distance <= reach and i not in of_truth and j not in of_report:
            of_truth[i], of_report[j] = j, i
    verdicts = []
    for i, robot in enumerate(truth["robots"]):
        if not robot.get("counted", True):
            continue
        report = seen["robots"][of_truth[i]] if i in of_truth else None
        if report is None:
            verdict = "missed"
        elif report["id"] is None:
            verdict = "right" if robot["id"] is None and report["team"] == robot["team"] else "unknown"
        else:
            verdict = "right" if (report["team"], report["id"]) == (robot["team"], robot["id"]) else "wrong"
        verdicts.append({"verdict": verdict, "truth": robot, "report": report})
    ghosts = [{"verdict": "ghost", "truth": None, "report": r} for j, r in enumerate(seen["robots"]) if j not in of_report]
    ball = seen["ball"]
    at = truth["ball"]
    ball_place = None if ball is None else (ball["u"], ball["v"]) if place is pixel_center else (ball["x"], ball["y"])
    ball_right = None if ball is None else at is not None and math.dist(at, ball_place) <= ball_reach
    return {"robots": verdicts + ghosts, "ball": ball, "ball_truth": at, "ball_right": ball_right}


def add_up(judged):
    """Returns the counts of several pictures."""
    total = dict.fromkeys(COUNTS, 0)
    for picture in judged:
        for one in picture["robots"]:
            if one["verdict"] == "ghost":
                total["ghosts"] += 1
            else:
                total["robots"] += 1
                total[one["verdict"]] += 1
        if picture["ball_truth"] is not None:
            total["balls"] += 1
            total["balls_seen"] += picture["ball_right"] is True
        total["ball_ghosts"] += picture["ball_right"] is False
    return total


class Reliability:
    """How often reports of a confidence are right, in bins of a tenth."""

    def __init__(self):
        self.bins = {}

    def add(self, kind, confidence, right):
        if confidence is None:
            return
        low = min(9, int(10 * confidence))
        count, sum_of, hits = self.bins.get((kind, low), (0, 0.0, 0))
        self.bins[kind, low] = (count + 1, sum_of + confidence, hits + bool(right))

    def add_judged(self, judged, source="sightings"):
        for picture in judged:
            for one in picture["robots"]:
                report = one["report"]
                if report is None:
                    continue
                # Without an id, the confidence is that of the team at this place.
                named = report["id"] is not None
                right = one["verdict"] == "right" or (not named and one["truth"] is not None
                                                      and report["team"] == one["truth"]["team"])
                self.add(f"{source} with id" if named else f"{source} without id", report.get("confidence"), right)
            if picture["ball"] is not None:
                self.add(f"{source}, ball", picture["ball"].get("confidence"), picture["ball_right"])

    def rows(self):
        return [{"kind": kind, "from": low / 10, "reports": count, "mean": total / count, "right": hits / count}
                for (kind, low), (count, total, hits) in sorted(self.bins.items())]
