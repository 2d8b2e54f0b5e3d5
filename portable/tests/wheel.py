"""A wheel of febiodea, in an environment of its own: wheel.py WHEEL PYTHON SAMPLES. It needs no symbol newer than glibc 2.34 and no
library but glibc's and libgcc_s; installed by pip without network, it solves a sample to the same
numbers as it writes into its files; as root also in an empty chroot with this Python and numpy alone."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

wheel, python, samples = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], pathlib.Path(sys.argv[3]).resolve()
LEAST = (2, 34)
ALLOWED = {"libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2", "librt.so.1", "ld-linux-x86-64.so.2", "libgcc_s.so.1"}
SCRIPT = """
import pickle, sys
import febiodea
result = febiodea.analyse(febiodea.recognise(sys.argv[1]), "last")
again = pickle.loads(pickle.dumps(result))
assert result.solved and (again["hip_contact"].nodes.pressure == result["hip_contact"].nodes.pressure).all()
result.write_xplt("hip.xplt")
file = febiodea.read_xplt("hip.xplt")
assert abs(file.states[-1].surface("acetabular_articulating").headline().p99 / result["hip_contact"].headline.p99 - 1) < 1e-12
result.report("hip.html")
febiodea.picture(result, "hip.svg")
print(repr(result["hip_contact"].headline.p99), febiodea.__file__)
"""


def output(*words, **more):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, **more)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}: {done.stderr[-2000:]}")
    return done.stdout


with tempfile.TemporaryDirectory() as folder:
    work = pathlib.Path(folder)
    with zipfile.ZipFile(wheel) as packed:
        packed.extractall(work / "wheel")
    module = next((work / "wheel/febiodea").glob("_febiodea*.so"))
    symbols = output("objdump", "-p", module)
    needed = set(re.findall(r"NEEDED +(\S+)", symbols))
    newest = max(tuple(map(int, v.split("."))) for v in re.findall(r"GLIBC_([\d.]+)", symbols))
    if needed - ALLOWED:
        sys.exit(f"{wheel.name}: needs {', '.join(sorted(needed - ALLOWED))}, expected glibc's and libgcc_s alone")
    if newest > LEAST:
        found = [line for line in output("objdump", "-T", module).splitlines() if f"GLIBC_{'.'.join(map(str, newest))}" in line]
        sys.exit(f"{wheel.name}: needs glibc {newest}, expected at most {LEAST}: {found}")
    # numpy of the environment's interpreter, or of the system where that has the same version
    output(python, "-m", "venv", "--system-site-packages", work / "env")
    inside = work / "env/bin/python"
    output(inside, "-m", "pip", "install", "--no-index", "--no-deps", wheel)
    path = next((work / "env").rglob("site-packages"))
    if subprocess.run([inside, "-c", "import numpy"], capture_output=True).returncode != 0:
        version = output(inside, "-c", "import sys; print(sys.version_info[:2])")
        if version != output("/usr/bin/python3", "-c", "import sys; print(sys.version_info[:2])"):
            sys.exit(f"{python}: has no numpy, and the system's is for another Python: not tried")
        (path / "numpy").symlink_to(output("/usr/bin/python3", "-c", "import numpy; print(numpy.__path__[0])").strip())
    (work / "use.py").write_text(SCRIPT)
    p99, place = output(inside, work / "use.py", samples / "hip/hip_walking.feb", cwd=work, env={"PATH": "/usr/bin:/bin"}).split()
    if not place.startswith(str(work / "env")):
        sys.exit(f"{place}: another febiodea was imported")
    where = output(inside, "--version").strip()
    # a root with this Python, numpy and what the two are linked with, and nothing else
    if os.geteuid() == 0 and pathlib.Path(python).resolve() == pathlib.Path("/usr/bin/python3").resolve():
        root = work / "root"
        numpy = pathlib.Path(output(python, "-c", "import numpy; print(numpy.__path__[0])").strip())
        library = pathlib.Path(output(python, "-c", "import os; print(os.path.dirname(os.__file__))").strip())
        real = pathlib.Path(python).resolve()
        for tree in (numpy, library):
            shutil.copytree(tree, root / tree.relative_to("/"), symlinks=False, ignore=shutil.ignore_patterns("__pycache__", "test", "tests"), ignore_dangling_symlinks=True)
        linked = {real, *numpy.rglob("*.so"), *library.rglob("lib-dynload/*.so"), module}
        for file in {match for one in linked for match in re.findall(r"(/\S+) \(0x", output("ldd", one))} | {str(real)}:
            target = root / pathlib.Path(file).relative_to("/")
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(file, target)
        shutil.copytree(path / "febiodea", root / "packages/febiodea")
        shutil.copy(work / "use.py", root / "use.py")
        shutil.copy(samples / "hip/hip_walking.feb", root / "hip_walking.feb")
        found = output("chroot", root, real, "/use.py", "/hip_walking.feb", env={"PATH": os.environ["PATH"], "PYTHONPATH": f"/packages:{numpy.parent}", "PYTHONHOME": "/usr"})
        if found.split() != [p99, "/packages/febiodea/__init__.py"]:
            sys.exit(f"{wheel.name}: found {found.strip()} in a chroot, expected {p99}")
        where += " and in an empty chroot"
    print(f"{wheel.name}: glibc {'.'.join(map(str, newest))}, {', '.join(sorted(needed))}; {module.stat().st_size} bytes; p99 {p99} in {where}")
