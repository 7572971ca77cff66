#!/usr/bin/env python3
"""Makes the documentation: the reference of options, the list of messages, the gallery of cases and the extension example from
what is in the tree, beside the pages that are written by hand; then the site, where MkDocs is installed (Debian: mkdocs).

usage: build.py [--executable build/release/pdxsolve] [--out build/docs] [--installed]
Writes OUT/pages (Markdown), man pages, OUT/pdxsolve.bash and OUT/site (HTML). A link between pages that leads nowhere is
an error. --installed: pages as they lie in share/doc/pdxsolve, to be read as text beside share/pdxsolve/cases; no site.
"""

import argparse
import pathlib
import re
import shutil
import subprocess
import sys

import messages
import reference

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
KINDS = {"UserError": "error, status 1", "SolverFailure": "error, status 2", "MachineFailure": "error, status 3", "warn": "warning"}
HEADS = {"app": "Scene and options", "base": "Values of options", "couple": "Between particles and elements", "crack": "Cracks",
         "io": "Files", "law": "Materials", "mesh": "Mesh", "mpm": "Material points", "pd": "Particles and bonds",
         "post": "J and K", "solve": "Solvers and steps", "xfem": "Cracks in elements", "adapt": "Patches that move",
         "coarse": "Coarse grid", "track": "Cracks that are followed", "field": "Rows", "fem": "Elements", "geom": "Geometry"}  # fmt: skip
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)#\s]+)(#[^)\s]*)?\)")


def messages_page():
    rooms = messages.of(ROOT / "src")
    count = sum(map(len, rooms.values()))
    lines = ["# Messages", "", f"The {count} messages of the program, from its sources. `…` is filled in: the option, the value, the place. "
             "Each says what is wrong, what is allowed and what to try; symptoms and remedies beyond that are under "
             "[When something goes wrong](trouble.md).", ""]  # fmt: skip
    for room, those in rooms.items():
        lines += [f"## {HEADS.get(room, room)}", ""]
        lines += [f"- `{message.replace('`', chr(39))}` ({KINDS[kind]})" for message, kind in those.items()]
        lines.append("")
    return "\n".join(lines)


def case_page(directory, pages):
    """The README of a case with its pictures and the options that it runs by; its title."""
    name = directory.name
    text = (directory / "README.md").read_text(encoding="utf-8")
    place = pages / "cases"
    place.mkdir(exist_ok=True)

    def moved(match):
        mark, words, target, anchor = match[1], match[2], match[3], match[4] or ""
        if re.match(r"\w+:", target):
            return match[0]
        file = (directory / target).resolve()
        if file.name == "README.md" and file.parent.parent == directory.parent:
            return f"{mark}[{words}]({file.parent.name}.md{anchor})"
        if file.suffix in (".png", ".gif") and file.is_file():
            shutil.copy(file, place / f"{file.parent.name}_{file.name}")
            return f"{mark}[{words}]({file.parent.name}_{file.name})"
        return words  # of files that the site has not

    text = LINK.sub(moved, text)
    main = next((directory / file for file in ("case.opts", "smoke.opts") if (directory / file).exists()), None)
    main = main or next(iter(sorted(directory.glob("*.opts"))), None)
    if main:
        text += f"\n\n## Options of {main.name}\n\n```\n{main.read_text(encoding='utf-8').rstrip()}\n```\n"
        for other in sorted(set(re.findall(r"(?m)^-options_file cases/" + name + r"/(\S+)", main.read_text(encoding="utf-8")))):
            text += f"\n`{other}`:\n\n```\n{(directory / other).read_text(encoding='utf-8').rstrip()}\n```\n"
    (place / f"{name}.md").write_text(text, encoding="utf-8")
    return re.search(r"(?m)^# (.*)", text)[1]


