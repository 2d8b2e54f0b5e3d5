"""dea.exe as users have it: python3 windows.py DEA_EXE DEA SOURCE [TEST ...], with wine; DEA is the program of the same commit for
this machine. WINE: the loader [wine64]; WINEPREFIX: where Windows lies [a new one].

Names in any script, blanks, backslashes and drives; line ends; Ctrl-C; nothing left behind, also by a run that is killed; two
runs at once; files that another program holds; a study that is killed and goes on."""
import csv
import json
import os
import pathlib
import pty
import re
import shutil
import subprocess
import sys
import tempfile
import time

exe, native, source = (pathlib.Path(a).resolve() for a in sys.argv[1:4])
wine = shutil.which(os.environ.get("WINE", "wine64"), path=os.environ["PATH"] + ":/usr/lib/wine")
top = tempfile.TemporaryDirectory(prefix="dea_windows_")
os.environ.update(LC_ALL="C.UTF-8", WINEDEBUG="-all")
os.environ.setdefault("WINEPREFIX", str(pathlib.Path(top.name) / "prefix"))
FOLDER, FILE = "Бедро 髋 𠮷", "a b ü"
LAW = ["--law", "linear", "--facets", "flat", "--states", "last"]
SLOW = ["--law", "layer", "--refine", "6", "--threads", "1", "-v"]  # many seconds; -v says when it has begun
CASES = ["--vary", "E: E={8:37:1}", *LAW]  # 30
MODEL = "sphere_on_flat.feb"


class Folder:
    """A folder with a model; what lies there is looked at after each command."""

    def __init__(self, model=MODEL):
        self.path = pathlib.Path(tempfile.mkdtemp(dir=top.name))
        shutil.copy(source / "samples/sphere_on_flat" / MODEL, self.path / model)

    def files(self, others=False):
        """`others`: another run is at work; wine shows the name of its file without a name until it ends."""
        return {p.relative_to(self.path).as_posix() for p in self.path.rglob("*") if p.is_file() and not (others and p.suffix in (".tmp", ".old"))}

    def start(self, *words, program=None, **more):
        program = program or [wine, exe]
        return subprocess.Popen([*program, *words], cwd=self.path, stdin=subprocess.DEVNULL,
                                stdout=more.get("stdout", subprocess.PIPE), stderr=more.get("stderr", subprocess.PIPE))

    def run(self, *words, code=0, new=(), program=None, others=False):
        """Standard output and errors, as bytes. `new`: the files that come with it, and no other."""
        before = self.files(others)
        process = self.start(*words, program=program)
        out, err = process.communicate(timeout=600)
        assert process.returncode == code, f"{words}: exit code {process.returncode}, expected {code}\n{err.decode()}"
        after = self.files(others)
        assert after - before == set(new) and not before - after, f"{words}: wrote {after - before}, expected {set(new)}"
        return out, err

    def linux(self, *words, **more):
        return self.run(*words, program=[native], **more)

    def same(self, *words, code=0):
        """Both programs say the same, byte for byte; standard output."""
        ours, theirs = self.run(*words, code=code), self.linux(*words, code=code)
        for here, there in zip(ours, theirs):
            here, there = (re.sub(rb"\d+ states? in .*|commit \w+", b"", text) for text in (here, there))  # seconds
            assert here == there, f"{words}: found\n{here.decode(errors='replace')}\nexpected\n{there.decode()}"
        return ours[0]

    def wait_for(self, name, process):
        end = time.monotonic() + 120
        while not (self.path / name).exists():
            assert process.poll() is None and time.monotonic() < end, f"{name} did not come: {process.communicate()[1]}"
            time.sleep(0.05)

    def wait_until_gone(self, name):
        end = time.monotonic() + 20
        while (self.path / name).exists():
            assert time.monotonic() < end, f"{name} stays"
            time.sleep(0.05)


