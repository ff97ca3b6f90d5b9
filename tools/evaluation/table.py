"""The table of all measurements: goals, values of an earlier evaluation beside them, one line per case."""
import json
import math
import re

# Columns: heading, width.
COLUMNS = (("set", 19), ("case", 43), ("robots", 7), ("right %", 9), ("unknown", 8), ("wrong", 12), ("missed", 7),
           ("ghosts", 7), ("ball %", 8), ("halves %", 14), ("before: right, wrong, ball", 0))
# Longest reason of a failure in the table, in characters; evaluation.json has it complete.
REASON = 150


def key_of(row):
    return f"{row['set']}: {row['case']}"


def share(row, part, whole):
    return 100 * row[part] / row[whole] if row.get(whole) else None


def missed_goals(row):
    """Returns the names of the goals that the row does not reach."""
    goal, out = row.get("goal", {}), []
    if "failed" in row:
        return ["failed"] if goal else []
    if "value" in row:
        low, high = goal.get("value", (-math.inf, math.inf))
        return [] if row["value"] is None or low - 1e-9 <= row["value"] <= high + 1e-9 else ["value"]
    for name, value in (("right", share(row, "right", "robots")), ("ball", share(row, "balls_seen", "balls"))):
        if name in goal and value is not None and value < goal[name] - 1e-9:
            out.append(name)
    if "wrong" in goal and row["wrong"] + row.get("wrong_earlier", 0) > goal["wrong"]:
        out.append("wrong")
    if row.get("false", 0) > goal.get("false", math.inf):
        out.append("false")
    if row.get("worse_than_off"):
        out.append("worse than off")
    return out


def reason_of(row):
    """The reason of a failure in one line, without the command."""
    lines = [re.sub(r"^touchline-\w+: |[:;]$", "", line.strip()) for line in row["failed"].strip().splitlines()]
    words = "; ".join(lines[1:] or lines)
    return words if len(words) <= REASON else words[:REASON - 3] + "..."


def number(value):
    return "-" if value is None else f"{value:.1f}"


def measured(value):
    return "-" if value is None else f"{value:.2f}"


def measured_cells(row, base):
    goal, old = row.get("goal", {}).get("value"), base.get(key_of(row), {}).get("value")
    words = []
    if goal is not None:
        words.append(f"goal: at most {goal[1]:g}" if goal[0] == 0 else f"goal: {goal[0]:g} to {goal[1]:g}")
    if old is not None:
        words.append(f"before: {measured(old)}")
    return [row["set"], row["case"], str(row["count"]), measured(row["value"]) + (" !" if missed_goals(row) else ""), "", "", "",
            "", "", " / ".join(measured(one) for one in row["each"]), ", ".join(words)]


def cells(row, base):
    if "value" in row:
        return measured_cells(row, base)
    missed = missed_goals(row)

    def mark(name):
        return " !" if name in missed else ""
    before = ""
    old = base.get(key_of(row))
    if old is not None:
        before = old["failed"] if "failed" in old else (
            f"{number(old['right'])}, {old['wrong']}, {number(old['ball'])}")
    if "failed" in row:
        return [row["set"], row["case"], "failed: " + reason_of(row) + mark("failed"), before]
    earlier = f" ({row['wrong_earlier']})" if row.get("wrong_earlier") else ""
    halves = " / ".join(number(h) for h in row["halves"]) if "halves" in row else ""
    return [row["set"], row["case"], str(row["robots"]), number(share(row, "right", "robots")) + mark("right"),
            str(row["unknown"]), f"{row['wrong']}{earlier}" + mark("wrong"), str(row["missed"]),
            str(row["ghosts"] + row["ball_ghosts"]) + mark("false"), number(share(row, "balls_seen", "balls")) + mark("ball"), halves,
            "  ".join(filter(None, [before, "adaptation is worse than off !" if row.get("worse_than_off") else "",
                                    row.get("note", "")]))]


def text_of(row, base):
    values = cells(row, base)
    if "value" in row:
        name, case, count, value, *_, each, words = values
        return f"{name:<{COLUMNS[0][1]}}{case:<{COLUMNS[1][1]}}{count:>7}{value:>9}  {each:<30}  {words}".rstrip()
    if "failed" in row:
        name, case, reason, before = values
        return f"{name:<{COLUMNS[0][1]}}{case:<{COLUMNS[1][1]}}{reason}" + (f"  [before: {before}]" if before else "")
    out = ""
    for (_, width), value in zip(COLUMNS, values):
        out += f"{value:<{width}}" if width > 14 or not width else f"{value:>{width}}"
        out += "  " if width == 14 else ""
    return out.rstrip()


def heading():
    out = ""
    for name, width in COLUMNS:
        out += f"{name:<{width}}" if width > 14 or not width else f"{name:>{width}}"
        out += "  " if width == 14 else ""
    return out.rstrip()


def print_rows(rows, base):
    print("robots: right, unknown, wrong and missed ids; wrong in brackets: reports in the frames of the first second; !: goal "
          "not reached")
    print(heading())
    last = None
    for row in rows:
        if last is not None and row["set"] != last:
            print()
            if "value" in row:
                print(f"{'':<{COLUMNS[0][1] + COLUMNS[1][1]}}{'samples':>7}{'all':>9}  in each game")
        last = row["set"]
        print(text_of(row, base))
    goals = [row for row in rows if row.get("goal")]
    failed = sum("failed" in row for row in rows)
    print(f"\n{len(goals) - sum(bool(missed_goals(r)) for r in goals)} of {len(goals)} cases reach their goals"
          + (f"; {failed} could not be measured, see above" if failed else ""))


def print_reliability(rows):
    print("\nreliability: how often reports of a confidence are right, over all sets with truth")
    if not rows:
        print("  the results contain no confidence")
        return
    print(f"  {'':<24}{'confidence':>12}{'reports':>10}{'mean':>8}{'right':>8}")
    for row in rows:
        print(f"  {row['kind']:<24}{row['from']:>8.1f} -{row['from'] + 0.1:4.1f}{row['reports']:>9}{row['mean']:>8.3f}"
              f"{row['right']:>8.3f}")


def summary(rows):
    """The values of an evaluation in short, for --base."""
    return {key_of(row): {"failed": "failed"} if "failed" in row else {"value": row["value"]} if "value" in row else {
        "right": share(row, "right", "robots"), "wrong": row["wrong"] + row.get("wrong_earlier", 0),
        "ball": share(row, "balls_seen", "balls")} for row in rows}


def read_base(path):
    """Reads a file of summary(), or an evaluation.json."""
    if path is None or not path.exists():
        return {}
    values = json.loads(path.read_text())
    return summary(values["rows"]) if "rows" in values else values
