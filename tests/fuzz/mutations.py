"""Damages inputs: text, bytes, HDF5 files. Every function takes a random.Random and gives another version of what it got.

Numbers are replaced by ones that are wrong at once or do no harm, never by such as only make a scene take long.
"""

import h5py
import numpy

WORDS = [
    "nan", "-nan", "inf", "-inf", "1e308", "-1e308", "1e-320", "1e999", "-1", "0", "-0", "0x10", "1e", "e5", "+", "-", "--", ".", ",", ",,",
    "99999999999", "-99999999999", "18446744073709551616", "3.7", "1,2,3,4,5,6,7", "1,,2", "0,", ", 0", "free", "true", "#", "!", "%", "=", '"',
    "'", "\\", "/dev/null", "/", ".", "~", "$HOME", "\u00e9", "\ufeff", "\u2212" + "1", "a" * 300, "9" * 5000, "x" * 70000, "1," * 3000, "\t", "%s%n",
    "\x1b[31m", "\x7f", "-name", "-mesh_cells", "@", "{}", "{0}", "$Nodes", "$EndNodes",
]  # fmt: skip
EDGES = [b"\xef\xbb\xbf", b"\xff\xfe", b"\0", b"\r", b"\n\n\n", b"#", b"\x1a"]
NUMBERS = [0.0, -1.0, float("nan"), float("inf"), -float("inf"), 1e308, -1e308, 1e-320, 0.5, 2.0**31, -(2.0**31), 2.0**63]


def text(random, data):
    """`data` (bytes of a text file) with one to three changes."""
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        data = random.choice(TEXT)(random, data)
    return data


def binary(random, data):
    for _ in range(random.choice((1, 1, 2, 4))):
        data = random.choice(BINARY)(random, data)
    return data


def span(random, size, most):
    """Some place in `size` bytes: begin and end."""
    begin = random.randrange(size + 1)
    return begin, min(size, begin + random.randrange(1, most + 1))


def flip(random, data):
    if not data:
        return b"?"
    at = random.randrange(len(data))
    return data[:at] + bytes([data[at] ^ (1 << random.randrange(8))]) + data[at + 1 :]


def cut_off(random, data):
    return data[: random.randrange(len(data) + 1)]


def remove(random, data):
    begin, end = span(random, len(data), 40)
    return data[:begin] + data[end:]


def repeat(random, data):
    begin, end = span(random, len(data), 40)
    return data[:end] + data[begin:end] * random.choice((1, 2, 50)) + data[end:]


def overwrite(random, data):
    """Four or eight bytes become a number at the edge of its type."""
    size = random.choice((4, 8))
    at = random.randrange(max(1, len(data) - size))
    value = random.choice((0, 1, 255, 2 ** (8 * size - 1) - 1, 2 ** (8 * size - 1), 2 ** (8 * size) - 1, 2 ** (8 * size - 2), random.getrandbits(8 * size)))
    number = value.to_bytes(size, "little")
    if size == 8 and random.random() < 0.3:
        number = numpy.float64(random.choice(NUMBERS)).tobytes()
    return data[:at] + number + data[at + size :]


def garble(random, data):
    begin, end = span(random, len(data), 16)
    return data[:begin] + bytes(random.getrandbits(8) for _ in range(end - begin)) + data[end:]


def put_at_an_edge(random, data):
    what = random.choice(EDGES)
    return what + data if random.random() < 0.5 else data + what


def change_line(random, data):
    """A line doubled, removed, moved, or its end taken away."""
    lines = data.split(b"\n")
    k, other = random.randrange(len(lines)), random.randrange(len(lines))
    what = random.randrange(5)
    if what == 0:
        lines.insert(k, lines[k])
    elif what == 1:
        del lines[k]
    elif what == 2:
        lines[k], lines[other] = lines[other], lines[k]
    elif what == 3:
        lines[k : k + 2] = [b" ".join(lines[k : k + 2])]
    else:
        lines[k] = random.choice((b"  ", b"\t", b"- ", b"-")) + lines[k]
    return b"\n".join(lines)


def change_word(random, data):
    """A word, often a number, becomes another, is doubled or vanishes."""
    words = data.replace(b",", b" , ").split(b" ") if random.random() < 0.5 else data.split(b" ")
    k = random.randrange(len(words))
    head, *tail = words[k].split(b"\n", 1)
    new = random.choice((random.choice(WORDS).encode(errors="surrogatepass"), head + b" " + head, b"", random.choice(WORDS).encode()))
    words[k] = b"\n".join([new, *tail])
    return b" ".join(words).replace(b" , ", b",")


def swap_sections(random, data):
    lines = data.split(b"\n")
    a, b, c = sorted(random.randrange(len(lines) + 1) for _ in range(3))
    return b"\n".join(lines[:a] + lines[b:c] + lines[a:b] + lines[c:])


def other_line_ends(random, data):
    return data.replace(b"\n", random.choice((b"\r\n", b"\r", b"\n\n", b" \n", b"")))


TEXT = [flip, cut_off, remove, repeat, garble, put_at_an_edge, change_line, change_line, change_word, change_word, change_word, change_word, swap_sections, other_line_ends]  # fmt: skip
BINARY = [flip, flip, cut_off, remove, repeat, overwrite, overwrite, overwrite, garble, put_at_an_edge]


def hdf5(random, path):
    """Changes a dataset of the file at `path` in place: values, shape, type, or that it is there."""
    with h5py.File(path, "r+") as file:
        name = random.choice(sorted(file))
        values = file[name][()]
        attributes = dict(file[name].attrs)
        what = random.randrange(7)
        if what == 0 and values.size:  # a value or all of them
            at = random.randrange(values.size) if random.random() < 0.7 else slice(None)
            values.reshape(-1)[at] = numpy.array(random.choice(NUMBERS)).astype(values.dtype)
        elif what == 1:
            values = values[: random.randrange(len(values) + 1)]
        elif what == 2:
            values = numpy.concatenate([values, values[: random.randrange(len(values) + 1)]])
        elif what == 3:
            values = values.reshape(-1) if random.random() < 0.5 else values[..., None]
        elif what == 4:
            values = values.astype(random.choice(("f4", "i4", "i8", "u1", "f8")))
        elif what == 5:
            values = random.choice((h5py.Empty("f8"), "text", 1.0, numpy.zeros((2, 2, 2)), numpy.array([b"a", b"bc"])))
        del file[name]
        if what == 6:
            random.choice((lambda: None, lambda: file.create_group(name), lambda: file.__setitem__(name, h5py.SoftLink("/" + name))))()
            return
        file[name] = values
        for key, value in attributes.items():
            if random.random() < 0.8:
                file[name].attrs[key] = value if random.random() < 0.8 else random.choice(NUMBERS)
