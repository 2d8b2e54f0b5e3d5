"""The pages of the site: which files of the project they are, and what they name. Standard library only.

A page names another one as one would type it, `docs/theory.md` or, from beside it, `theory.md`. On the site that is a link."""
import os
import re

NAMED = re.compile(r"(?<![`\[])`([\w./-]+\.md)`(?!`)")
LINKED = re.compile(r"\]\((?!\w+:)([^)\s]+)\)")  # but for those to other hosts


def pages(source):
    """Every page of the project, as paths from its root."""
    found = [*source.glob("*.md"), *(source / "docs").glob("*.md"), *source.glob("docs/*/*.md"), *source.glob("*/README.md"),
             *source.glob("io/*/README.md"), *source.glob("samples/*/README.md")]
    return sorted(path.relative_to(source).as_posix() for path in found if path.is_file())


def figures(source):
    """The pictures that pages show."""
    return sorted(path.relative_to(source).as_posix() for folder in ("docs/figures", "samples")
                  for path in (source / folder).rglob("*") if path.suffix in (".svg", ".png"))


def in_nav(source):
    """(title, place) of each line of the site's order."""
    nav = (source / "docs/site/mkdocs.yml").read_text().partition("\nnav:\n")[2]
    return [(title.strip('"'), place) for title, place in re.findall(r'^ +- ("[^"]+"|[^:"]+): +(\S+)$', nav, re.M)]


def meant(name, page, known):
    """The page that `name` means within `page`: one beside it, or one from the root; None: no page."""
    beside = os.path.normpath(os.path.join(os.path.dirname(page), name))
    return beside if beside in known else name if name in known else None


def for_mkdocs(text, page, known):
    """The text of a page in which the names of others are links, and code in tables has its strokes without a backslash."""

    def link(match):
        place = meant(match[1], page, known)
        if place is None or place == page:
            return match[0]
        return f"[{match[0]}]({os.path.relpath(place, os.path.dirname(page) or '.')})"

    in_tables = re.sub(r"^\|.*", lambda row: re.sub(r"`[^`]*`", lambda code: code[0].replace("\\|", "|"), row[0]), text, flags=re.M)
    return NAMED.sub(link, in_tables)
