"""The page of annotated pictures: what was right, unknown or wrong, drawn over each picture."""
import html as text
import math
import struct

import judging
import table

STYLE = """
:root { color-scheme: light dark; --ground: #fafaf8; --ink: #1c1d1f; --soft: #60646b; --line: #d8d9d6; --card: #fff; --bad: #b3261e; }
@media (prefers-color-scheme: dark) {
  :root { --ground: #16181b; --ink: #e6e7e9; --soft: #9aa0a8; --line: #33373d; --card: #1e2125; --bad: #ff8a80; } }
body { margin: 0 auto; padding: 1.5rem; max-width: 110rem; background: var(--ground); color: var(--ink);
       font: 15px/1.45 system-ui, sans-serif; }
h1 { font-size: 1.5rem; margin: 0 0 .5rem; } h2 { font-size: 1.15rem; margin: 2rem 0 .3rem; }
p { margin: .3rem 0; color: var(--soft); }
.legend span { margin-right: 1.2rem; white-space: nowrap; }
.legend i { display: inline-block; width: .8rem; height: .8rem; border: 3px solid; border-radius: 50%; vertical-align: -.15rem;
            margin-right: .35rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums; }
th, td { text-align: right; padding: .15rem .6rem; border-bottom: 1px solid var(--line); white-space: nowrap; }
th:last-child, td:last-child { white-space: normal; }
th { color: var(--soft); font-weight: 600; position: sticky; top: 0; background: var(--ground); }
th:nth-child(-n+2), td:nth-child(-n+2) { text-align: left; }
td.bad { color: var(--bad); font-weight: 600; }
td.reason { text-align: left; white-space: normal; }
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 30rem), 1fr)); gap: 1rem; }
figure { margin: 0; background: var(--card); border: 1px solid var(--line); border-radius: 6px; overflow: hidden; }
figure svg { display: block; width: 100%; height: auto; background: #000; }
figcaption { padding: .35rem .6rem; font-size: 13px; }
figcaption b { font-weight: 600; }
"""
COLORS = {"right": "#35e05f", "unknown": "#ffd21f", "wrong": "#ff3b30", "ghost": "#ff3b30", "missed": "#ff9df0"}
LEGEND = (("right", "right"), ("unknown", "seen, id unknown"), ("wrong", "wrong id, or nothing there (dashed)"),
          ("missed", "missed (dotted)"))


def size_of(path):
    """Width and height of a PNG or JPEG file."""
    data = path.read_bytes()
    if data[:8] == b"\x89PNG\r\n\x1a\n":
        return struct.unpack(">II", data[16:24])
    place = 2
    while place + 9 < len(data):
        marker, length = data[place + 1], struct.unpack(">H", data[place + 2:place + 4])[0]
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):
            height, width = struct.unpack(">HH", data[place + 5:place + 9])
            return width, height
        place += 2 + length
    return 640, 480


def entry(name, case, file, image, judged, radius, truth):
    """What the page needs of a judged picture; positions in pixels."""
    robots = []
    for one in judged["robots"]:
        report, expected = one["report"], one["truth"]
        shown = {"verdict": one["verdict"]}
        if report is not None:
            shown["at"] = judging.pixel_center(report)
            team = [(p["u"], p["v"]) for p in report["patches"] if p["role"] == "team"]
            shown["team"] = judging.mean(team) if team else None
            shown["label"] = f"{report['team'][0]}{'?' if report['id'] is None else report['id']}"
        else:
            shown["at"], shown["label"] = expected.get("px", expected["at"]), ""
        if expected is not None and one["verdict"] in ("wrong", "missed"):
            shown["expected"] = f"{expected['team'][0]}{'?' if expected['id'] is None else expected['id']}"
        robots.append(shown)
    ball = judged["ball"]
    return {"set": name, "case": case, "file": file, "image": image, "radius": radius, "robots": robots,
            "ball": None if ball is None else {"at": (ball["u"], ball["v"]), "right": judged["ball_right"]},
            "ball_truth": truth.get("ball_px", truth["ball"])}


def circle(at, radius, color, extra=""):
    return f'<circle cx="{at[0] + 0.5:.1f}" cy="{at[1] + 0.5:.1f}" r="{radius:.1f}" stroke="{color}"{extra}/>'


