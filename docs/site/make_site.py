#!/usr/bin/env python3
"""Makes the site: docs/site/make_site.py BUILD. BUILD: a folder of the project that is built, e.g. build/release.

The pages by mkdocs, the C++ reference by doxygen, the Python reference by sphinx; any warning of theirs is a fault. The site is
BUILD/site/index.html, for a web server or for a browser alone; it loads nothing from elsewhere, which is looked at."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "gallery"))
import make_gallery
import pages

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parent.parent
DEA_HTML = SOURCE / "build/portable/web/dea.html"  # where it was made


def fail(text):
    sys.exit(f"make_site.py: {text}")


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    if done.returncode:
        print(done.stdout)
        fail(f"{command[0]} found faults, see above")


def gather(work):
    """The pages as they lie in the project, names of pages as links; figures; what mkdocs needs beside them."""
    known = set(pages.pages(SOURCE))
    for page in known:
        (work / "pages" / page).parent.mkdir(parents=True, exist_ok=True)
        (work / "pages" / page).write_text(pages.for_mkdocs((SOURCE / page).read_text(), page, known))
    for figure in pages.figures(SOURCE):
        (work / "pages" / figure).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(SOURCE / figure, work / "pages" / figure)
    shutil.copy(HERE / "site.css", work / "pages")
    shutil.copy(HERE / "mkdocs.yml", work)


PICTURE = re.compile(r"^<!-- picture: (.*) -->$", re.M)


def photographs(build, work):
    """Pictures of pages that dea writes, where a page of the site has the command that makes one, as a comment. Without Chromium, or
    dea.html where it needs that, the comment stays."""
    if not shutil.which("chromedriver"):
        return
    for page in sorted((work / "pages").rglob("*.md")):
        for number, match in enumerate(PICTURE.finditer(page.read_text()), 1):
            if " --live " in match[1] and not DEA_HTML.exists():
                continue
            picture = page.with_name(f"{page.stem}_{number}.png")
            with tempfile.TemporaryDirectory(prefix="dea_picture_") as temporary:
                folder = pathlib.Path(temporary) / "run"
                shutil.copytree(SOURCE / "samples/hip", folder)
                program = make_gallery.with_page(build / "app/dea", DEA_HTML, folder.parent / "program")
                make_gallery.run(["sh", "-e", "-c", match[1]], folder, program, build / "python")
                make_gallery.photograph(folder / "page.html", picture)
            page.write_text(page.read_text().replace(match[0], f"![a page as the browser shows it]({picture.name})"))


def gallery(build, work):
    """The gallery's page with pictures, lines and downloads: what its examples make here."""
    folder = work / "pages/docs/gallery"
    faults = make_gallery.make(folder, build / "app/dea", build / "python", DEA_HTML)
    if faults:
        fail("\n".join(f"docs/gallery, {name}: {words}" for name, words in faults))
    text = []
    for e in make_gallery.examples():
        picture = next((name for name in (f"{e.name}.svg", f"{e.name}.png") if (folder / name).exists()), None)
        text += [f"## {e.title}", e.says, *([f"![{e.title}]({picture})"] if picture else []), f"```{e.language}\n{e.code}```",
                 f"[{e.path.name} and its files]({e.name}.zip)"]
    path = folder / "README.md"
    path.write_text(path.read_text() + "\n" + "\n\n".join(text) + "\n")


def cpp_reference(build, work):
    """Of the headers that are installed, by doxygen."""
    inputs = [SOURCE / "include", *sorted(folder for folder in (SOURCE / "src").iterdir() if folder.is_dir()), SOURCE / "io"]
    settings = [(HERE / "Doxyfile").read_text(), *(f'INPUT += "{path}"' for path in inputs), f'STRIP_FROM_PATH = "{SOURCE}"',
                f'INPUT_FILTER = "sed -f {HERE}/header.sed"', f'OUTPUT_DIRECTORY = "{work}/pages/reference"']
    run("doxygen", "-", input="\n".join(settings))


def python_reference(build, work):
    """Of the module that is built, by sphinx."""
    run("sphinx-build", "-q", "-W", "--keep-going", "-d", work / "doctrees", "-b", "html", HERE / "python", work / "pages/reference/python",
        env={**os.environ, "PYTHONPATH": str(build / "python"), "PYTHONDONTWRITEBYTECODE": "1"})
    (work / "pages/reference/python/.buildinfo").unlink()


def loaded(site):
    """What the pages would load from elsewhere: (page, address)."""
    tags = re.compile(r"""<(?:link|script|img|iframe|source|object|embed)\b[^>]*?\b(?:href|src|data)=["']?((?:https?:)?//[^"'\s>]+)""", re.I)
    styles = re.compile(r"""(?:url\(|@import )["']?((?:https?:)?//[^"')\s]+)""", re.I)
    for path in sorted(site.rglob("*")):
        if path.suffix in (".html", ".css", ".svg"):
            text = path.read_text(errors="replace")
            for address in (tags.findall(text) if path.suffix == ".html" else []) + styles.findall(text):
                yield path.relative_to(site), address


def mend_scripts(site):
    """Debian's theme names scripts that its package has not: another version of jQuery, and two that nothing needs."""
    jquery = next((site / "js").glob("jquery-*.min.js")).name

    def script(match, page):
        if (page.parent / match[1]).exists():
            return match[0]
        return match[0].replace(os.path.basename(match[1]), jquery) if "jquery" in match[1] else ""

    for page in site.rglob("*.html"):
        text = page.read_text(errors="surrogateescape")
        mended = re.sub(r'<script src="([^":]+)"[^>]*></script>', lambda match, page=page: script(match, page), text)
        if mended != text:
            page.write_text(mended, errors="surrogateescape")


def missing(site):
    """What pages load that is not there: (page, name)."""
    for page in sorted(site.rglob("*.html")):
        for name in re.findall(r"""<(?:script|img|link)\b[^>]*?\b(?:src|href)=["']([^"':?#]+)["'?#]""", page.read_text(errors="replace")):
            if not (page.parent / name).exists() and page.name != "404.html":
                yield page.relative_to(site), name


if len(sys.argv) != 2 or not (pathlib.Path(sys.argv[1]) / "CMakeCache.txt").is_file():
    sys.exit(__doc__)
build = pathlib.Path(sys.argv[1]).resolve()
for tool, package in (("mkdocs", "mkdocs"), ("doxygen", "doxygen"), ("sphinx-build", "python3-sphinx")):
    if not shutil.which(tool):
        fail(f"found no {tool}; on Debian: apt install {package}")
if not list((build / "python/febiodea").glob("_febiodea*.so")):
    fail(f"found no Python module in {build}/python; build it first")
work, site = build / "site_source", build / "site"
for folder in (work, site):
    shutil.rmtree(folder, ignore_errors=True)
gather(work)
gallery(build, work)
photographs(build, work)
(work / "pages/reference").mkdir()
cpp_reference(build, work)
python_reference(build, work)
run("mkdocs", "build", "--strict", "--quiet", "-f", work / "mkdocs.yml", "-d", site)
mend_scripts(site)
if lacking := [f"{page}: {name}" for page, name in missing(site)]:
    fail("pages load what is not there:\n" + "\n".join(lacking[:20]))
elsewhere = [f"{page}: {address}" for page, address in loaded(site)]
if elsewhere:
    fail("pages load what is elsewhere:\n" + "\n".join(elsewhere))
print(f"{site / 'index.html'}: {len(pages.pages(SOURCE))} pages, the C++ and the Python reference")
