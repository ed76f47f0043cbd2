#!/usr/bin/env python3
"""Shows that documents name keys that exist, and messages that the program has.

Usage: check_documents.py SOURCES PROGRAM

Every key in a code block marked `toml` of the pages in cases/docs is in the schema of the program.
Every text in a first column with the heading "message contains" or "warning contains" is in the source
code; `...` separates texts of one message.
"""

import json
import pathlib
import re
import subprocess
import sys
import tomllib


def unknown_keys(value, schema, path):
    """Returns the keys of a table or of a list of tables that the schema does not have."""
    out = []
    if isinstance(value, list):
        for entry in value:
            out += unknown_keys(entry, schema.get("items", {}), path)
    elif isinstance(value, dict) and "properties" in schema:
        rest = schema.get("additionalProperties")
        for key, entry in value.items():
            inner = schema["properties"].get(key, rest if isinstance(rest, dict) else None)
            if inner is None:
                out.append(f"{path}{key}")
            else:
                out += unknown_keys(entry, inner, f"{path}{key}.")
    return out


def texts_of(sources):
    """Returns all texts of the source code, those of neighbouring lines joined."""
    out = []
    for folder in ("cases", "fem", "geometry", "io", "optim"):
        for path in sorted((sources / folder).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                text = re.sub(r"//[^\n]*", "", path.read_text(encoding="utf-8"))
                text = re.sub(r'"\s*\n\s*"', "", text)
                out += re.findall(r'"((?:\\.|[^"\\\n])*)"', text)
    return "\n".join(out)


def messages_of(text):
    """Returns the texts of messages in the tables of a page."""
    out, in_table = [], False
    for line in text.split("\n"):
        cells = [cell.strip() for cell in line.strip().strip("|").split(" | ")]
        if not line.startswith("|"):
            in_table = False
        elif cells[0] in ("message contains", "warning contains"):
            in_table = True
        elif in_table and not cells[0].startswith("---"):
            out += [part.strip() for part in cells[0].split("...") if part.strip()]
    return out


def main():
    sources, program = pathlib.Path(sys.argv[1]), sys.argv[2]
    schema = json.loads(subprocess.run([program, "keys", "--schema"], capture_output=True, check=True,
                                       stdin=subprocess.DEVNULL).stdout)
    texts = texts_of(sources)
    n_blocks = n_messages = failures = 0
    for page in sorted((sources / "cases/docs").glob("*.md")):
        text = page.read_text(encoding="utf-8")
        for block in re.findall(r"^```toml\n(.*?)^```", text, re.M | re.S):
            n_blocks += 1
            for key in unknown_keys(tomllib.loads(block), schema, ""):
                print(f"{page.name}: there is no key {key}")
                failures += 1
        for message in messages_of(text):
            n_messages += 1
            if message.replace('"', '\\"') not in texts:
                print(f"{page.name}: the program has no message with: {message}")
                failures += 1
    # The checks must be able to refuse.
    assert unknown_keys({"time": {"stop": 1}}, schema, "") == ["time.stop"]
    assert unknown_keys({"body": [{"flow": {"speed": 1, "sped": 1}}]}, schema, "") == ["body.flow.sped"]
    print(f"{n_blocks} blocks, {n_messages} messages, {failures} failures")
    return 1 if failures or not n_blocks or not n_messages else 0


if __name__ == "__main__":
    sys.exit(main())