def label(at, words, color):
    return (f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" fill="{color}" stroke="#000" stroke-width="2" '
            f'paint-order="stroke">{text.escape(words)}</text>')


def drawing(one, size):
    marks = []
    radius = one["radius"]
    for robot in one["robots"]:
        color = COLORS[robot["verdict"]]
        extra = {"ghost": ' stroke-dasharray="5 4"', "missed": ' stroke-dasharray="1.5 4"'}.get(robot["verdict"], "")
        marks.append(circle(robot["at"], radius, color, extra))
        if robot.get("team") and math.dist(robot["team"], robot["at"]) > 1:
            part = radius / math.dist(robot["team"], robot["at"])
            tip = [a + part * (t - a) for a, t in zip(robot["at"], robot["team"])]
            marks.append(f'<path d="M{robot["team"][0]:.1f} {robot["team"][1]:.1f}L{tip[0]:.1f} {tip[1]:.1f}" stroke="{color}"/>')
        words = robot["label"] + (f" is {robot['expected']}" if robot["label"] and "expected" in robot else
                                  robot.get("expected", ""))
        marks.append(label((robot["at"][0] + radius + 2, robot["at"][1] + 4), words, color))
    if one["ball"]:
        marks.append(circle(one["ball"]["at"], radius * 0.55, "#ffffff" if one["ball"]["right"] else COLORS["wrong"]))
    if one["ball_truth"] and not (one["ball"] and one["ball"]["right"]):
        marks.append(circle(one["ball_truth"], radius * 0.55, COLORS["missed"], ' stroke-dasharray="1.5 4"'))
    return (f'<svg viewBox="0 0 {size[0]} {size[1]}" role="img"><image href="{one["image"]}" width="{size[0]}" '
            f'height="{size[1]}"/><g fill="none" stroke-width="2" font-family="sans-serif" font-size="12">'
            + "".join(marks) + "</g></svg>")


def figure(one, size):
    counts = {}
    for robot in one["robots"]:
        counts[robot["verdict"]] = counts.get(robot["verdict"], 0) + 1
    ball = "no ball" if one["ball_truth"] is None and one["ball"] is None else (
        "ball right" if one["ball"] and one["ball"]["right"] else "ball wrong" if one["ball"] else "ball missed")
    words = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
    return (f"<figure>{drawing(one, size)}<figcaption><b>{text.escape(one['file'])}</b> {text.escape(one['case'])}: "
            f"{text.escape(words)}, {ball}</figcaption></figure>")


def table_of(rows, base):
    head = "".join(f"<th>{text.escape(name)}</th>" for name, _ in table.COLUMNS)
    out = []
    for row in rows:
        values = table.cells(row, base)
        if "failed" in row:
            out.append(f"<tr><td>{text.escape(values[0])}</td><td>{text.escape(values[1])}</td><td class='reason bad' colspan='8'>"
                       f"{text.escape(values[2])}</td><td>{text.escape(values[3])}</td></tr>")
            continue
        marked = "".join(f"<td{' class=bad' if v.endswith('!') else ''}>{text.escape(v)}</td>" for v in values)
        out.append(f"<tr>{marked}</tr>")
    return f"<div class='wide'><table><tr>{head}</tr>{''.join(out)}</table></div>"


def html(pictures, rows, base, folder):
    """Returns the page. The pictures lie beside it, in `folder`."""
    legend = "".join(f'<span><i style="border-color:{COLORS[key]}"></i>{name}</span>' for key, name in LEGEND)
    parts = [f"<!doctype html><html lang='en'><meta charset='utf-8'><meta name='viewport' content='width=device-width'>"
             f"<title>Touchline: evaluation</title><style>{STYLE}</style><h1>Evaluation</h1>"
             f"<p class='legend'>{legend}<span><i style='border-color:#888'></i>ball: white</span></p>"
             "<p>The short line points from a robot's middle through its team patch. Labels: first letter of the team and id.</p>",
             table_of(rows, base)]
    last = None
    for one in pictures:
        if one["set"] != last:
            parts.append(("</div>" if last else "") + f"<h2>{text.escape(one['set'])}</h2><div class='pictures'>")
            last = one["set"]
        parts.append(figure(one, size_of(folder / one["image"])))
    return "\n".join(parts) + ("</div>" if last else "") + "</html>\n"
