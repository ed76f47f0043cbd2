#!/usr/bin/env python3
"""Writes the declarations of types (.pyi) of the package flexmorph, for editors and type checkers.

Usage: make_declarations.py FILE

Signatures come from the functions, types from the sections Parameters, Returns and Attributes of
their docstrings, and the numbers of results from the schema of the program.
"""

import inspect
import re
import sys
import textwrap

import flexmorph

KNOWN = {"str": "str", "int": "int", "float": "float", "bool": "bool", "dict": "dict[str, Any]",
         "callable": "Callable[..., Any]", "numpy.ndarray": "numpy.ndarray",
         "array_like": "numpy.typing.ArrayLike", "list of str": "list[str]",
         "os.PathLike": "os.PathLike[str]", "None": "None"}
SECTION = re.compile(r"^(Parameters|Returns|Attributes|Raises|Notes)\n-+\n", re.M)


def annotation(words):
    """Return the annotation of a type in words, such as "str, os.PathLike or dict"."""
    words = words.replace(", optional", "").strip()
    if words.startswith("{"):
        return "Literal[" + words.strip("{}") + "]"
    known = {**KNOWN, **{name: name for name in flexmorph.__all__ if name[0].isupper()}}
    parts = [known.get(part.strip(), "Any") for part in re.split(r",? or |, ", words)]
    return "Any" if "Any" in parts else " | ".join(dict.fromkeys(parts))


def sections(of):
    """Return the sections of a docstring: name -> list of (names, type)."""
    parts = SECTION.split(inspect.getdoc(of) or "")
    out = {}
    for title, text in zip(parts[1::2], parts[2::2]):
        out[title] = re.findall(r"^(\*{0,2}[\w, ]+?) : (.*)$", text, re.M)
        if title == "Returns" and not out[title]:
            out[title] = [("", text.split("\n", 1)[0])]
    return out


def docstring(of, indent):
    text = inspect.getdoc(of)
    return textwrap.indent(f'"""{text}\n"""', indent) + "\n" if text else ""


def function(name, of, indent=""):
    """Return the declaration of a function."""
    found = sections(of)
    types = {n.strip(" *"): t for names, t in found.get("Parameters", []) for n in names.split(",")}
    optional = {n for n, t in types.items() if "optional" in t}
    parameters = []
    for parameter in inspect.signature(of).parameters.values():
        kind = annotation(types[parameter.name]) if parameter.name in types else "Any"
        if parameter.name in optional and parameter.default is None and kind != "Any":
            kind += " | None"
        parameters.append(parameter if parameter.name == "self"
                          else parameter.replace(annotation=kind, default=... if parameter.default
                                                 is not parameter.empty else parameter.empty))
    text = str(inspect.Signature(parameters)).replace("'", "").replace("Ellipsis", "...")
    returns = found.get("Returns")
    result = annotation(returns[0][1]) if returns else "Any"
    return f"{indent}def {name}{text} -> {result}:\n{docstring(of, indent + '    ')}{indent}    ...\n"


def describe(of):
    """Return the declaration of a class."""
    bases = ", ".join(b.__name__ for b in of.__bases__ if b is not object)
    lines = [f"class {of.__name__}({bases}):\n" if bases else f"class {of.__name__}:\n",
             docstring(of, "    ")]
    for names, kind in sections(of).get("Attributes", []):
        lines += [f"    {name.strip()}: {annotation(kind)}\n" for name in names.split(",")]
    for name, member in vars(of).items():
        if name.startswith("_"):
            continue
        if inspect.isfunction(member):
            lines.append(function(name, member, "    "))
        elif isinstance(member, property) and inspect.getdoc(member):
            lines.append(f"    @property\n    def {name}(self) -> Any:\n"
                         f"{docstring(member, '        ')}        ...\n")
    return "".join(lines) + "    ...\n"


def main():
    lines = ["import os\nfrom typing import Any, Callable, Literal\n\nimport numpy\nimport numpy.typing\n"]
    objects = [getattr(flexmorph, name) for name in flexmorph.__all__]
    for of in sorted(objects, key=lambda o: (not inspect.isclass(o), len(getattr(o, "__mro__", ())))):
        lines.append(describe(of) if inspect.isclass(of) else function(of.__name__, of))
    lines.append("__version__: str\n")
    with open(sys.argv[1], "w", encoding="utf-8") as file:
        file.write("\n\n".join(lines))


if __name__ == "__main__":
    main()
