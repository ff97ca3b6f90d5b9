"""Makes the package and its examples in the clone importable for the tests beside this file."""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "tools/python"
sys.path[:0] = [str(PACKAGE), str(PACKAGE / "examples")]
