#!/usr/bin/env python3
"""Judges the guest's output: check.py console.log. Prints a line for each check; exit code 1 if one fails."""
import re
import sys


def parts_of(text):
    """The output after each "== name"."""
    pieces = re.split(r"^== (.*)$", text.replace("\r", ""), flags=re.MULTILINE)
    return dict(zip(pieces[1::2], pieces[2::2]))


def took(part):
    """Milliseconds that each source took in the whole measurement, by name."""
    units = {"ns": 1e-6, "µs": 1e-3, "ms": 1, "s": 1e3}
    line = re.search(r"^took the processor +(.*)$", part, re.MULTILINE)
    found = re.findall(r"([^,]+?) \((?:thread|interrupt|softirq|NMI)\) ([\d.]+) (ns|µs|ms|s) in", line[1] if line else "")
    return {name.strip(): float(value) * units[unit] for name, value, unit in found}


def worst_frames(part, source):
    """Milliseconds that a source took in each of the worst frames."""
    row = re.search(rf"^{source} +(?:thread|interrupt) +(.*)$", part, re.MULTILINE)
    return [float(value) for value in row[1].split()] if row else []


def main():
    text = open(sys.argv[1], errors="replace").read()
    parts = parts_of(text)
    alone = parts.get("alone", "")
    restored = re.compile(r"options: .*(?<!NO_)OSNOISE_WORKLOAD")
    checks = {
        "alone, interrupts are named": "local_timer" in took(alone),
        "alone, the thread beside the loop is named": "timer-noise" in took(alone),
        "the worst frames name interrupts": max(worst_frames(alone, "local_timer"), default=0) > 0,
        "without a processor, the report says why":
            "not known: the loop has no processor of its own; set realtime.cpu" in parts.get("without a processor of its own", ""),
        "a killed run leaves an instance": "instance: touchline-latency-" in parts.get("killed", ""),
    }
    for name in ("alone", "after a killed run"):
        part = parts.get(name, "")
        checks[f"{name}, tracefs is left as it was"] = bool(restored.search(part)) and "instance:" not in part
    checks["the guest reached the end"] = "end" in parts
    for name, good in checks.items():
        print("passed" if good else "FAILED", name)
    failed = sum(not good for good in checks.values())
    print(f"{len(checks) - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
