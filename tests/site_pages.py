"""The pages as a site: python3 site_pages.py SOURCE. The order in docs/site/mkdocs.yml names every page once and nothing else; every
page that a page names or links to is there, and every picture; each page of docs begins with what it is for and a command; the Python
reference names every part of the module (without building it). The site itself is made by the target `site`, which needs more tools."""
import os
import pathlib
import re
import sys

source = pathlib.Path(sys.argv[1])
sys.dont_write_bytecode = True
sys.path.insert(0, str(source / "docs/site"))
import pages

GENERATED = ("reference/",)
known = set(pages.pages(source))
faults = []

nav = [place for _, place in pages.in_nav(source)]
written = [place for place in nav if not place.startswith(GENERATED)]
assert len(nav) - len(written) == 2, f"found {len(nav) - len(written)} references in the order of the site, expected those of C++ and Python"
faults += [f"docs/site/mkdocs.yml does not name {page}" for page in sorted(known - set(written))]
faults += [f"docs/site/mkdocs.yml names {place}, which is no page" for place in sorted(set(written) - known)]
faults += [f"docs/site/mkdocs.yml names {place} twice" for place in sorted({place for place in nav if nav.count(place) > 1})]

links = names = 0
for page in sorted(known):
    text = (source / page).read_text()
    for name in pages.NAMED.findall(text):
        names += 1
        if not pages.meant(name, page, known):
            faults.append(f"{page} names {name}, which is no page")
    for link in pages.LINKED.findall(text):
        links += 1
        place, _, heading = link.partition("#")
        target = source / os.path.normpath(os.path.join(os.path.dirname(page), place)) if place else source / page
        if not target.exists():
            faults.append(f"{page} links to {link}, which is not there")
        elif heading:  # as forges and mkdocs name headings
            headings = re.findall(r"^#+ (.+)$", target.read_text(), re.M)
            if heading not in {re.sub(r"\s+", "-", re.sub(r"[^\w\s-]", "", h).strip().lower()) for h in headings}:
                faults.append(f"{page} links to {link}, which is no heading there")
# A page of docs begins with what it is for, and the shortest command that is of use.
BEGINNING = re.compile(r"# .+\n\n(?![#>|*!\s-]|```|\d+\.)(?:\S.*\n)+\n(?:    (\S+) |```(python)\n)")
FIRST_WORDS = ("dea", "./dea", "cmake", "python")
manual = sorted(page for page in known if re.fullmatch(r"docs/[^/]+\.md", page))
assert len(manual) > 20, f"found {len(manual)} pages in docs"
for page in manual:
    begins = BEGINNING.match((source / page).read_text())
    if not begins or (begins[1] or begins[2]) not in FIRST_WORDS:
        faults.append(f"{page} does not begin with a title, one paragraph on what it is for, and a command")

# Doxygen takes <word> for a tag, and the site is not made.
for header in sorted([*source.glob("include/**/*.h"), *source.glob("src/**/*.h"), *source.glob("io/**/*.h")]):
    for number, line in enumerate(header.read_text().splitlines(), 1):
        said = re.search(r"//[/!]<? (.*)|^// (.*)", line)
        if said and re.search(r"<[a-z_]+>", re.sub(r"`[^`]*`|\"[^\"]*\"", "", said[1] or said[2] or "")):
            faults.append(f"{header.relative_to(source)}:{number}: write a name in angle brackets as code, in backquotes")

assert names > 100 and links > 20, f"found {names} names and {links} links in all pages: they are not read as they should be"

stages = re.search(r"__all__ = \[(.*?)\]", (source / "python/febiodea/__init__.py").read_text(), re.S)[1]
parts = set(re.findall(r'"(\w+)"', stages)) | {"statistics"}
listed = re.findall(r"^ *\.\. auto\w+:: febiodea\.(\w+)$", (source / "docs/site/python/index.rst").read_text(), re.M)
assert len(parts) > 30
faults += [f"docs/site/python/index.rst does not name febiodea.{part}" for part in sorted(parts - set(listed))]
faults += [f"docs/site/python/index.rst names febiodea.{part}, which is no part of it" for part in sorted(set(listed) - parts)]

print("\n".join(faults) or f"{len(known)} pages, {names} names of pages, {links} links")
sys.exit(bool(faults))