def close(a, b, where=""):
    """Two JSON documents with the same numbers, to 1e-12 of the larger or of 1."""
    if isinstance(a, dict):
        assert a.keys() == b.keys(), f"{where}: {a.keys() ^ b.keys()}"
        for key in a:
            if key not in ("seconds", "timings", "threads", "model", "command"):
                close(a[key], b[key], f"{where}/{key}")
    elif isinstance(a, list):
        assert len(a) == len(b), where
        for i, (x, y) in enumerate(zip(a, b)):
            close(x, y, f"{where}/{i}")
    elif isinstance(a, float) and isinstance(b, float):
        assert abs(a - b) <= 1e-12 * max(1.0, abs(a), abs(b)), f"{where}: {a} and {b}"
    else:
        assert a == b, f"{where}: {a} and {b}"


def test_names_in_any_script():
    f = Folder()
    (f.path / FOLDER / "sub").mkdir(parents=True)
    shutil.move(f.path / MODEL, f.path / FOLDER / f"{FILE}.feb")
    feb = f"{FOLDER}\\{FILE}.feb"
    f.run("run", feb, *LAW, "-q", new=[f"{FOLDER}/{FILE}_dea.xplt"])
    names = {"--json": "числа.json", "--csv": "数 字.csv", "--facets-csv": "facets é.csv", "--report": "страница.html", "-o": "結果.xplt"}
    words = [w for option, name in names.items() for w in (option, f"{FOLDER}\\sub\\{name}")]
    f.run("run", feb, *LAW, "-q", *words, new=[f"{FOLDER}/sub/{name}" for name in names.values()])
    sub = f.path / FOLDER / "sub"
    f.linux("run", f"{FOLDER}/{FILE}.feb", *LAW, "-q", "--json", "linux.json", "--csv", "linux.csv", "-o", "linux.xplt",
            new=["linux.json", "linux.csv", "linux.xplt"])
    assert (sub / "結果.xplt").read_bytes() == (f.path / "linux.xplt").read_bytes()
    close(json.loads((sub / "числа.json").read_text()), json.loads((f.path / "linux.json").read_text()))
    assert json.loads((sub / "числа.json").read_text())["model"] == feb
    for name in names.values():
        if not name.endswith(".xplt"):
            assert b"\r" not in (sub / name).read_bytes(), name
    assert FOLDER not in (sub / "страница.html").read_text(), "the page tells the folder of its model"
    f.run("compare", f"{FOLDER}\\sub\\結果.xplt", f"{FOLDER}/{FILE}_dea.xplt", "--json", "сравнение.json", new=["сравнение.json"])
    f.run("convert", feb, "-o", f"{FOLDER}\\преобразованный.feb", new=[f"{FOLDER}/преобразованный.feb"])
    f.run("study", feb, "--cases", f"{FOLDER}\\таблица.csv", "--factor", "E: E={}", *LAW, "-o", f"{FOLDER}\\план.db", code=3)
    (f.path / FOLDER / "таблица.csv").write_text("E\r\n8\r\n12\r\n", newline="")
    f.run("study", feb, "--cases", f"{FOLDER}\\таблица.csv", "--factor", "E: E={}", *LAW, "-o", f"{FOLDER}\\план.db", "-q",
          new=[f"{FOLDER}/план.db"])
    _, err = f.run("info", f"{FOLDER}\\нет такого 髋.feb", code=3)
    assert err.decode() == f"{FOLDER}\\нет такого 髋.feb: no such file: check the path\n", err.decode()


def test_a_part_of_the_model_in_another_file():
    """A name in any script inside a model, from a folder beside it."""
    f = Folder()
    text = (f.path / MODEL).read_text()
    part = re.search(r"\t?<Material>.*?</Material>\n", text, re.S).group(0)
    (f.path / FOLDER).mkdir()
    (f.path / FOLDER / "материал.feb").write_text(f'<?xml version="1.0"?>\n<febio_spec version="4.0">\n{part}</febio_spec>\n')
    for name, separator in (("backslash.feb", "\\"), ("slash.feb", "/")):
        (f.path / name).write_text(text.replace(part, f'\t<Material from="{FOLDER}{separator}материал.feb"/>\n'))
        f.run("run", name, *LAW, "-q", new=[name.replace(".feb", "_dea.xplt")])
    f.run("run", MODEL, *LAW, "-q", "-o", "whole.xplt", new=["whole.xplt"])
    assert (f.path / "slash_dea.xplt").read_bytes() == (f.path / "whole.xplt").read_bytes() == (f.path / "backslash_dea.xplt").read_bytes()


