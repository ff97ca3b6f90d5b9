"""Truth of the real pictures, read by eye: tests/footage/*-truth.json."""
import json
import tomllib


def ids_by_colors(team_file):
    """Returns the ids of a team file: {(team, "colors"): id}."""
    team = tomllib.loads(team_file.read_text())
    return {(team[side]["color"], " ".join(robot["colors"])): robot["id"] for side in ("own", "opponent")
            for robot in team.get(side, {}).get("robot", [])}


def pictures(path, team_file):
    """Returns {file name: {"ball", "robots"}} of a set of pictures."""
    ids = ids_by_colors(team_file)
    return {name: {"ball": one["ball"], "robots": [
        {"team": team, "id": ids.get((team, colors)), "colors": colors, "at": (u, v)} for team, colors, u, v in one["robots"]]}
        for name, one in json.loads(path.read_text())["pictures"].items()}


def place_at(keys, frame):
    """Interpolates the position of a robot between its keys (frame, u, v)."""
    before = max((k for k in keys if k[0] <= frame), default=keys[0])
    after = min((k for k in keys if k[0] >= frame), default=keys[-1])
    part = 0 if after[0] <= before[0] else (frame - before[0]) / (after[0] - before[0])
    return tuple(a + part * (b - a) for a, b in zip(before[1:], after[1:]))


def frames(path, team_file):
    """Returns {frame number: {"ball", "robots"}} of a video. Hidden robots do not count."""
    ids = ids_by_colors(team_file)
    video = json.loads(path.read_text())
    out = {}
    for frame in range(video["frames"]):
        robots = []
        for robot in video["robots"]:
            hidden = any(first <= frame <= last for first, last in robot.get("hidden", ()))
            robots.append({"team": robot["team"], "id": ids.get((robot["team"], robot["colors"])), "colors": robot["colors"],
                           "at": place_at(robot["at"], frame), "counted": robot.get("counted", True) and not hidden})
        out[frame] = {"ball": video["ball"], "robots": robots}
    return out
