"""run.py PACKAGE_FOLDER FILE...: tests of the Python module by pytest. Exit code 77, with a reason: they cannot run here."""
import importlib.util
import pathlib
import sys

sys.dont_write_bytecode = True  # nothing new in the source tree
folder = pathlib.Path(sys.argv[1]).resolve()
if not list(folder.glob("febiodea/_febiodea*.so")):
    print("skipped: the Python module was not built (pybind11-dev was not found)")
    sys.exit(77)
missing = [name for name in ("numpy", "pytest") if importlib.util.find_spec(name) is None]
if missing:
    print(f"skipped: {sys.executable} has no {' and no '.join(missing)}")
    sys.exit(77)
sys.path.insert(0, str(folder))
import pytest  # noqa: E402

sys.exit(pytest.main(["-q", "-rs", "-p", "no:cacheprovider", *sys.argv[2:]]))
