"""The messages of errors and warnings as the sources have them, for the page on trouble: what stands in braces is filled in."""

import pathlib
import re

CALLS = r"(?:UserError|SolverFailure|MachineFailure|warn)\("
LITERAL = r'(?:[^\W\d]\w*)?"(?:[^"\\]|\\.)*"'
LEAST = 12  # characters of a message that says something


def text_of(literals):
    parts = re.findall(LITERAL, literals)
    return "".join(part[part.index('"') + 1 : -1].replace('\\"', '"').replace("\\n", " ") for part in parts)


def argument(source, begin):
    """What stands between the bracket before `begin` and the one that closes it; texts may have brackets."""
    depth, at = 1, begin
    while depth and at < len(source):
        if source[at] == '"':
            at = re.compile(r'"(?:[^"\\]|\\.)*"').match(source, at).end()
            continue
        depth += {"(": 1, ")": -1}.get(source[at], 0)
        at += 1
    return source[begin : at - 1]


def first_text(argument_text):
    """The texts that stand side by side at the first text of an argument."""
    match = re.search(rf"{LITERAL}(?:\s*{LITERAL})*", argument_text)
    return text_of(match[0]) if match else ""


def readable(message):
    """{:g}, {0} and {} alike as dots that something fills."""
    return re.sub(r"\{[^{}]*\}", "…", message).strip()


def of(sources):
    """Messages by room, each once, in order of the sources."""
    rooms = {}
    for path in sorted(pathlib.Path(sources).rglob("*.cpp")):
        source = path.read_text(encoding="utf-8")
        source = re.sub(r"//[^\n]*", "", re.sub(r'"(?:[^"\\\n]|\\.)*"|//[^\n]*', lambda m: m[0] if m[0][0] == '"' else "", source))
        for call in re.finditer(CALLS, source):
            message = readable(first_text(argument(source, call.end())))
            if len(message) >= LEAST:
                kind = call[0][:-1]
                rooms.setdefault(path.parent.name, {}).setdefault(message, kind)
    return rooms
