"""Runs Touchline's programs for tools/evaluate-all."""
import json
import pathlib
import shutil
import subprocess
import sys

# Number of frames of a picture that stands still for one second.
ONE_SECOND = 60


class Failed(Exception):
    """A program failed; the text contains the command and its error output."""


def progress(text):
    """Shows progress: on a terminal in a single line, otherwise one line per call."""
    if sys.stderr.isatty():
        print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)
    elif text:
        print(text, file=sys.stderr, flush=True)


def read_lines(path):
    return [json.loads(line) for line in path.read_text().splitlines()]


class Programs:
    def __init__(self, build, out):
        self.build = pathlib.Path(build)
        self.out = pathlib.Path(out)
        self.out.mkdir(parents=True, exist_ok=True)

    def path(self, name):
        program = self.build / "tools" / "programs" / name / f"touchline-{name}"
        if not program.exists():
            raise Failed(f"{program} does not exist; build it first (cmake --build --preset release)")
        return str(program)

    def run(self, name, *arguments, may_fail=False):
        """Returns the program's output; None if it failed and `may_fail` is set."""
        command = [self.path(name), *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode == 0:
            return done.stdout
        if may_fail:
            return None
        raise Failed(f"{' '.join(command)}\n{done.stderr.strip()}")

    def colors(self, *arguments):
        """Calibrates colors; returns False if the program's self-check does not accept them."""
        try:
            self.run("calibrate", "colors", *arguments)
        except Failed as failure:
            if "--accept" not in str(failure):
                raise
            self.run("calibrate", "colors", *arguments, "--accept")
            return False
        return True

    def unclicked_colors(self, venue, team, pictures):
        """Calibrates colors without clicks; returns the reason why the program refuses, or None if it accepts."""
        options = [option for p in pictures for option in ("--picture", p)]
        try:
            self.run("calibrate", "colors", "--venue", venue, "--team", team, *options, "--yes")
        except Failed as failure:
            return " ".join(str(failure).split("touchline-calibrate: ", 1)[-1].split())
        return None

    def replay(self, pictures, venue, team, name, *options):
        """Returns the path of the result and its parsed lines."""
        result = self.out / f"{name}.jsonl"
        self.run("replay", pictures, "--venue", venue, "--team", team, "--out", result, "--quiet", *options)
        return result, read_lines(result)

    def replay_standing(self, picture, venue, team, name, *options, frames=ONE_SECOND, before=(None, 0)):
        """Replays a picture as a camera at 60 Hz that sees nothing else; returns the parsed lines.

        `before`: another picture, and for how many frames it is seen first.
        """
        folder = self.out / f"{name}-repeated"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        first, count = before
        for i in range(count + frames):
            shown = first if i < count else picture
            (folder / f"{i:04d}{shown.suffix}").symlink_to(shown.resolve())
        _, lines = self.replay(folder, venue, team, name, "--rate", 60, *options)
        shutil.rmtree(folder)
        return lines

    def evaluate(self, *arguments):
        """Returns the numbers that touchline-evaluate --json writes."""
        numbers = self.out / "numbers.json"
        self.run("evaluate", *arguments, "--json", numbers)
        return json.loads(numbers.read_text())
