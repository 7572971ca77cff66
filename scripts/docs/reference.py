#!/usr/bin/env python3
"""What comes from `pdxsolve -help -json` alone: the reference of options, a man page, completion for bash.

usage: reference.py [--executable build/release/pdxsolve] --out DIRECTORY
Writes options.md, pdxsolve.1 and pdxsolve.bash there, and a man page of each command of scripts/pdxtools, from the words that it
has of itself. Needs no packages.
"""

import argparse
import ast
import json
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
ALONE = {"OMPI_MCA_ess_singleton_isolated": "1", "OMPI_MCA_orte_create_session_dirs": "0", "OMPI_ALLOW_RUN_AS_ROOT": "1",
         "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}  # fmt: skip
ROOMS = {"scene": "Scene", "mesh": "Mesh", "material": "Material", "region": "Regions", "layout": "Patches that move", "pd": "Particles and bonds",
         "mpm": "Material points", "contact": "Contact", "couple": "Coupling", "xfem": "Cracks in elements", "crack": "Cracks",
         "bc": "Supports and loads", "load": "Load path", "ts": "Steps in time", "checkpoint": "Checkpoints", "post": "J, K and books",
         "probe": "Probes", "output": "Output"}  # fmt: skip
WORDS = ["-help", "-log_view", "-ksp_monitor", "-snes_monitor", "-options_left"]  # of PETSc, that many want
SHORT = """pdxsolve solves brittle fracture with finite elements, bond-based peridynamics and material points, coupled, in parallel.
A scene is an options file; every option of it can be overridden behind it. Lengths, forces and all else are in SI units; a unit
may stand directly behind a number (72GPa, 1mm, 20us)."""
STATUS = [("0", "done, or stopped by a signal with its results written"), ("1", "the input is wrong: one line says what, where and what to try"),
          ("2", "the solver failed: which step, why, what to try"), ("3", "the machine failed: a disk, memory, a lost rank")]  # fmt: skip
FILES = [("summary.json", "what the run was and what came out of it"), ("history.csv", "curves over time or load"),
         ("fields.h5, fields.xdmf", "fields, for ParaView and others"), ("probe_NAME.csv", "values at places"),
         ("crack_path.csv", "the way of each tip"), ("checkpoint.h5", "to go on from with -restart"),
         ("options.opts", "options as used; gives the run again"), ("citations.bib", "what to cite")]  # fmt: skip
INSTALLED = [("../share/doc/pdxsolve", "the tutorial and all other pages, from the directory of the program"),
             ("../share/pdxsolve", "cases, materials, and scripts for ParaView, Slurm and Open MPI on one machine")]  # fmt: skip
COMMANDS = ("report", "plot", "vtkhdf", "pack")  # of scripts/pdxtools, installed as pdxsolve-NAME


def all_options(executable):
    done = subprocess.run([executable, "-help", "-json"], capture_output=True, text=True, check=False, env=os.environ | ALONE)
    if done.returncode:
        sys.exit(f"reference.py: {executable} -help -json: {done.stderr.strip()}")
    return json.loads(done.stdout)


def by_room(options):
    rooms = {}
    for option in options:
        rooms.setdefault(option["room"], []).append(option)
    return rooms


def heading(room):
    return ROOMS.get(room, room)


def cell(text):
    return re.sub(r"([|*_<])", r"\\\1", text)


def page(options):
    lines = ["# Options", "", f"All {len(options)} options, as `pdxsolve -help` has them (this page is made from `pdxsolve -help -json`). "
             "`NAME` stands for a name that another option lists. Solver options are PETSc's: `-snes_...`, `-ksp_...`, `-pc_...`, "
             "`-mg_levels_...`, `-log_view`.", ""]  # fmt: skip
    for room, those in by_room(options).items():
        lines += [f"## {heading(room)}", "", "| option | what | unit | default | allowed |", "|---|---|---|---|---|"]
        for o in those:
            lines.append(f"| `{o['name']}` | {cell(o['help'])} | {cell(o['unit'])} | `{o['default']}` | {cell(o['allowed'])} |")
        lines.append("")
    return "\n".join(lines)


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text[:1] in ".'" else text


def man_page(options, version):
    lines = [f'.TH PDXSOLVE 1 "" "pdxsolve {version}" "User Commands"', ".SH NAME", "pdxsolve \\- brittle fracture with elements, peridynamics and material points",
             ".SH SYNOPSIS", ".B mpirun \\-n", ".I N", ".B pdxsolve \\-options_file", ".I case.opts", "[\\fIoption\\fR ...]",
             ".SH DESCRIPTION", *map(roff, SHORT.splitlines()), ".SH OPTIONS",
             "Options of PETSc's solvers are known too. NAME stands for a name that another option lists."]  # fmt: skip
    for room, those in by_room(options).items():
        lines.append(f".SS {roff(heading(room))}")
        for o in those:
            unit = f" [{o['unit']}]" if o["unit"] else ""
            lines += [".TP", f".B {roff(o['name'])}", roff(o["help"] + unit + "."), ".br", roff(f"Default {o['default']}; {o['allowed']}.")]
    lines += [".SH EXIT STATUS", *(line for status, what in STATUS for line in (".TP", f".B {status}", roff(what) + "."))]
    lines += [".SH FILES", "In \\fB\\-output_dir\\fR:", *(line for name, what in FILES for line in (".TP", f".I {roff(name)}", roff(what) + "."))]
    lines += ["Installed:", *(line for name, what in INSTALLED for line in (".TP", f".I {roff(name)}", roff(what) + "."))]
    lines += [".SH SEE ALSO", *(f".BR pdxsolve\\-{name} (1)," for name in COMMANDS), ".BR mpirun (1)"]
    return "\n".join(lines) + "\n"


def command_page(name, version):
    """Of a command, by what stands at the head of its file: what it does, then how it is called."""
    text = ast.get_docstring(ast.parse((ROOT / "scripts" / "pdxtools" / f"{name}.py").read_text(encoding="utf-8")))
    command = f"pdxsolve-{name}"
    what, _, usage = text.partition("\n\nusage: ")
    synopsis, _, rest = usage.format(name=command).partition("\n")
    first = re.match(r"[^.:]*", " ".join(what.split()))[0]
    lines = [f'.TH {command.upper()} 1 "" "pdxsolve {version}" "User Commands"', ".SH NAME",
             f"{roff(command)} \\- {roff(first[0].lower() + first[1:])}", ".SH SYNOPSIS", roff(synopsis),
             ".SH DESCRIPTION", *map(roff, what.splitlines())]  # fmt: skip
    if rest:
        lines += [".PP", ".nf", *map(roff, rest.splitlines()), ".fi"]
    return "\n".join(lines + [".SH SEE ALSO", ".BR pdxsolve (1)"]) + "\n"


def values_of(option):
    """The words that an option may be, if these are all."""
    words = option["allowed"].split(", ")
    return words if len(words) > 1 and all(re.fullmatch(r"[a-z][a-z_]*", word) for word in words) else []


def completion(options):
    """Names that stand for others are filled in by the user: `-bc_NAME_on` is completed as `-bc_`."""
    names = [option["name"].split("NAME")[0] for option in options] + WORDS
    cases = "".join(f"    {o['name']}) COMPREPLY=($(compgen -W '{' '.join(values_of(o))}' -- \"$word\")); return ;;\n"
                    for o in options if values_of(o) and "NAME" not in o["name"])  # fmt: skip
    return f"""# completion for bash of pdxsolve, made from pdxsolve -help -json
_pdxsolve()
{{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}}
  case $before in
{cases}    *_file|*_dir|-pd_cloud|-restart) COMPREPLY=($(compgen -f -- "$word")); return ;;
  esac
  COMPREPLY=($(compgen -W '{' '.join(dict.fromkeys(names))}' -- "$word"))
}}
complete -o default -F _pdxsolve pdxsolve
"""


def version_of():
    return re.search(r"project\(pdxsolve VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]


def write(executable, out):
    options = all_options(executable)
    out.mkdir(parents=True, exist_ok=True)
    texts = {"options.md": page(options), "pdxsolve.1": man_page(options, version_of()), "pdxsolve.bash": completion(options)}
    texts |= {f"pdxsolve-{name}.1": command_page(name, version_of()) for name in COMMANDS}
    for name, text in texts.items():
        (out / name).write_text(text, encoding="utf-8")
    return options


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--executable", default=str(ROOT / "build/release/pdxsolve"))
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    options = write(arguments.executable, arguments.out)
    print(f"wrote options.md, man pages and completion of {len(options)} options into {arguments.out}")


if __name__ == "__main__":
    main()
