#!/usr/bin/env python3
"""Counts the public declarations of all headers and names those without a sentence of their own.

Usage: tests/declarations.py [FOLDER]

FOLDER is the root of the source tree (default: the parent folder of this script). The exit code is 1
if a declaration has no sentence.

A public declaration is a type, an alias, a function, a constant or a variable at namespace scope, or
a public member of a class. Left out are forward declarations, friends, overriding functions (the base
class documents them), constructors without parameters, and defaulted or deleted functions.
Overloads that follow each other share the comment of the first one.

A sentence begins with a capital letter, a digit or a symbol of mathematics, ends with a full stop or
with a colon before a formula, and does not begin with a word that refers to another comment ("Of
these", "The same"). That of a function begins with a verb in the third person ("Returns", "Adds");
that of a data member may be a noun phrase with its unit ("Length of the plate [m].").
"""

import pathlib
import re
import sys

FOLDERS = ("geometry", "io", "fem", "optim", "cases")
REFERRING = re.compile(
    r"(Of|Or|And|But|So|Such|That|Those|These|This one|Its|It|They|Them|Then|Likewise|Also|What|Whether|"
    r"Where|When|Which|How|Who|As|To|Same|The same|The other|Is it|Are they|Was the|Did|Does)\b")
VERB = re.compile(r"(~?[A-Z][a-z]*s)\b")
IGNORED = re.compile(r"\b(friend|static_assert|FLEXMORPH_[A-Z_]*)\b")


class Declaration:
    def __init__(self, line, kind, name, comment):
        self.line, self.kind, self.name, self.comment = line, kind, name, comment


def tokens(text):
    """Yields (line, kind, token): comments `///` ("doc") and `///<` ("after"), and code."""
    pattern = re.compile(
        r"(?P<after>///<[^\n]*(?:\n[ \t]*///<[^\n]*)*)"
        r"|(?P<doc>///[^\n]*)|(?P<skip>//[^\n]*|/\*.*?\*/)"
        r"|(?P<pre>^[ \t]*\#(?:[^\n\\]|\\\n|\\.)*)"
        r"|(?P<raw>R\"\((?:.|\n)*?\)\")|(?P<text>\"(?:\\.|[^\"\\])*\"|'(?:\\.|[^'\\])+')"
        r"|(?P<word>[A-Za-z_][A-Za-z_0-9]*|[0-9][0-9.'a-zA-Z]*)"
        r"|(?P<sign>::|->|\[\[|\]\]|&&|[^\sA-Za-z_0-9])|(?P<blank>\n[ \t]*\n)", re.S | re.M)
    for match in pattern.finditer(text):
        kind = match.lastgroup
        if kind in ("skip", "pre"):
            continue
        yield text.count("\n", 0, match.start()) + 1, kind, match.group()


def words_of(comment):
    text = " ".join(re.sub(r"^\s*///<?\s?", "", line) for line in comment.splitlines())
    return re.sub(r"\s+", " ", re.sub(r"^@(returns?|brief)\s+", "Returns ", text.strip()))


def fault(declaration):
    """Returns what is wrong with the comment of a declaration, or None."""
    if not declaration.comment:
        return "no comment"
    text = words_of(declaration.comment)
    head = re.split(r"@(?:param|throws|returns?|tparam)", text)[0].strip() or text
    if not re.match(r"[A-Z0-9@(\[|‖∂∫∑√α-ωΑ-Ω]|[a-z]\w* [=≤<>]", head):
        return "does not begin like a sentence"
    if REFERRING.match(head):
        return "begins like the end of another sentence"
    if not re.search(r"[.:](\s|$)", head):
        return "does not end like a sentence"
    if declaration.kind == "function" and not VERB.match(head):
        return "the sentence of a function begins with a verb in the third person"
    if declaration.kind in ("type", "function") and len(head.split()) < 4:
        return "fewer than four words"
    return None


