"""Builds the wheel of this folder's package with the standard library only (PEP 517, PEP 660), so that pip needs no network.

The version is the clone's (CMakeLists.txt). The wheel contains the clone's path, so that the installed package finds the programs that are
built there.
"""
from __future__ import annotations

import base64
import hashlib
import re
import zipfile
from pathlib import Path
from typing import Any, Optional

FOLDER = Path(__file__).resolve().parent
CLONE = FOLDER.parents[1]
PACKAGE = FOLDER / "touchline"
WHEEL = "Wheel-Version: 1.0\nGenerator: touchline\nRoot-Is-Purelib: true\nTag: py3-none-any\n"


def _version() -> str:
    text = (CLONE / "CMakeLists.txt").read_text(encoding="utf-8")
    found = re.search(r"^project\(touchline VERSION ([0-9.]+)", text, re.MULTILINE)
    if found is None:
        raise RuntimeError(f"{CLONE / 'CMakeLists.txt'} names no version; install the package from a clone of Touchline")
    return found[1]


def _metadata() -> str:
    return (f"Metadata-Version: 2.1\nName: touchline\nVersion: {_version()}\n"
            "Summary: Frames and commands of Touchline, and its arena, in Python\nRequires-Python: >=3.9\n")


def _record_line(name: str, content: bytes) -> str:
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(content)}\n"


def _write_wheel(directory: str, contents: dict[str, bytes]) -> str:
    info = f"touchline-{_version()}.dist-info"
    contents = {**contents, f"{info}/METADATA": _metadata().encode(), f"{info}/WHEEL": WHEEL.encode()}
    record = "".join(_record_line(name, content) for name, content in contents.items()) + f"{info}/RECORD,,\n"
    name = f"touchline-{_version()}-py3-none-any.whl"
    with zipfile.ZipFile(Path(directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in {**contents, f"{info}/RECORD": record.encode()}.items():
            wheel.writestr(zipfile.ZipInfo(path), content)  # without the time, so that equal sources give equal wheels
    return name


def build_wheel(wheel_directory: str, config_settings: Optional[dict[str, Any]] = None,
                metadata_directory: Optional[str] = None) -> str:
    contents = {f"touchline/{path.name}": path.read_bytes() for path in sorted(PACKAGE.iterdir()) if path.is_file()}
    contents["touchline/clone.txt"] = f"{CLONE}\n".encode()
    return _write_wheel(wheel_directory, contents)


def build_editable(wheel_directory: str, config_settings: Optional[dict[str, Any]] = None,
                   metadata_directory: Optional[str] = None) -> str:
    return _write_wheel(wheel_directory, {"touchline.pth": f"{FOLDER}\n".encode()})


def build_sdist(sdist_directory: str, config_settings: Optional[dict[str, Any]] = None) -> str:
    raise RuntimeError("the package is installed from a clone of Touchline; it has no archive of its own")
