#!/usr/bin/env python3
"""pip installs the package from the clone into a virtual environment, without a network. Skipped (77) without pip or venv."""
import hashlib
import os
import pathlib
import subprocess
import sys
import tempfile
import zipfile

from package import PACKAGE, ROOT

NO_NETWORK = {**os.environ, "PIP_NO_INDEX": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1", "PIP_CONFIG_FILE": "/dev/null",
              "PYTHONDONTWRITEBYTECODE": "1", "http_proxy": "http://127.0.0.1:9", "https_proxy": "http://127.0.0.1:9"}
NO_NETWORK.pop("PYTHONPATH", None)
SHOW = "import touchline, touchline.arena; print(touchline.__file__); print(touchline.arena._clone())"


def check(condition, text):
    if not condition:
        sys.exit("FAILED: " + text)


def run(*command):
    result = subprocess.run(command, cwd="/", env=NO_NETWORK, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    check(result.returncode == 0, f"{' '.join(map(str, command))}:\n{result.stdout}")
    return result.stdout


def check_files(wheel):
    """RECORD has the hash of each file, and nothing of the package is missing."""
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        record = next(name for name in names if name.endswith("/RECORD"))
        for row in archive.read(record).decode().split():
            name, _, size = row.split(",")
            check(name in names and (name == record or len(archive.read(name)) == int(size)), f"{record}: {row}")
    sources = {f"touchline/{path.name}" for path in (PACKAGE / "touchline").iterdir() if path.is_file()}
    check(sources <= set(names) and "touchline/py.typed" in sources, f"{wheel.name} misses {sources - set(names)}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        environment = pathlib.Path(folder, "environment")
        create = [sys.executable, "-m", "venv", environment]
        if subprocess.run(create, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode != 0:
            print("python3 -m venv fails (Debian: python3-venv)")
            sys.exit(77)
        python = environment / "bin/python"
        before = {path.relative_to(PACKAGE) for path in PACKAGE.rglob("*") if "__pycache__" not in path.parts}

        run(python, "-m", "pip", "install", PACKAGE)
        file, clone = run(python, "-c", SHOW).split()
        check(file.startswith(str(environment)), f"{file} is not installed")
        check(clone == str(ROOT), f"the installed package looks for programs in {clone}, not in {ROOT}")
        version = run(python, "-m", "pip", "show", "touchline")
        declared = (ROOT / "CMakeLists.txt").read_text().split("project(touchline VERSION ")[1].split()[0]
        check(f"Version: {declared}\n" in version, version)

        run(python, "-m", "pip", "install", "--no-build-isolation", "--editable", PACKAGE)
        file, clone = run(python, "-c", SHOW).split()
        check(pathlib.Path(file).parent == PACKAGE / "touchline" and clone == str(ROOT), f"editable: {file}, {clone}")
        run(python, "-m", "pip", "uninstall", "--yes", "touchline")

        wheels = [pathlib.Path(folder, name) for name in ("first", "second")]
        for wheel in wheels:
            run(python, "-m", "pip", "wheel", "--wheel-dir", wheel, PACKAGE)
        files = [next(wheel.iterdir()) for wheel in wheels]
        check_files(files[0])
        check(len({hashlib.sha256(path.read_bytes()).digest() for path in files}) == 1, "two wheels of the same sources differ")
        after = {path.relative_to(PACKAGE) for path in PACKAGE.rglob("*") if "__pycache__" not in path.parts}
        check(after == before, f"the installation leaves files in the clone: {after - before}")
    print("installed without a network, also as editable")


main()