def classify(code, class_name):
    """Returns (kind, name) of the tokens of one declaration, or None where none is counted."""
    if not code or IGNORED.search(" ".join(code)):
        return None
    # Template heads and attributes.
    while code and code[0] in ("template", "[["):
        if code[0] == "[[":
            code = code[code.index("]]") + 1:]
            continue
        depth, k = 0, 1
        while k < len(code):
            depth += {"<": 1, ">": -1}.get(code[k], 0)
            k += 1
            if depth == 0:
                break
        code = code[k:]
        if code and code[0] == "requires":
            return None
    if not code or code[0] in ("public", "private", "protected", "namespace", "extern"):
        return None
    if code[0] == "using":
        return ("type", code[1]) if "=" in code and code[1] != "namespace" else None
    if code[0] in ("struct", "class", "union", "enum"):
        names = [c for c in code[1:] if c not in ("class", "struct", "final")]
        if "{" in code or (":" in code and code[0] == "enum"):
            return "type", names[0] if names and names[0] != "{" else "(unnamed)"
        if len(code) <= 3:
            return None
    # The parameter list: the first parenthesis outside of <>.
    if "operator" in code and "=" in code[code.index("operator"):code.index("operator") + 2]:
        return None
    depth = 0
    for k, c in enumerate(code):
        if c == "<" and k and (re.match(r"\w", code[k - 1])):
            depth += 1
        elif c == ">" and depth:
            depth -= 1
        elif c in ("=", "{") and depth == 0:
            break
        elif c == "(" and depth == 0:
            if k == 0:
                return None
            name = code[k - 1]
            if "operator" in code[:k]:
                name = "operator" + "".join(code[code.index("operator") + 1:k])
            tail = code[k:]
            if "override" in tail or "final" in tail or "default" in tail or "delete" in tail:
                return None
            if k >= 2 and code[k - 2] == "~":
                return None
            if name == class_name:
                return None if code[k + 1] == ")" else ("constructor", name)
            return None if name == "operator=" else ("function", name)
    names = []
    for c in code:
        if c in ("=", "{", "["):
            break
        if re.match(r"[A-Za-z_]", c):
            names.append(c)
    return ("value", names[-1]) if len(names) > 1 else None


def declarations(text):
    """Yields the public declarations of a header."""
    stack = [("namespace", None, True)]  # (kind, name, public)
    code, comment, first, pending = [], "", 0, None
    stream = list(tokens(text))
    k, previous = 0, None

    def emit():
        nonlocal code, comment, previous
        kind, _, public = stack[-1]
        found = classify(code, stack[-1][1] if kind == "class" else None)
        out = None
        if found and public and all(s[2] for s in stack):
            about = comment
            if not about and previous and previous.name == found[1] and previous.kind == found[0]:
                about = previous.comment
            out = Declaration(first, found[0], found[1], about)
            previous = out
        code, comment = [], ""
        return out

    while k < len(stream):
        line, kind, token = stream[k]
        k += 1
        if kind == "doc":
            if not code:
                comment = comment + "\n" + token if comment else token
            continue
        if kind == "blank":
            if not code:
                comment = ""
            continue
        if kind == "after":
            target = pending if pending and not code else None
            if target is not None:
                target.comment = token
            elif code:
                comment = comment or token
            continue
        if not code:
            first = line
        if token == "}":
            if len(stack) > 1:
                stack.pop()
            code, comment = [], ""
            continue
        if token == ";":
            out = emit()
            pending = out
            if out:
                yield out
            continue
        if token == ":" and code in (["public"], ["private"], ["protected"]):
            stack[-1] = (stack[-1][0], stack[-1][1], code[0] == "public")
            code, comment = [], ""
            continue
        code.append(token)
        if token != "{":
            continue
        # What does this brace open?
        heads = [c for c in code]
        while heads and heads[0] == "template":
            depth, j = 0, 1
            while j < len(heads):
                depth += {"<": 1, ">": -1}.get(heads[j], 0)
                j += 1
                if depth == 0:
                    break
            heads = heads[j:]
        if heads[0] == "namespace":
            names = heads[1:-1]
            stack.append(("namespace", None, bool(names) and names[-1] not in ("detail", "internal")))
            code, comment = [], ""
            continue
        if heads[0] in ("struct", "class", "union") and "(" not in heads:
            out = emit()
            pending = None
            if out:
                yield out
            name = [h for h in heads[1:] if re.match(r"[A-Za-z_]", h)]
            stack.append(("class", name[0] if name else None, heads[0] != "class"))
            continue
        # A function body, an initializer or an enumeration: skipped to its end.
        is_member = len(heads) > 3 and heads[-3] in (":", ",") and ")" in heads and re.match(r"\w", heads[-2])
        depth = 1
        while k < len(stream) and depth:
            depth += {"{": 1, "}": -1}.get(stream[k][2], 0) if stream[k][1] == "sign" else 0
            k += 1
        is_function = "(" in heads and heads[0] != "enum" and (
            "operator" in heads or "=" not in heads[:heads.index("(")])
        if heads[0] == "enum":
            code = code + ["}"]
            continue
        if is_member:  # of a constructor: x_{...}
            continue
        if is_function and (k >= len(stream) or stream[k][2] not in (";", ",", ")")) and not (
                k < len(stream) and stream[k][2] == "{"):
            out = emit()
            pending = out
            if out:
                yield out
        elif is_function and k < len(stream) and stream[k][2] in (",",):
            continue
        # An initializer: its declaration ends with the semicolon.
    return


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)
    total, bad = 0, 0
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*.h")):
            for d in list(declarations(path.read_text(encoding="utf-8"))):
                total += 1
                what = fault(d)
                if what:
                    bad += 1
                    print(f"{path.relative_to(root)}:{d.line}: {d.name}: {what}")
    print(f"{bad} of {total} public declarations without a sentence")
    return 1 if bad or total == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