def cases_page(pages):
    """A line for each case, with what the table of the README says of it and its first picture."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    table = readme[readme.index("\n## Cases") :]
    shows = {}
    for row in re.findall(r"(?m)^\| (\[.*\]\(cases/.*?) \| (.*?) \| (.*?) \|$", table):
        for name in re.findall(r"cases/(\w+)/README.md", row[0]):
            shows[name] = row[2]
    lines = ["# Cases", "", "All are in `cases/`, with `check.py`, which asserts what must hold of them. They can be run from anywhere.", "",
             "| case | what it shows | |", "|---|---|---|"]  # fmt: skip
    for directory in sorted(path.parent for path in (ROOT / "cases").glob("*/README.md")):
        title = case_page(directory, pages)
        picture = next(iter(sorted((pages / "cases").glob(f"{directory.name}_*.png"))), None)
        shown = f'<img src="cases/{picture.name}" width="220" alt="">' if picture else ""
        lines.append(f"| [{directory.name}](cases/{directory.name}.md) | {shows.get(directory.name, title)} | {shown} |")
    return "\n".join(lines) + "\n"


def scenes_page():
    """What the README says of scenes, which is of steps in time too."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    text = readme[readme.index("\n## Scenes") : readme.index("\n## On a cluster")].replace("\n## Scenes", "\n## Options by what they say")
    text = re.sub(r"\]\(cases/(\w+)/README\.md", r"](cases/\1.md", text)
    return "# What a scene can say\nEach of these options has a line in the [reference](options.md), with units, defaults and allowed values.\n" + text


def extending_page():
    text = (HERE / "pages" / "extending.md").read_text(encoding="utf-8")
    for mark, file in (("EXAMPLE_CMAKE", "CMakeLists.txt"), ("EXAMPLE_SOURCE", "ground.cpp")):
        text = text.replace(mark, (HERE / "example" / file).read_text(encoding="utf-8").rstrip())
    return text


def dead_links(pages):
    """Links of pages that lead to no file of the site."""
    for page in sorted(pages.rglob("*.md")):
        text = re.sub(r"(?s)```.*?```", "", page.read_text(encoding="utf-8"))
        for match in LINK.finditer(text):
            if not re.match(r"\w+:", match[3]) and not (page.parent / match[3]).exists():
                yield f"{page.relative_to(pages)}: {match[3]}"


def install_pages(pages):
    """Links to cases lead to where those are installed; their pages and pictures are there, not here."""
    shutil.rmtree(pages / "cases")
    for page in pages.glob("*.md"):
        text = re.sub(r"\]\(cases/(\w+)\.md", r"](../../pdxsolve/cases/\1/README.md", page.read_text(encoding="utf-8"))
        page.write_text(re.sub(r"<img [^>]*>", "", text), encoding="utf-8")


def generate(executable, out):
    pages = out / "pages"
    shutil.rmtree(pages, ignore_errors=True)
    shutil.copytree(HERE / "pages", pages)
    reference.write(executable, out)
    (out / "options.md").replace(pages / "options.md")
    (pages / "messages.md").write_text(messages_page(), encoding="utf-8")
    (pages / "cases.md").write_text(cases_page(pages), encoding="utf-8")
    (pages / "scenes.md").write_text(scenes_page(), encoding="utf-8")
    (pages / "extending.md").write_text(extending_page(), encoding="utf-8")
    return pages


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--executable", default=str(ROOT / "build/release/pdxsolve"))
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build/docs")
    parser.add_argument("--installed", action="store_true", help="pages for share/doc/pdxsolve")
    arguments = parser.parse_args()
    out = arguments.out.resolve()
    pages = generate(arguments.executable, out)
    dead = list(dead_links(pages))
    if dead:
        sys.exit("build.py: links that lead nowhere: " + ", ".join(dead))
    if arguments.installed:
        install_pages(pages)
    print(f"wrote {sum(1 for _ in pages.rglob('*.md'))} pages into {pages}, man pages and completion beside")
    if arguments.installed:
        return
    if not shutil.which("mkdocs"):
        print("no site: MkDocs is not installed (Debian: mkdocs)")
        return
    config = (HERE / "mkdocs.yml").read_text(encoding="utf-8")
    config = config.replace("../../build/docs/pages", str(pages)).replace("../../build/docs/site", str(out / "site"))
    (out / "mkdocs.yml").write_text(config, encoding="utf-8")
    done = subprocess.run(["mkdocs", "build", "--strict", "--quiet", "--config-file", out / "mkdocs.yml"], check=False)
    if done.returncode:
        sys.exit("build.py: mkdocs refuses the pages (above)")
    print(f"wrote {out / 'site' / 'index.html'}")


if __name__ == "__main__":
    main()