def test_drives():
    """Z: is this machine's /."""
    f = Folder()
    drive = "Z:" + str(f.path).replace("/", "\\")
    f.run("run", f"{drive}\\{MODEL}", *LAW, "-q", "--json", f"{drive}\\out.json", f"--csv={drive}\\out.csv", "--report", f"{drive}\\page.html",
          new=["sphere_on_flat_dea.xplt", "out.json", "out.csv", "page.html"])
    page = (f.path / "page.html").read_text()
    assert MODEL in page and f.path.name not in page, "the page tells the folders of its files"
    table = "time,fx,fy,fz\n1,0,0,-1\n2,0,0,-2\n"
    (f.path / "loads.csv").write_text(table)
    loads = ["run", MODEL, *LAW, "--no-xplt", "-q", "--load-body", "sphere", "--loads"]
    f.run(*loads, f"{drive}\\loads.csv")
    _, err = f.run(*loads, f"{drive}\\none.csv", code=3)
    assert f"{drive}\\none.csv" in err.decode(), err.decode()


def test_what_goes_out_is_what_linux_says():
    f = Folder()
    for words in (["--help"], ["run", "--help"], ["findings"], ["completion", "bash"], ["info", MODEL],
                  ["cite", MODEL], ["run", MODEL, *LAW, "--no-xplt"]):
        assert f.same(*words)
    assert f.same("run", MODEL, *LAW, "--no-xplt", "-q", "--csv", "-").count(b"\n") > 1
    for words, code in ((["run", "none.feb"], 3), (["run", MODEL, "--lwa", "linear"], 2), (["run", MODEL, "-o", "none/x.xplt"], 4),
                        (["run", MODEL, "--json", "."], 4), (["run", "."], 3), (["rnu"], 2)):
        f.same(*words, code=code)
    (f.path / "broken.feb").write_text((f.path / MODEL).read_text()[:100000])
    f.same("run", "broken.feb", code=3)
    out, _ = f.run("run", MODEL, *LAW, "--no-xplt", "-q", "--json", "-")
    assert b"\r" not in out
    close(json.loads(out), json.loads(f.linux("run", MODEL, *LAW, "--no-xplt", "-q", "--json", "-")[0]))


def test_folders_that_take_no_file():
    f = Folder()
    for name in ("full", "taken"):
        (f.path / name).mkdir()
    (f.path / "full").chmod(0o555)
    if not os.access(f.path / "full", os.W_OK):  # nothing keeps root out
        f.same("run", MODEL, *LAW, "-o", "full/x.xplt", code=4)
    (f.path / "taken/x.xplt").mkdir()
    f.same("run", MODEL, *LAW, "-o", "taken/x.xplt", code=4)


def test_what_is_there_is_kept_or_replaced():
    f = Folder()
    (f.path / "foreign.csv").write_text("a,b\n")
    f.same("run", MODEL, *LAW, "--no-xplt", "--csv", "foreign.csv", code=4)
    f.run("run", MODEL, *LAW, "-q", "--no-xplt", "--csv", "foreign.csv", "--overwrite")
    assert (f.path / "foreign.csv").read_text().count("\n") > 1
    f.run("run", MODEL, *LAW, "-q", new=["sphere_on_flat_dea.xplt"])
    first = (f.path / "sphere_on_flat_dea.xplt").read_bytes()
    f.run("run", MODEL, *LAW, "-q", "--E", "20")
    assert (f.path / "sphere_on_flat_dea.xplt").read_bytes() != first


