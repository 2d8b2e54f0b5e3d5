"""run.py PACKAGE_FOLDER FILE...: tests of the Python module by pytest. Exit code 77, with a reason: they cannot run here."""
import importlib.util
import pathlib
import sys


def main():
    sys.dont_write_bytecode = True  # nothing new in the source tree
    folder = pathlib.Path(sys.argv[1]).resolve()
    if not list(folder.glob("febiodea/_febiodea*.so")):
        print("skipped: the Python module was not built (pybind11-dev was not found)")
        return 77
    missing = [name for name in ("numpy", "pytest") if importlib.util.find_spec(name) is None]
    if missing:
        print(f"skipped: {sys.executable} has no {' and no '.join(missing)}")
        return 77
    sys.path.insert(0, str(folder))
    import pytest
    return pytest.main(["-q", "-rs", "-p", "no:cacheprovider", *sys.argv[2:]])


if __name__ == "__main__":  # processes of multiprocessing read this file, too
    sys.exit(main())
