"""Makes one page of what a run left: sizes, results, curves, pictures, options, what made it, what to cite. The file stands
alone: nothing is fetched, so it can be sent or archived.

usage: {name} OUT_DIR [-o report.html] [--no-pictures]
"""

import argparse
import datetime
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)

from . import curves, draw  # noqa: E402
from .fields import NotThere, step_times  # noqa: E402
from .page import (captioned, code, folded, number, page, pixel_picture, section, table, text, tiles,  # noqa: E402
                   vector_picture)  # fmt: skip
from .records import read_citations, read_options, read_summary  # noqa: E402

PHASES = {"setup": "set-up", "solve": "solve, or steps", "output": "output", "total": "all"}
UNKNOWNS = {"fe": "of elements", "enriched": "of elements that cracks cut", "pd": "of particles", "mpm": "material points",
            "ghost": "ghosts", "total": "all"}  # fmt: skip
SEVERAL = 8  # numbers of a list that are shown


def seconds(value):
    if value < 1.0:
        return f"{1e3 * value:.0f} ms"
    return f"{value:.1f} s" if value < 120.0 else str(datetime.timedelta(seconds=round(value)))


def megabytes(size):
    return f"{size / 1e6:.1f} MB" if size >= 1e5 else f"{size / 1e3:.1f} kB"


def heading(run, summary):
    status = summary.get("status", "unknown")
    made = summary.get("provenance", {})
    stamp = datetime.datetime.fromtimestamp((run / "summary.json").stat().st_mtime, datetime.timezone.utc)
    title = f'<h1>{text(summary.get("case", run.name))} <span class="badge {text(status)}">{text(status)}</span></h1>'
    where = f"{made.get('host', 'unknown host')}, {summary.get('ranks', '?')} ranks, ended {stamp:%Y-%m-%d %H:%M} UTC, in {run}"
    return f'{title}\n<p class="sub">{text(where)}</p>\n'


def numbers_at_a_glance(summary):
    wall, pairs = summary.get("wall_seconds", {}), []
    if "total" in summary.get("unknowns", {}):
        pairs.append(("unknowns", number(summary["unknowns"]["total"])))
    for name, key in (("steps", "steps"), ("Newton iterations", "newton_iterations"), ("linear iterations", "linear_iterations"),
                      ("bonds broken", "bonds_broken"), ("changes of layout", "relocations")):  # fmt: skip
        if summary.get(key):
            pairs.append((name, number(summary[key])))
    if "total" in wall:
        pairs.append(("wall time", seconds(wall["total"])))
    if "peak_memory_mb" in summary:
        pairs.append(("memory of the largest rank", f"{summary['peak_memory_mb']:.0f} MB"))
    return section("At a glance", tiles(pairs))


def told(summary):
    """Why the run ended, and what it warned of."""
    message, warnings = summary.get("message", ""), summary.get("warnings")
    inside = f'<p class="{text(summary.get("status", ""))}">{text(message)}</p>' if message else ""
    if warnings:
        inside += '<ul class="warnings">' + "".join(f"<li>{text(line)}</li>" for line in warnings) + "</ul>"
    elif warnings is not None:
        inside += "<p>No warnings.</p>"
    else:
        inside += "<p>This run did not keep its warnings; they are in its log.</p>"
    return section("Warnings and end", inside)


def within(value):
    """What stands among others in a cell."""
    return number(value) if isinstance(value, (int, float)) else str(flat(value))


def flat(value):
    """A result as text in a cell, or a number."""
    if isinstance(value, dict):
        return ", ".join(f"{text(name)} {within(inner)}" for name, inner in value.items())
    if isinstance(value, list):
        shown = [within(inner) for inner in value[:SEVERAL]]
        inside = ", ".join(shown) + (f", ... {len(value)} in all" if len(value) > SEVERAL else "")
        return f"({inside})" if value and not isinstance(value[0], dict) else "<br>".join(shown)
    return value if isinstance(value, (int, float)) and not isinstance(value, bool) else text(value)


def results(summary):
    rows = [(code(name), flat(value)) for name, value in summary.get("results", {}).items()]
    return section("Results", rows and table(rows, ("name in summary.json, in SI units", "value")))


def curve_pictures(run):
    figures = [*curves.history_figures(run)]
    if cracks := curves.crack_figure(run):
        figures.append(cracks)
    figures += curves.probe_figures(run)
    inside = "".join(captioned(vector_picture(figure, count)) for count, figure in enumerate(figures))
    return section("Curves", f'<div class="figures">{inside}</div>' if inside else
                   "<p>No history.csv with two rows: <code>-output_history</code> writes it.</p>")  # fmt: skip


