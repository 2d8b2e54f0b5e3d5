#!/usr/bin/env python3
"""The examples of the gallery: make_gallery.py DEA MODULE FOLDER [--page dea.html] [EXAMPLE ...].

DEA: the program; MODULE: the folder of the Python module. Each example is run as it is, in a folder of its own with the files that it
names, and FOLDER gets its picture (NAME.svg, of a page NAME.png) and what is needed to run it again (NAME.zip). The live page is made of
the dea.html of --page or beside the program; where there is none, or no Chromium, it is made of a stand-in, and has no picture. Exit
code 1: an example or its picture failed, or README.md names others."""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parent.parent
PATIENCE = 300  # s
STAND_IN = '<script type="text/plain" id="sample-model" data-gives-way="1">x</script>\n'  # for a dea.html


class Example:
    """A script: title, what it shows, the files it needs, its lines."""

    def __init__(self, path):
        self.path, lines = path, path.read_text().splitlines()
        comments = [line[2:] for line in lines[:3]]
        assert all(line.startswith("# ") for line in lines[:3]) and comments[2].startswith("files: "), f"{path}: begins otherwise"
        self.title, self.says = comments[:2]
        self.files = [SOURCE / name for name in comments[2].removeprefix("files: ").split()]
        self.code = "\n".join(lines[3:]).strip() + "\n"
        self.name, self.language = path.stem, {".sh": "sh", ".py": "python"}[path.suffix]
        self.needs_page = " --live " in self.code


def examples():
    """In the order of the gallery's page."""
    named = re.findall(r"^\| `(\S+)` \| (.*) \|$", (HERE / "README.md").read_text(), re.M)
    there = {path.name for path in HERE.iterdir() if path.suffix in (".sh", ".py")} - {"make_gallery.py"}
    if {name for name, _ in named} != there:
        raise ValueError(f"README.md names {sorted(name for name, _ in named)}, expected {sorted(there)}")
    found = [Example(HERE / name) for name, _ in named]
    for example, (name, title) in zip(found, named):
        if example.title != title:
            raise ValueError(f"README.md says of {name} \"{title}\", expected \"{example.title}\", its first line")
    return found


def run(command, folder, dea, module):
    """Runs a command in a folder. Raises CalledProcessError, with what it printed."""
    environment = {**os.environ, "PATH": f"{dea.parent}{os.pathsep}{os.environ['PATH']}", "PYTHONPATH": str(module), "MPLBACKEND": "Agg",
                   "PYTHONDONTWRITEBYTECODE": "1"}
    subprocess.run(command, cwd=folder, env=environment, check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                   timeout=PATIENCE)


def with_page(dea, page, folder):
    """The program beside a dea.html: `page` if it is there, else the stand-in."""
    folder.mkdir()
    shutil.copy(dea, folder / "dea")
    (folder / "dea.html").write_text(page.read_text() if page.exists() else STAND_IN)
    return folder / "dea"


def photograph(page, picture):
    """A page as Chromium shows it, once it has solved its joint."""
    sys.path.insert(0, str(SOURCE / "tests/report"))
    from browser import Browser
    with Browser() as browser:
        browser.open(page.as_uri())
        browser.wait("document.body.innerText.includes('p99')", 120, "the joint to be solved")
        time.sleep(2)
        browser.screenshot(str(picture), whole=False)


def keep(example, made, folder, photographed):
    """Picture and download of an example that was run in `made`."""
    picture = made / f"{example.name}.svg"
    if example.needs_page:
        picture = picture.with_suffix(".png")
        page = made / f"{example.name}.html"
        if photographed:
            photograph(page, picture)
        elif page.stat().st_size == 0:
            raise ValueError(f"{page.name} is empty")
    elif xml.etree.ElementTree.parse(picture).getroot().tag.rpartition("}")[2] != "svg":
        raise ValueError(f"{picture.name} is no SVG")
    if picture.exists():
        shutil.copy(picture, folder)
    with zipfile.ZipFile(folder / f"{example.name}.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        for file in (example.path, *example.files):
            archive.write(file, f"{example.name}/{file.name}")


def make(folder, dea, module, page=None, wanted=()):
    """Runs the examples and keeps what they make: (name, what is wrong) of those that failed."""
    folder.mkdir(parents=True, exist_ok=True)
    page = page or dea.parent / "dea.html"
    photographed = page.exists() and shutil.which("chromedriver")
    faults = []
    for example in examples():
        if wanted and example.name not in wanted:
            continue
        with tempfile.TemporaryDirectory(prefix="dea_gallery_") as temporary:
            made = pathlib.Path(temporary) / "run"
            made.mkdir()
            program = with_page(dea, page, made.parent / "program") if example.needs_page else dea
            for file in (example.path, *example.files):
                shutil.copy(file, made)
            try:
                run((["sh", "-e"] if example.language == "sh" else [sys.executable]) + [example.path.name], made, program, module)
                keep(example, made, folder, photographed)
            except subprocess.CalledProcessError as fault:
                faults.append((example.name, fault.stdout))
            except (OSError, ValueError, xml.etree.ElementTree.ParseError, subprocess.TimeoutExpired) as fault:
                faults.append((example.name, str(fault)))
    return faults


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dea", type=pathlib.Path)
    parser.add_argument("module", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--page", type=pathlib.Path)
    parser.add_argument("examples", nargs="*")
    a = parser.parse_args()
    faults = make(a.folder.resolve(), a.dea.resolve(), a.module.resolve(), a.page and a.page.resolve(), a.examples)
    for name, words in faults:
        print(f"FAILED: {name}: {words}")
    sys.exit(bool(faults))
