"""docs/developers/promises.md against tests, source and program: python3 promises.py DEA SOURCE BUILD CTEST.

Every test that the page names exists; its figures and versions are those of the source; and what dea never does: no function
of the network or of other programs is called, no file is written but the named ones, the environment changes no result."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

dea, source, build, ctest = (pathlib.Path(p) for p in sys.argv[1:5])
dea = dea.resolve()
page = (source / "docs/developers/promises.md").read_text()
faults = []


def check(true, what):
    if not true:
        faults.append(what)


# Tests that are named
with tempfile.TemporaryDirectory(prefix="dea_ctest_") as elsewhere:  # in the build folder, ctest would begin the running ctest's log anew
    (pathlib.Path(elsewhere) / "CTestTestfile.cmake").write_text(f'subdirs("{build}")\n')
    listed = subprocess.run([ctest, "--test-dir", elsewhere, "-N"], capture_output=True, text=True, check=True).stdout
tests = re.findall(r"^ +Test +#\d+: (\S+)", listed, re.M)
exist = {re.sub(r"^\w+/|/[^/]+$", "", name) for name in tests} | set(tests)
if any(name.endswith("_NOT_BUILT") for name in tests):  # of programs that are not built the sources know the tests
    sources = "\n".join(path.read_text() for path in (source / "tests").rglob("*.cpp"))
    exist |= {".".join(names) for names in re.findall(r"TEST(?:_F|_P)?\((\w+),\s*(\w+)\)", sources)}
named = set()
for row in re.findall(r"^\|(.*)\|$", page, re.M):
    named |= set(re.findall(r"`([A-Z]\w+\.[A-Z]\w+|[a-z]+(?:_[a-z]+)*)`", row.rpartition("|")[2]))
named |= set(re.findall(r"`([A-Z]\w+\.[A-Z]\w+)`", page))
check(len(named) > 30, f"found {len(named)} tests on the page, expected more than 30")
for name in sorted(named):
    check(name in exist, f"docs/developers/promises.md names the test {name}, which is none of ctest's")

# Figures and versions
text = {path: path.read_text() for folder in ("src", "io", "views", "app") for path in (source / folder).rglob("*")
        if path.suffix in (".h", ".cpp")}
everything = "\n".join(text.values())
for figure in re.findall(r"`(k\w+ = [^`]+)`", page):
    check(re.search(rf"\b{re.escape(figure)}\b", everything), f"docs/developers/promises.md: found {figure}, the source has another number")
schemas = set(re.findall(r'(?:"schema"\] = |head_json\()"(dea\.\w+/\d+)"', everything))
check(schemas and schemas == set(re.findall(r"`(dea\.\w+/\d+)`", page)), f"docs/developers/promises.md: expected the schemas {sorted(schemas)}")
codes = {int(n) for n in re.findall(r"\bk\w+ = (\d+)", re.search(r"enum ExitCode \{(.*?)\}", everything).group(1))}
check(codes and codes <= {int(n) for n in re.findall(r"^\| (\d+)", page, re.M)}, f"docs/developers/promises.md: expected the exit codes {sorted(codes)}")

# Functions that the programs call
def functions_of(program):
    called = subprocess.run(["nm", "-D", "--undefined-only", program], capture_output=True, text=True).stdout
    return {line.split()[-1].partition("@")[0] for line in called.splitlines() if line.split()}


if shutil.which("nm"):
    called = functions_of(dea)
    check("fork" in called, f"nm: found {len(called)} functions and not fork, which dea plugin-build calls")
    for program in (dea, dea.parent / "dea-build"):
        for function in ("socket", "connect", "bind", "getaddrinfo", "gethostbyname", "sendto", "system", "popen", "posix_spawn", "dlopen"):
            check(not program.exists() or function not in functions_of(program), f"{program.name} calls {function}")
    for call, allowed in ((r"fork|exec[lv]p?e?|popen|posix_spawn|system", ["process.cpp"]),
                          (r"become_program", ["no_programs.cpp", "process.cpp", "process.h", "start_build.cpp"]),
                          (r"start_program", ["animation.cpp", "no_programs.cpp", "plugin_build.cpp", "process.cpp", "process.h"])):
        users = sorted(path.name for path, code in text.items() if re.search(rf"\b(?:::)?({call}) ?\(", code))
        check(users == allowed, f"other programs are started by {users}, expected {allowed} alone")


# Files
def files(folder):
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


with tempfile.TemporaryDirectory() as temporary:
    top = pathlib.Path(temporary)
    for name in ("here", "model", "home", "tmp"):
        (top / name).mkdir()
    shutil.copy(source / "samples/sphere_on_flat/sphere_on_flat.feb", top / "model/m.feb")
    shutil.copy(source / "samples/sphere_on_flat/sphere_on_flat.feb", top / "model/n.feb")
    quiet = {"PATH": "/usr/bin:/bin", "HOME": str(top / "home"), "TMPDIR": str(top / "tmp"), "XDG_CACHE_HOME": str(top / "home/cache"),
             **{name: value for name, value in os.environ.items() if name.endswith("SAN_OPTIONS")}}
    loud = {**quiet, "LC_ALL": "de_DE.UTF-8", "LANG": "tr_TR", "LANGUAGE": "fr", "TZ": "Asia/Tokyo", "TERM": "dumb", "COLUMNS": "20",
            "OMP_NUM_THREADS": "3", "TBB_NUM_THREADS": "3", "POSIXLY_CORRECT": "1", "SOURCE_DATE_EPOCH": "1"}
    before = files(top)

    def expect(line, new, env=quiet):
        global before
        done = subprocess.run([dea, *line.split()], cwd=top / "here", env=env, capture_output=True, text=True)
        check(done.returncode == 0, f"dea {line}: exit code {done.returncode}: {done.stderr}")
        after = files(top)
        check(after - before == set(new) and not before - after, f"dea {line}: wrote {sorted(after - before)}, expected {sorted(new)}")
        before = after

    expect("info ../model/m.feb", [])
    expect("run ../model/m.feb --states last", ["model/m_dea.xplt"])
    expect("run ../model/n.feb --states last -o a.xplt --json a.json --csv a.csv --facets-csv f.csv --report a.html",
           ["here/a.xplt", "here/a.json", "here/a.csv", "here/f.csv", "here/a.html"])
    expect("run ../model/n.feb --states last --no-xplt", [])
    expect("convert ../model/m.feb", ["model/m_dea.feb"])
    expect("compare a.xplt ../model/m_dea.xplt --json c.json", ["here/c.json"])
    expect("plot a.xplt -o a.svg", ["here/a.svg"])
    expect("converge ../model/m.feb --target 0.5", [])
    expect("study ../model/m.feb --vary E:E={8|12} --states last -o s.db", ["here/s.db"])

    # Limits that no other test reaches
    for line, said in (("run ../model/m.feb --refine 1000 -o r.xplt", "20000000"),
                       ("study ../model/m.feb -o t.db " + " ".join(f"--vary f{i}:E={{8|9}}" for i in range(501)), "500")):
        done = subprocess.run([dea, *line.split()], cwd=top / "here", env=quiet, capture_output=True, text=True)
        told = [line for line in done.stderr.splitlines() if line.startswith("dea")]  # a slow machine has lines of progress too
        check(done.returncode in (2, 3) and len(told) == 1 and said in told[0], f"dea {line[:60]}: found {done.returncode}: {done.stderr[:300]}")
        check(files(top) == before, f"dea {line[:60]}: wrote a file")

    # The environment: another one, the same bytes
    (top / "here/loud").mkdir()
    expect("run ../model/n.feb --states last -o loud/a.xplt --csv loud/a.csv --facets-csv loud/f.csv",
           ["here/loud/a.xplt", "here/loud/a.csv", "here/loud/f.csv"], loud)
    expect("plot a.xplt -o loud/a.svg", ["here/loud/a.svg"], loud)
    for name in ("a.xplt", "a.csv", "f.csv", "a.svg"):
        check((top / "here" / name).read_bytes() == (top / "here/loud" / name).read_bytes(), f"{name}: the environment changed it")

print("\n".join(faults) or f"{len(named)} tests hold what docs/developers/promises.md promises")
sys.exit(bool(faults))
