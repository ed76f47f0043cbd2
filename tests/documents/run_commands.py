#!/usr/bin/env python3
"""Runs the commands of a document to the letter and compares what they print.

Usage: run_commands.py PAGE.md PROGRAM [--top FOLDER]

All code blocks marked `sh` are run in their order, in one empty folder, with the folder of PROGRAM on
the search path. Those marked `python` are run in one Python process after them, in their order; the
packages NumPy, SciPy, pandas and others are imported, and a block is left out if one that it uses is
not installed. With --top, this folder has links to `cases` of FOLDER and to the folder `build` of
PROGRAM, as the top of the source tree has. A code block marked `text` that follows is the expected
output: its words appear in the output in this order. `...` stands for any words. Numbers agree within
5 %, because last digits differ between processors. For the same reason one verdict on a design
(converged, stagnated, unfinished) is as good as another, and exit code 5 of the program is accepted:
they say where the trajectory of an optimizer has ended.

Blocks after the line `<!-- not run by the test of documents: REASON -->` are not run.
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

TOLERANCE = 0.05
SKIP = re.compile(r"<!-- not run by the test of documents: .+ -->")
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w])")
VERDICT = re.compile(r"\b(converged|stagnated|unfinished)\b")
# The exit code 5 of the program says that a result is not as expected or not usable.
SHELL = """flexmorph() { command flexmorph "$@" || { code=$?; [ $code = 5 ] || return $code; }; }
"""


# Runs blocks in one Python process: each line of the standard input is a block in JSON; each line of
# the standard output tells whether it succeeded, and what it printed.
SESSION = """
import contextlib, importlib, io, json, re, sys, traceback
names = {"__name__": "__main__"}
absent = []
for module in ("numpy", "scipy.optimize", "matplotlib", "pandas", "meshio", "cyipopt", "nlopt"):
    try:
        importlib.import_module(module)
        names[module.split(".")[0]] = sys.modules[module.split(".")[0]]
    except ImportError:
        absent.append(module)
for line in sys.stdin:
    code, printed, good = json.loads(line), io.StringIO(), True
    missing = [name for name in absent if re.search(rf"\\b{name}\\.", code)]
    if missing:
        printed.write("left out: not installed: " + " ".join(missing))
    else:
        with contextlib.redirect_stdout(printed):
            try:
                exec(compile(code, "<block>", "exec"), names)
            except BaseException:
                good = False
                printed.write(traceback.format_exc())
    print(json.dumps([good, bool(missing), printed.getvalue()]), flush=True)
"""


class Block:
    """A code block that is run, and the text that it prints."""

    def __init__(self, line, mark, commands):
        self.line, self.mark, self.commands, self.expected = line, mark, commands, None


def blocks_of(text):
    """Returns the blocks of a page that are run."""
    out, skipped, mark, begin, lines = [], False, None, 0, []
    previous = None  # the block before, if nothing but empty lines follows it
    for number, line in enumerate(text.split("\n"), 1):
        if line.strip().startswith("```"):
            if mark is None:
                mark, begin, lines = line.strip()[3:].strip(), number, []
                continue
            if mark in ("sh", "python") and not skipped:
                previous = Block(begin, mark, "\n".join(lines))
                out.append(previous)
            elif mark == "text" and previous:
                previous.expected = "\n".join(lines)
                previous = None
            else:
                previous = None
            mark, skipped = None, False
        elif mark is not None:
            lines.append(line)
        elif line.strip():
            skipped = bool(SKIP.fullmatch(line.strip()))
            previous = None
    assert mark is None, "a code block is not closed"
    return out


def words_of(text):
    """Returns the words of a text, with the numbers of each word apart."""
    out = []
    for word in VERDICT.sub("VERDICT", text).split():
        out.append((NUMBER.sub("#", word), [float(n) for n in NUMBER.findall(word)]))
    return out


def agree(expected, found):
    """Tells whether two words agree within the tolerance."""
    return (expected[0] == found[0] and len(expected[1]) == len(found[1]) and
            all(abs(a - b) <= TOLERANCE * abs(a) for a, b in zip(expected[1], found[1])))


def missing_words(expected, output):
    """Returns the first words of the expected text that the output does not have; else None."""
    parts = [words_of(part) for part in re.split(r"(?<!\S)\(?\.\.\.\)?[,;:]?(?!\S)", expected)]
    found, at = words_of(output), 0
    for part in parts:
        for start in range(at, len(found) - len(part) + 1):
            if all(agree(e, f) for e, f in zip(part, found[start:start + len(part)])):
                at = start + len(part)
                break
        else:
            return " ".join(word for word, _ in part) + "\nwith the numbers " + str(
                [n for _, numbers in part for n in numbers])
    return None


class Session:
    """A Python process that runs the blocks of a page."""

    def __init__(self, folder, environment):
        self.process = subprocess.Popen([sys.executable, "-c", SESSION], cwd=folder, text=True,
                                        env={**environment, "MPLBACKEND": "agg"},
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def run(self, commands):
        """Runs a block and returns whether it succeeded, whether it was left out, and its output."""
        self.process.stdin.write(json.dumps(commands) + "\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def end(self):
        """Ends the process."""
        self.process.stdin.close()
        self.process.wait()


def run(block, folder, environment):
    """Runs a block and returns exit code and output. The environment is kept for the next block."""
    kept = folder.with_suffix(".environment")
    script = SHELL + block.commands + f"\nenv -0 > '{kept}'\n"
    done = subprocess.run(["bash", "-e", "-c", script], cwd=folder, env=environment, text=True,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode == 0:
        environment.clear()
        for entry in kept.read_text().split("\0"):
            name, separator, value = entry.partition("=")
            if separator and not name.startswith("BASH_FUNC"):
                environment[name] = value
        kept.unlink()
    return done.returncode, done.stdout


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--top", type=pathlib.Path)
    options = parser.parse_args()
    # The comparison must be able to refuse.
    assert missing_words("a 1.0 ... c stagnated, (...) d", "a 1.04 b c converged, (9 %) d") is None
    assert missing_words("a 1.0", "a 1.06") and missing_words("a ... b", "b a")
    blocks = blocks_of(options.page.read_text(encoding="utf-8"))
    assert blocks, "the page has no commands"
    program = options.program.resolve()
    # `python3` of the page is the Python that runs this test.
    python = pathlib.Path(sys.executable).parent
    environment = {**os.environ, "PATH": f"{program.parent}:{python}:{os.environ['PATH']}"}
    environment.pop("COLUMNS", None)
    failures = 0
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch) / "folder"
        folder.mkdir()
        if options.top:
            (folder / "cases").symlink_to(options.top.resolve() / "cases")
            (folder / "build").symlink_to(program.parents[1])
        session = None
        for block in sorted(blocks, key=lambda each: each.mark == "python"):
            print(f"{options.page.name}:{block.line}: {block.commands.splitlines()[0]}", flush=True)
            if block.mark == "python":
                session = session or Session(folder, environment)
                good, left_out, output = session.run(block.commands)
                code = 0 if good else 1
                if left_out:
                    print(output)
                    continue
            else:
                code, output = run(block, folder, environment)
            missing = missing_words(block.expected, output) if block.expected else None
            if code != 0:
                print(f"exit code {code}. The output is:\n{output}")
            elif missing:
                print(f"the output does not have these words:\n{missing}\nThe output is:\n{output}")
            failures += code != 0 or missing is not None
        if session:
            session.end()
    print(f"{len(blocks)} blocks, {failures} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
