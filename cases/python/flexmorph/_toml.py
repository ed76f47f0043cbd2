"""Values and cases of Python as TOML text."""

import json
import math
import numbers
import re

_BARE = re.compile(r"[A-Za-z0-9_-]+\Z")


def value(of):
    """Return a value as TOML on one line."""
    if isinstance(of, str):
        return json.dumps(of, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(of, bool) or type(of).__name__ == "bool_":
        return "true" if of else "false"
    if isinstance(of, numbers.Integral):
        return str(int(of))
    if isinstance(of, numbers.Real):
        number = float(of)
        return repr(number) if math.isfinite(number) else str(number)
    if isinstance(of, dict):
        return "{" + ", ".join(f"{key(k)} = {value(v)}" for k, v in of.items()) + "}"
    try:
        return "[" + ", ".join(value(each) for each in of) + "]"
    except TypeError:
        raise TypeError(f"a case cannot contain the value {of!r} of the type {type(of).__name__}") from None


def key(name):
    """Return the name of a key, in quotes where TOML needs them."""
    return name if _BARE.match(name) else value(name)


def _is_tables(of):
    return isinstance(of, (list, tuple)) and len(of) > 0 and all(isinstance(e, dict) for e in of)


def document(table, path=""):
    """Return a dictionary as the text of a case file."""
    lines, tables = [], []
    for name, entry in table.items():
        full = path + key(name)
        if isinstance(entry, dict):
            tables.append(f"[{full}]\n" + document(entry, full + "."))
        elif _is_tables(entry):
            tables += [f"[[{full}]]\n" + document(each, full + ".") for each in entry]
        else:
            lines.append(f"{key(name)} = {value(entry)}\n")
    return "".join(lines + tables)


def changes(of):
    """Return overrides as texts KEY=VALUE; the value None removes a key."""
    return [f"{name}=" + ("" if entry is None else value(entry))
            for name, entry in (of or {}).items()]
