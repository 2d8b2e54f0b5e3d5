"""What `pip install ./python` calls (PEP 517): CMake builds the module, and what it installs becomes a wheel.

FEBIODEA_BUILD names the build folder, from the clone's root on (build/python otherwise), such as build/release to use what
is built there.
"""
import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def _version():
    return re.search(r"project\(FEBioDEA VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)


def _metadata():
    return ("Metadata-Version: 2.1\nName: febiodea\n" + f"Version: {_version()}\n"
            "Summary: Discrete element analysis of joint contact on FEBio models\n"
            "Requires-Python: >=3.9\nRequires-Dist: numpy\n")


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = os.environ.get("FEBIODEA_PLATFORM") or sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"{python}-{python}-{platform}"


def _build(folder):
    """The package's files in `folder`."""
    build = ROOT / (os.environ.get("FEBIODEA_BUILD") or "build/python")
    run = lambda *words: subprocess.run([str(w) for w in words], check=True)  # noqa: E731
    if not (build / "CMakeCache.txt").exists():  # another's build stays as it was configured
        run("cmake", "-S", ROOT, "-B", build, f"-DPython_EXECUTABLE={sys.executable}", "-DCMAKE_BUILD_TYPE=Release",
            "-DBUILD_TESTING=OFF")
    targets = subprocess.run(["cmake", "--build", build, "--target", "help"], check=True, capture_output=True, text=True)
    if "febiodea_python" not in targets.stdout:
        sys.exit("febiodea: pybind11 or Python's headers were not found (Debian: apt-get install pybind11-dev python3-dev)")
    run("cmake", "--build", build, "--target", "febiodea_python", "--parallel", os.cpu_count() or 1)
    run("cmake", "--install", build, "--component", "python", "--prefix", folder)
    package = next(pathlib.Path(folder).rglob("febiodea"))
    if not list(package.glob(f"_febiodea{sysconfig.get_config_var('EXT_SUFFIX')}")):
        sys.exit(f"febiodea: {build} is built for another Python than {sys.executable}, expected the same; without "
                 "FEBIODEA_BUILD it is built anew (and remove build/python if it is that one)")
    return package


def _info():
    return f"febiodea-{_version()}.dist-info"


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Without it pip would build twice."""
    folder = pathlib.Path(metadata_directory) / _info()
    folder.mkdir()
    (folder / "METADATA").write_text(_metadata())
    return folder.name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    wheel = f"febiodea-{_version()}-{_tag()}.whl"
    with tempfile.TemporaryDirectory() as folder:
        package = _build(folder)
        files = {f"febiodea/{p.name}": p.read_bytes() for p in sorted(package.iterdir())}
    info = _info()
    files[f"{info}/METADATA"] = _metadata().encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: febiodea\nRoot-Is-Purelib: false\nTag: {_tag()}\n".encode()
    licences = [ROOT / "NOTICE", ROOT / "LICENSE", *filter(None, [os.environ.get("FEBIODEA_LICENCES")])]
    files |= {f"{info}/{pathlib.Path(path).name}": pathlib.Path(path).read_bytes() for path in licences}
    record = ""
    for path, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        record += f"{path},sha256={digest},{len(content)}\n"
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / wheel, "w", zipfile.ZIP_DEFLATED) as out:
        for path, content in files.items():
            out.writestr(path, content)
    return wheel


def build_sdist(sdist_directory, config_settings=None):
    sys.exit("febiodea: the module is built from a clone; there is no source package")
