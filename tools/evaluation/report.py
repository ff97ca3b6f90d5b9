"""Collects rows, details and pictures while tools/evaluate-all runs; everything is on disk after each set."""
import json
import os
import shutil
import sys

import judging
import page
import programs
import table


class Report:
    def __init__(self, out, base):
        self.out, self.base = out, base
        self.rows, self.details, self.pictures = [], {}, []
        self.reliability = judging.Reliability()
        self.page_folder = out / "pictures"
        shutil.rmtree(self.page_folder, ignore_errors=True)
        self.page_folder.mkdir(parents=True)

    def add(self, name, case, counts, goal):
        row = {"set": name, "case": case, **counts, "goal": goal}
        self.rows.append(row)
        programs.progress(table.text_of(row, self.base))

    def measured(self, row):
        """Adds a row with one measured value."""
        self.rows.append(row)
        programs.progress(table.text_of(row, self.base))

    def note(self, words):
        """Adds words to the last row."""
        self.rows[-1]["note"] = words
        programs.progress(f"  {words}")

    def attempt(self, name, case, goal, measure):
        """Runs a measurement. If it fails, its reason is a row."""
        programs.progress(f"{name}: {case}")
        try:
            return measure()
        except programs.Failed as failure:
            self.failed(name, case, str(failure), goal)
            return None

    def failed(self, name, case, reason, goal=None):
        row = {"set": name, "case": case, "failed": reason, "goal": goal or {}}
        self.rows.append(row)
        programs.progress(table.text_of(row, self.base))

    def any_failed(self):
        return any("failed" in row for row in self.rows)

    def shows(self, name):
        """Whether the page has pictures of this set."""
        return any(one["set"] == name for one in self.pictures)

    def picture(self, name, case, file, judged, radius, truth):
        """Keeps a judged picture for the page. Positions of the truth in meters need `px` in the same places."""
        copy = self.page_folder / f"{len(self.pictures):04d}{file.suffix}"
        shutil.copy(file, copy)
        self.pictures.append(page.entry(name, case, file.name, f"{self.page_folder.name}/{copy.name}", judged, radius, truth))

    def write(self):
        """Writes evaluation.json and evaluation.html; a file is complete or as it was before."""
        numbers = {"rows": self.rows, "reliability": self.reliability.rows(), "details": self.details}
        write_atomically(self.out / "evaluation.json", json.dumps(numbers, indent=1) + "\n")
        write_atomically(self.out / "evaluation.html", page.html(self.pictures, self.rows, self.base, self.out))

    def print(self):
        sys.stdout.flush()
        table.print_rows(self.rows, self.base)
        table.print_reliability(self.reliability.rows())


def write_atomically(path, text):
    part = path.with_name(path.name + ".part")
    part.write_text(text)
    os.replace(part, path)
