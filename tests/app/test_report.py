"""The page of a run: one file that stands alone, with what the run left in it."""

import base64
import html.parser
import re
import subprocess
import sys

import program
from torn import TORN

FIELDS = {"-output_fields": "", "-output_interval": "200", "-output_history": ""}
ALONE = {"meta", "link", "br", "img", "hr", "input"}
SVG_ALONE = {"path", "use", "rect", "image", "circle"}


class Page(html.parser.HTMLParser):
    """Judges a page: every tag closed in order, every place of a link there once, nothing fetched from elsewhere."""

    def __init__(self, page):
        super().__init__()
        self.open, self.ids, self.links, self.fetched, self.images = [], [], [], [], []
        self.words, self.tables = "", []
        self.feed(page)
        self.close()

    def look(self, tag, attributes):
        for name, value in attributes:
            if name == "id":
                self.ids.append(value)
            elif name in ("href", "src", "xlink:href", "data", "poster", "srcset"):
                place = value.split(",")[0]
                (self.links if value.startswith("#") else self.images if place == "data:image/png;base64" else self.fetched).append(value)
            if name == "style" or tag == "script" or name.startswith("on"):
                self.fetched += re.findall(r"url\((?!#)[^)]*\)", value or "") + ([tag] if tag == "script" or name.startswith("on") else [])

    def handle_starttag(self, tag, attributes):
        self.look(tag, attributes)
        if tag == "table":
            self.tables.append([])
        if tag == "tr":
            self.tables[-1].append([])
        if tag in ("td", "th"):
            self.tables[-1][-1].append("")
        if tag not in ALONE:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.look(tag, attributes)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            raise AssertionError(f"</{tag}> at {self.getpos()} closes nothing")

    def handle_data(self, data):
        self.words += data
        if "td" in self.open or "th" in self.open:
            self.tables[-1][-1][-1] += data


class Report(program.ProgramTest):
    def report(self, directory, *words, status=0):
        command = [sys.executable, program.ROOT / "scripts" / "report.py", directory, *words]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def page(self, run):
        self.report(run.directory)
        page = Page((run.directory / "report.html").read_text(encoding="utf-8"))
        self.assertEqual((page.open, page.fetched), ([], []))
        self.assertEqual(len(page.ids), len(set(page.ids)))
        self.assertLessEqual({link[1:] for link in page.links}, set(page.ids))
        for image in page.images:
            self.assertEqual(base64.b64decode(image.split(",")[1])[:8], b"\x89PNG\r\n\x1a\n")
        return page

    def test_a_torn_plate_is_told_in_one_file(self):
        run = self.solve(TORN | FIELDS | {"-case": "a <torn> & 'marked' plate"})
        page = self.page(run)
        self.assertIn("a <torn> & 'marked' plate", page.words)
        for title in ("Curves", "Pictures", "Results", "Where time went", "Options", "Provenance", "How to cite"):
            self.assertIn(title, page.words)
        self.assertEqual(len(page.images), 4)  # displacement and damage, first and last
        for curve in ("Energies", "Length of cracks", "Broken bonds"):
            self.assertIn(curve, page.words)
        rows = {row[0]: row[1:] for table in page.tables for row in table if row}
        self.assertEqual(rows["-pd_spacing"], ["0.001", "command line"])
        self.assertEqual(float(rows["critical_stretch"][0].strip("()")), 0.01)
        self.assertEqual(rows["git"], [run.summary["provenance"]["git"]])
        self.assertEqual(rows["of particles"][0].replace("\u202f", ""), "6400")
        self.assertIn("10.1007/s00466-020-01843-z", page.words)
        self.assertIn("No warnings.", page.words)

    def test_warnings_and_runs_without_files_are_told(self):
        warned = self.launch(program.SMALL | {"-ts_max_time": "1"})
        self.assertEqual(warned.status, 0)
        self.assertIn("warning: ", warned.err)
        self.assertEqual(warned.summary["warnings"], [warned.err.strip().removeprefix("warning: ")])
        page = self.page(warned)
        self.assertIn(warned.summary["warnings"][0], page.words)
        self.assertIn("-output_fields writes it", page.words)
        self.assertIn("-output_history writes it", page.words)
        self.assertIn("not the output directory of a run", self.report(self.scratch, status=1).stderr)


if __name__ == "__main__":
    program.main()
