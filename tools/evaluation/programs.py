"""Runs Touchline's programs for tools/evaluate-all."""
import json
import pathlib
import subprocess
import sys


class Failed(Exception):
    """A program ended with an error; the text names the command and what it said."""


def progress(text):
    """One line that replaces itself, on a terminal; else a line each."""
    if sys.stderr.isatty():
        print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)
    elif text:
        print(text, file=sys.stderr, flush=True)


class Programs:
    def __init__(self, build, out):
        self.build = pathlib.Path(build)
        self.out = pathlib.Path(out)
        self.out.mkdir(parents=True, exist_ok=True)

    def path(self, name):
        program = self.build / "tools" / "programs" / name / f"touchline-{name}"
        if not program.exists():
            raise Failed(f"{program} is not there; build it first (cmake --build --preset release)")
        return str(program)

    def run(self, name, *arguments, may_fail=False):
        """What it printed; None when it failed and may."""
        command = [self.path(name), *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode == 0:
            return done.stdout
        if may_fail:
            return None
        raise Failed(f"{' '.join(command)}\n{done.stderr.strip()}")

    def replay(self, pictures, venue, team, name, *options):
        """The result's path and its lines."""
        result = self.out / f"{name}.jsonl"
        self.run("replay", pictures, "--venue", venue, "--team", team, "--out", result, "--quiet", *options)
        return result, [json.loads(line) for line in result.read_text().splitlines()]

    def evaluate(self, *arguments):
        """The numbers, as touchline-evaluate --json writes them."""
        numbers = self.out / "numbers.json"
        self.run("evaluate", *arguments, "--json", numbers)
        return json.loads(numbers.read_text())