def test_two_runs_at_once():
    f = Folder()
    running = f.start("run", MODEL, *SLOW, "-o", "x.xplt")
    f.wait_for(".x.xplt.lock", running)
    _, err = f.run("run", MODEL, *LAW, "-o", "x.xplt", code=4, others=True)
    assert re.fullmatch(r"dea: cannot write x.xplt: another run \(process \d+\) is at work on it; wait for its end, or give -o another name\n",
                        err.decode()), err.decode()
    f.run("run", MODEL, *LAW, "-q", "-o", "y.xplt", new=["y.xplt"], others=True)
    assert running.poll() is None, "the other run has ended"
    running.kill()
    running.communicate()
    f.wait_until_gone(".x.xplt.lock")
    assert f.files() == {MODEL, "y.xplt"}, f.files()
    f.run("run", MODEL, *LAW, "-q", "-o", "x.xplt", new=["x.xplt"])


HOLDER = """#include <windows.h>
int main(int count, char** words) {
  DWORD sharing = FILE_SHARE_READ | FILE_SHARE_WRITE | (count > 2 ? FILE_SHARE_DELETE : 0);
  if (CreateFileA(words[1], GENERIC_READ, sharing, NULL, OPEN_EXISTING, 0, NULL) == INVALID_HANDLE_VALUE) return 1;
  CreateFileA("held", GENERIC_WRITE, 0, NULL, CREATE_ALWAYS, 0, NULL);
  Sleep(INFINITE);
}
"""


def test_results_that_another_program_holds():
    """One that lets nobody take the file away, as most viewers; and one that does."""
    f = Folder()
    holder = pathlib.Path(top.name) / "holder.exe"
    subprocess.run(["x86_64-w64-mingw32-gcc-posix", "-x", "c", "-", "-o", holder], input=HOLDER.encode(), check=True)
    f.run("run", MODEL, *LAW, "-q", new=["sphere_on_flat_dea.xplt"])
    result = f.path / "sphere_on_flat_dea.xplt"
    for words in ((), ("sharing",)):
        before = result.read_bytes()
        holding = f.start("sphere_on_flat_dea.xplt", *words, program=[wine, holder])
        f.wait_for("held", holding)
        _, err = f.run("run", MODEL, *LAW, "--E", "20", "-q", code=0 if words else 4, others=bool(words))
        assert words or err.decode() == "dea: cannot write sphere_on_flat_dea.xplt: another program has it open\n", err.decode()
        assert (result.read_bytes() == before) == (not words)
        holding.kill()
        holding.communicate()
        (f.path / "held").unlink()
    end = time.monotonic() + 20
    while f.files() != {MODEL, "sphere_on_flat_dea.xplt"} and time.monotonic() < end:
        time.sleep(0.1)
    assert f.files() == {MODEL, "sphere_on_flat_dea.xplt"}, f.files()


def at_a_console(f, *words, until, key=b"\x03"):
    """What a console shows, from a command that is stopped by a key once `until` is seen; its exit code."""
    process, terminal = pty.fork()
    if process == 0:
        os.chdir(f.path)
        os.execv(wine, [wine, str(exe), *words])
    shown, end, pressed = b"", time.monotonic() + 300, False
    while time.monotonic() < end:
        try:
            shown += os.read(terminal, 65536)
        except OSError:  # it has ended
            break
        if until in shown and not pressed:
            pressed = True
            os.write(terminal, key)
    os.close(terminal)
    return shown.decode(errors="replace"), os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])


def test_ctrl_c():
    f = Folder()
    for until, line in ((b"joint and thickness", "dea: stopped\r"), (b"state 2 of", "dea: stopped, nothing was written\r")):
        shown, code = at_a_console(f, "run", MODEL, *SLOW, "-o", "x.xplt", until=until)
        assert code == 130 and line in shown, (code, shown)
        assert f.files() == {MODEL}, f.files()


