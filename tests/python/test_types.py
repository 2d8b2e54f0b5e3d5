"""The type hints: mypy is silent about the stub and about a script of a user's, and not about a wrong one."""
import pathlib
import shutil
import subprocess

import pytest

import febiodea

PACKAGE = pathlib.Path(febiodea.__file__).parent
USE = pathlib.Path(__file__).with_name("typed_use.py")


def mypy(file, folder):
    program = shutil.which("mypy")
    if not program:
        pytest.skip("no mypy")
    (folder / "febiodea").mkdir(exist_ok=True)
    for name in ("__init__.pyi", "py.typed", "statistics.py"):
        shutil.copy(PACKAGE / name, folder / "febiodea")
    # of numpy there are no hints in every Debian: what it has is taken as it is
    return subprocess.run([program, "--strict", "--ignore-missing-imports", "--no-error-summary", "--cache-dir", folder / "cache", "--python-executable",
                           "/usr/bin/python3", file], cwd=folder, capture_output=True, text=True)


def test_a_script_is_right(tmp_path):
    found = mypy(USE, tmp_path)
    assert (found.stdout, found.returncode) == ("", 0)


def test_the_stub_is_right(tmp_path):
    mypy(USE, tmp_path)
    found = mypy(tmp_path / "febiodea/__init__.pyi", tmp_path)
    assert (found.stdout, found.returncode) == ("", 0)


@pytest.mark.parametrize("line", ["result['hip_contact'].headline.p98", "result[-1] + 1", "febiodea.analyse('hip.feb')", "state.contacts = []"])
def test_a_wrong_one_is_told(tmp_path, line):
    (tmp_path / "wrong.py").write_text(USE.read_text() + f"\n{line}\n")
    assert mypy(tmp_path / "wrong.py", tmp_path).returncode == 1
