"""Pieces of a page that stands alone: text, tables, pictures inside it, no script, nothing to fetch."""

import base64
import html
import io
import re

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)

LOOK = """
:root { color-scheme: light; --ink: #1c2430; --pale: #5b6675; --line: #dde2e8; --back: #f6f7f9; --good: #1c7c3c; --bad: #b3261e;
  --warn: #8a5a00; }
* { box-sizing: border-box; }
body { margin: 0; font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; color: var(--ink); background: var(--back); }
main { max-width: 1100px; margin: 0 auto; padding: 24px 20px 60px; }
h1 { font-size: 26px; margin: 0 0 4px; overflow-wrap: anywhere; }
h2 { font-size: 18px; margin: 34px 0 10px; padding-top: 10px; border-top: 1px solid var(--line); }
p.sub { color: var(--pale); margin: 0 0 16px; }
nav a { margin-right: 14px; color: #2f5f98; }
.badge { display: inline-block; padding: 1px 10px; border-radius: 10px; color: white; background: var(--warn); font-size: 13px;
  vertical-align: middle; }
.badge.done { background: var(--good); } .badge.failed { background: var(--bad); }
.tiles { display: grid; grid-template-columns: repeat(auto-fill, minmax(150px, 1fr)); gap: 10px; }
.tile { background: white; border: 1px solid var(--line); border-radius: 6px; padding: 8px 12px; }
.tile b { display: block; font-size: 19px; } .tile span { color: var(--pale); font-size: 13px; }
.figures { display: grid; grid-template-columns: repeat(auto-fill, minmax(420px, 1fr)); gap: 12px; }
figure { margin: 0; background: white; border: 1px solid var(--line); border-radius: 6px; padding: 8px; }
figure.wide { grid-column: 1 / -1; }
figure svg, figure img { width: 100%; height: auto; display: block; }
figcaption { color: var(--pale); font-size: 13px; padding: 4px 4px 0; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; background: white; font-size: 14px; min-width: 50%; }
th, td { text-align: left; padding: 3px 12px 3px 8px; border-bottom: 1px solid var(--line); vertical-align: top; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
code, pre { font-family: ui-monospace, "DejaVu Sans Mono", monospace; font-size: 13px; }
td code { overflow-wrap: anywhere; }
pre { background: white; border: 1px solid var(--line); border-radius: 6px; padding: 10px; overflow-x: auto; }
ul.warnings { padding: 10px 10px 10px 30px; background: #fff6e0; border: 1px solid #e8cf95; border-radius: 6px; }
p.failed { padding: 10px; background: #fdeceb; border: 1px solid #e8b4b0; border-radius: 6px; }
details summary { cursor: pointer; color: #2f5f98; margin: 8px 0; }
@media (max-width: 480px) { .figures { grid-template-columns: 1fr; } }
@media print { body { background: white; } figure, table, .tile { break-inside: avoid; } }
"""


def text(value):
    return html.escape(str(value))


def code(value):
    return f"<code>{text(value)}</code>"


def number(value):
    """Six digits at most; whole numbers in groups of three."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return text(value)
    if isinstance(value, int) or (abs(value) < 1e15 and value == int(value)):
        return f"{int(value):,}".replace(",", "&#8239;")
    return f"{value:.6g}"


def table(rows, head=()):
    """Rows of cells that are HTML; a cell that is a number stands on the right."""

    def cell(value):
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return f'<td class="number">{number(value)}</td>'
        return f"<td>{value}</td>"

    top = "<thead><tr>" + "".join(f"<th>{text(name)}</th>" for name in head) + "</tr></thead>" if head else ""
    body = "".join("<tr>" + "".join(cell(value) for value in row) + "</tr>\n" for row in rows)
    return f'<div class="scroll"><table>{top}<tbody>\n{body}</tbody></table></div>'


def tiles(pairs):
    return '<div class="tiles">' + "".join(f'<div class="tile"><b>{b}</b><span>{text(name)}</span></div>' for name, b in pairs) + "</div>"


def folded(summary, inside):
    return f"<details><summary>{text(summary)}</summary>{inside}</details>"


def section(title, inside):
    """Nothing if there is nothing in it."""
    name = re.sub(r"\W+", "-", title.lower()).strip("-")
    return f'<section id="{name}"><h2>{text(title)}</h2>\n{inside}\n</section>\n' if inside else ""


def vector_picture(figure, count):
    """A figure as SVG inside the page. `count`: of the page, keeps names apart."""
    stream = io.StringIO()
    with plt.rc_context({"svg.fonttype": "none", "svg.hashsalt": "pdxtools"}):
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None, "Type": None, "Format": None})
    plt.close(figure)
    svg = stream.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    names = set(re.findall(r'\bid="([^"]+)"', svg))
    own = lambda match: f"{match[1]}{f'g{count}-' if match[2] in names else ''}{match[2]}{match[3]}"
    svg = re.sub(r'(\bid=")([^"]+)(")', own, svg)
    svg = re.sub(r'(href="#)([^"]+)(")', own, svg)
    return re.sub(r"(url\(#)([^)]+)(\))", own, svg)


def pixel_picture(figure, name):
    """A figure as PNG inside the page; its style is that of whoever drew it."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=150)
    plt.close(figure)
    return f'<img alt="{text(name)}" src="data:image/png;base64,{base64.b64encode(stream.getvalue()).decode()}">'


def captioned(picture, caption="", wide=False):
    return f"<figure{' class=wide' * wide}>{picture}{f'<figcaption>{text(caption)}</figcaption>' if caption else ''}</figure>"


def page(title, sections):
    """The whole document. Each section has a link at its top."""
    places = re.findall(r'<section id="([^"]+)"><h2>(.*?)</h2>', "".join(sections))
    links = "".join(f'<a href="#{place}">{name}</a>' for place, name in places)
    head, *rest = sections
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{text(title)}</title>\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<style>{LOOK}</style>\n</head>\n<body>\n<main>\n{head}<nav>{links}</nav>\n{''.join(rest)}</main>\n</body>\n</html>\n"
    )