def test_a_console_shows_all_letters():
    f = Folder(f"{FILE} Бедро 髋.feb")
    shown, code = at_a_console(f, "info", f"{FILE} Бедро 髋.feb", until=b"\0")
    assert code == 0 and f"{FILE} Бедро 髋.feb" in re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", shown), shown


def cases_of(f, name):
    """Rows of a study, but for their seconds."""
    out, _ = f.run("study", name, "--csv", "-", "-q")
    rows = list(csv.reader(out.decode().splitlines()))
    skip = rows[0].index("seconds")
    return [row[:skip] + row[skip + 1:] for row in rows]


def test_a_study_that_is_killed_goes_on():
    f = Folder()
    f.run("study", MODEL, *CASES, "-q", "-o", "whole.db", new=["whole.db"])
    killed = f.start("study", MODEL, *CASES, "-v", "-o", "killed.db")
    while not (line := killed.stderr.readline()).startswith(b"case 20:"):
        assert line, "ended before 20 cases were done"
    killed.kill()
    killed.communicate()
    f.wait_until_gone(".killed.db.lock")
    process = f.start("study", MODEL, *CASES, "-o", "killed.db")  # a journal of the killed one goes
    _, err = process.communicate()
    assert process.returncode == 0, err.decode()
    there = re.search(r"killed.db: (\d+) cases in .*; (\d+) were there already", err.decode())
    assert there and int(there.group(1)) + int(there.group(2)) == 30, err.decode()
    assert cases_of(f, "killed.db") == cases_of(f, "whole.db"), "other results than of a study in one go"
    assert len(cases_of(f, "killed.db")) == 31
    assert f.files() == {MODEL, "whole.db", "killed.db"}, f.files()


def test_a_study_that_is_stopped_goes_on():
    f = Folder()
    shown, code = at_a_console(f, "study", MODEL, *CASES, "-v", "-o", "plan.db", until=b"case 5:")
    assert code == 130 and "cases that are done are in the file, the same command goes on" in shown, (code, shown)
    assert f.files() == {MODEL, "plan.db"}, f.files()
    _, err = f.run("study", MODEL, *CASES, "-o", "plan.db")
    there = re.search(r"(\d+) cases in .*; (\d+) were there already", err.decode())
    assert there and int(there.group(1)) + int(there.group(2)) == 30, err.decode()


def test_a_study_read_here_and_there():
    """A study's file of Windows is read on Linux and goes on there; its model has another path."""
    f = Folder()
    f.run("study", MODEL, *CASES, "-q", "-o", "windows.db", new=["windows.db"])
    f.linux("study", MODEL, *CASES, "-q", "-o", "linux.db", new=["linux.db"])
    ours, theirs = (f.linux("study", name, "--csv", "-", "-q")[0].decode().splitlines() for name in ("windows.db", "linux.db"))
    assert ours[0] == theirs[0] and len(ours) == len(theirs) == 31


def test_what_is_not_there_says_so():
    f = Folder()
    for command, words in (("build", ["--help"]), ("plugin-build", ["/opt/febio"])):
        _, err = f.run(command, *(words if command != "build" else ["--bone", "a=a.stl"]), code=2)
        assert err.decode() == f"dea: {command}: not in dea for Windows; take dea for Linux, in WSL or on another machine\n", err.decode()


failed = []
chosen = sys.argv[4:] or [name for name in globals() if name.startswith("test_")]
assert wine, "found no wine64"
subprocess.run([wine, "wineboot", "-i"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
for name in chosen:
    start = time.monotonic()
    try:
        globals()[name]()
        print(f"passed {name} ({time.monotonic() - start:.0f} s)", flush=True)
    except (AssertionError, subprocess.TimeoutExpired) as fault:
        failed.append(name)
        print(f"FAILED {name}: {fault}", flush=True)
if "dea_windows_" in os.environ["WINEPREFIX"]:
    subprocess.run([shutil.which("wineserver", path="/usr/lib/wine:" + os.environ["PATH"]), "-k"])
print(f"{len(chosen) - len(failed)} of {len(chosen)} tests passed")
sys.exit(bool(failed))
