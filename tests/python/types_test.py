#!/usr/bin/env python3
"""mypy finds nothing in the package, its build backend and its examples. Skipped (77) without mypy."""
import importlib.util
import os
import shutil
import subprocess
import sys

from package import PACKAGE

if importlib.util.find_spec("mypy") is not None:
    mypy = [sys.executable, "-m", "mypy"]
elif shutil.which("mypy") is not None:
    mypy = ["mypy"]
else:
    print("mypy is not installed (Debian: mypy)")
    sys.exit(77)
files = ["touchline", "build_backend.py", *sorted(f"examples/{path.name}" for path in (PACKAGE / "examples").glob("*.py"))]


def check(*arguments):
    return subprocess.run([*mypy, "--strict", "--cache-dir", os.devnull, *arguments], cwd=PACKAGE,
                          env={**os.environ, "MYPYPATH": str(PACKAGE)}).returncode


if check("-c", "import touchline\ntouchline.Velocity(v='fast', w=0)") == 0:
    sys.exit("FAILED: mypy does not find a planted error")
sys.exit(check(*files))
