#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""links_test.py SOURCE: every link of README.md, CHANGELOG.md and docs leads to a file of the tree and to a heading in it, and every page
of docs is in the navigation of the site."""
import pathlib
import re
import sys

SOURCE = pathlib.Path(sys.argv[1])
PAGES = [SOURCE / "README.md", SOURCE / "CHANGELOG.md", *sorted((SOURCE / "docs").rglob("*.md"))]
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")


def without_code(text: str) -> str:
    return re.sub(r"`[^`\n]*`", "", re.sub(r"^( *)```.*?^\1```", "", text, flags=re.S | re.M))


def slugs(page: pathlib.Path) -> set[str]:
    """Anchors of the headings, as GitHub and the site make them."""
    text = re.sub(r"^( *)```.*?^\1```", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)
    found: set[str] = set()
    for heading in re.findall(r"^#+ +(.+?) *$", text, flags=re.M):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        slug = re.sub(r"[^\w\- ]", "", words).strip().replace(" ", "-")
        while slug in found:
            slug += "-1"
        found.add(slug)
    return found


wrong = []
for page in PAGES:
    for target in LINK.findall(without_code(page.read_text(encoding="utf-8"))):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        there = (page.parent / path).resolve() if path else page
        if not there.exists():
            wrong.append(f"{page.relative_to(SOURCE)}: {target} is not there")
        elif anchor and there.suffix == ".md" and anchor not in slugs(there):
            wrong.append(f"{page.relative_to(SOURCE)}: {target} has no such heading")
contents = (SOURCE / "docs/site/toctree.md").read_text(encoding="utf-8").splitlines()
for page in PAGES[2:]:
    name = str(page.relative_to(SOURCE / "docs").with_suffix(""))
    if name not in contents and name not in ("index", "site/toctree"):
        wrong.append(f"{page.relative_to(SOURCE)} is not in docs/site/toctree.md")
print("\n".join(wrong))
sys.exit(1 if wrong else 0)