def picture_of(run, kind, number, name):
    with plt.rc_context(draw.STYLE | {"savefig.dpi": 150}):
        figure = draw.KINDS[kind]([draw.Run(run, number)], draw.Look())
        return captioned(pixel_picture(figure, name), name, figure.get_figwidth() > 2 * figure.get_figheight())


def moment(value, in_time):
    factor, unit = curves.prefixed(value, "s")
    return f"time {factor * value:.4g} {unit}" if in_time else f"load {value:.4g}"


def field_pictures(run):
    if not (run / "fields.h5").exists():
        return section("Pictures", "<p>No fields.h5: <code>-output_fields</code> writes it.</p>")
    times = step_times(run)
    in_time = "step_length" in read_summary(run).get("results", {})
    inside = ""
    for step in dict.fromkeys((0, len(times) - 1)):
        for kind, what in (("plate", "displacement"), ("damage", "damage")):
            try:
                inside += picture_of(run, kind, step, f"{what} at {moment(times[step], in_time)}")
            except NotThere:
                pass  # nothing that breaks, or nothing to draw yet
    return section("Pictures", f'<div class="figures">{inside}</div>' if inside else "")


def costs(run, summary):
    wall = summary.get("wall_seconds", {})
    rows = [(text(PHASES.get(name, name)), f"{value:.3f}", f"{100 * value / max(wall['total'], 1e-9):.1f} %") for name, value in
            sorted(wall.items(), key=lambda item: list(PHASES).index(item[0]) if item[0] in PHASES else 0)]  # fmt: skip
    inside = table(rows, ("phase", "seconds", "share")) if rows else ""
    events = [(code(name), count) for name, count in summary.get("events", {}).items()]
    return section("Where time went", inside + (folded("what was called how often", table(events, ("event", "times"))) if events else ""))


def sizes(run, summary):
    rows = [(text(UNKNOWNS.get(name, name)), count) for name, count in summary.get("unknowns", {}).items()]
    inside = table(rows, ("unknowns", "")) if rows else ""
    partition = summary.get("partition", {})
    if partition:
        inside += table([(text(name.replace("_", " ")), flat(value)) for name, value in partition.items()], ("partition", ""))
    files = [(code(path.name), megabytes(path.stat().st_size)) for path in sorted(run.iterdir()) if path.is_file()]
    return section("Sizes", inside + folded("files", table(files, ("file", "size"))))


def options_used(run):
    options = read_options(run)
    given = [(code(o.name), code(o.value), text(o.place)) for o in options if o.given]
    left = [(code(o.name), code(o.value), text(o.room)) for o in options if not o.given]
    if not options:
        return ""
    return section("Options", table(given, ("given", "value", "where"))
                   + folded(f"{len(left)} left at their defaults", table(left, ("option", "default", "room"))))  # fmt: skip


def what_made_it(summary):
    return section("Provenance", table([(text(name), text(value)) for name, value in summary.get("provenance", {}).items()]))


def citations(run):
    entries = read_citations(run)
    inside = "".join(f"<p>{text(why)}:</p><pre>{text(entry)}</pre>" for why, entry in entries)
    return section("How to cite", inside)


def report(run, pictures=True):
    """The page of a run, given its directory. NotThere if it has no summary.json."""
    run = pathlib.Path(run)
    summary = read_summary(run)
    if not summary:
        raise NotThere(f"{run} has no summary.json: not the output directory of a run that has ended")
    parts = [heading(run, summary), numbers_at_a_glance(summary), told(summary), curve_pictures(run)]
    parts.append(field_pictures(run) if pictures else "")
    parts += [results(summary), sizes(run, summary), costs(run, summary), options_used(run), what_made_it(summary), citations(run)]
    return page(f"pdxsolve: {summary.get('case', run.name)}", parts)


def main():
    name = pathlib.Path(sys.argv[0]).name
    parser = argparse.ArgumentParser(description=__doc__.format(name=name), formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", metavar="OUT_DIR", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, help="page to write (default: report.html in OUT_DIR)")
    parser.add_argument("--no-pictures", action="store_true", help="without pictures of the fields, which take longest")
    options = parser.parse_args()
    path = options.output or options.run / "report.html"
    try:
        path.write_text(report(options.run, not options.no_pictures), encoding="utf-8")
    except (NotThere, OSError, ValueError) as error:
        sys.exit(f"{name}: {error}")
    print(f"wrote {path}, {megabytes(path.stat().st_size)}")


if __name__ == "__main__":
    main()
