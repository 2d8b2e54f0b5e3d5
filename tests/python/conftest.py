import os
import pathlib
import subprocess

import pytest

import febiodea

SAMPLES = pathlib.Path(os.environ["DEA_SAMPLES_DIR"])
ALL_SAMPLES = sorted(p.relative_to(SAMPLES).as_posix() for p in SAMPLES.glob("*/*.feb") if not p.stem.endswith("_dea"))


def pytest_generate_tests(metafunc):
    if "sample" in metafunc.fixturenames:
        metafunc.parametrize("sample", ALL_SAMPLES)


@pytest.fixture(scope="session")
def samples():
    return SAMPLES


@pytest.fixture(scope="session")
def reference():
    folder = pathlib.Path(os.environ.get("DEA_REFERENCE_DIR", ""))
    if not list(folder.glob("*.xplt")):
        pytest.skip("no reference results")
    return folder


@pytest.fixture(scope="session")
def dea():
    """Runs the program; its exit code must be 0 (solved)."""
    def run(*words, cwd):
        finished = subprocess.run([os.environ["DEA_PROGRAM"], *map(str, words)], cwd=cwd, capture_output=True, text=True)
        assert finished.returncode == 0, finished.stderr
        return finished.stdout
    return run


@pytest.fixture(scope="session")
def models(samples):
    read = {}

    def model(path):
        if path not in read:
            read[path] = febiodea.read_feb(samples / path)
        return read[path]
    return model


@pytest.fixture(scope="session")
def small(tmp_path_factory):
    """A joint of 128 springs, pressed and solved in milliseconds."""
    path = tmp_path_factory.mktemp("small") / "small.feb"
    subprocess.run([os.environ["DEA_MAKE_SAMPLES"], "--sphere-on-flat", "8", path], check=True)
    return febiodea.recognise(path, law="linear")


@pytest.fixture(scope="session")
def hip(models):
    return febiodea.recognise(models("hip/hip_walking.feb"))


@pytest.fixture(scope="session")
def hip_result(hip):
    return febiodea.analyse(hip, "last")
