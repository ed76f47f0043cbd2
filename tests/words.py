#!/usr/bin/env python3
"""Finds private words of former versions in names, comments, messages and documents.

Usage: tests/words.py [FOLDER]

FOLDER is the root of the source tree (default: the parent folder of this script). Every occurrence is
printed with file, line and the standard term. The exit code is 1 if there is one. CHANGES.md names old
keys and is left out, and so are files of tests/data that were written by former versions.
"""

import pathlib
import re
import sys

# Identifiers of the source code, as a whole -> the standard term.
NAMES = {
    r"Twin(Motion)?|twin\w*": "rigid kinematic model",
    r"Placed|Placement|place_bodies": "BodyPose, rigid initial configuration",
    r"Growth|growths_?": "MovingRoot",
    r"Carrier|carriers?_?": "DrivenFrame",
    r"ModelLink|PairLink|MeanForceLink|add_link|make_link": "force element",
    r"Whole|prepare_whole": "CacheCheckpoint, CombinedProblem",
    r"Memory|remember\w*|puts_back|TakeDown|take_down": "Archive, archive, checkpoint",
    r"Free(Line\w*|Tables?|Elastic|Inertia)|(\w+_)?free_lines": "Eulerian lines",
    r"Stored\w*|stored_(length|at|matrices)": "MaterialReservoir",
    r"CellFactors|Factors|FactorSlopes|by_factors": "CellScaleFactors, ScaleFactors, d_factors",
    r"slope_of|no_slopes|add_\w*slopes\w*|StateSlopes|\w+_slopes_": "gradient",
    r"Lanes|AllLanes|LanesOf": "Pack",
    r"Leg|kinks?|\w*_kinks?(_\w+)?|Landing|landings?": "segment, discontinuity, event time",
    r"Rest|rests|rest_(iterations|objective|kkt)": "stopping window, stagnation",
    r"sharp|sharp_(?!corner)\w+|blurred": "crisp, smoothed",
    r"[Jj]udges?|judged|judged_\w+|judges_\w+": "verification, quantity of interest, verdict",
    r"mend\w*|CleanUp|clean_up|UnderRepair|polishes": "post-processing",
    r"torn\w*|cuts_from_held|glued|kGlued": "unresolved gap, bridged by partly filled cells",
    r"idle\w*|\w+_idle|stubs": "unloaded component, dangling end",
    r"born|bear_parts|renewed_parts|join_parts|Turnover|drop_every|refill": "insertion, removal",
    r"NarrowPlaces?|narrow_places\w*|Widths": "LengthScaleViolation, MinimumWidths",
    r"n_pieces|n_omitted_pieces": "connected regions",
    r"Seat|MotionSeat|seats_?|Seen": "CoupledMotion, DesignView",
    r"held_expansion|MotionCertificate": "RestrainedExpansion, OptimalityCertificate",
    r"\w*Wishes|wish_?": "options, request",
    r"go_on_?|goes_on|going_?": "keep_running",
    r"Extent|extent_of|make_room|require_room|blas_room": "resource estimate",
    r"odd_\w+|knobs?|ladders?|rungs?|promises?|truths?": "plausibility, refinement series, level, target error, reference value",
    r"tell_story|\w+_words_?|words_of\w*": "run_case; text, message",
    r"(?!\w*InPlace)\w*[a-z]Place|Place|places?_?|places?_\w+|(?!\w*in_place)\w+_places?_?": "location, index",
    r"merit|look_at\w*|look_over|looks_?|recall|announce": "objective, analyse, restore, notify",
    r"shelf|wings?|halls?": "registry, module",
    r"kMost\w*|kAny|kNone|kOther|kFound|kTrace|kKnown|kWithin|kRoom|kFewest\w*|kLeast\w*": "a name that says of what: kMaxListed, kUnlimited",
    r"UnsymmetricSolver": "DirectSolver",
    r"freedoms?|pulsations?|(\w+_)?defect": "degrees of freedom, angular frequency, error",
    r"even_(mesh|lines|nodes|elements)|EvenMesh": "uniform mesh",
}
# Words of comments, messages and documents -> the standard term.
PROSE = {
    r"twins?": "rigid kinematic model",
    r"freedoms": "degrees of freedom",
    r"(?<!of )(?<!/ )freedom": "degree of freedom",
    r"sharp (compliance|volume|design|geometry|union|area|history|value|mass|cells|outlines?|one)s?": "crisp",
    r"blurred|unblurred": "smoothed",
    r"judge[sd]?": "verify, assess",
    r"told apart": "distinguishable",
    r"mend(s|ed|ing)?": "post-process",
    r"torn": "cut, separated",
    r"idle": "unloaded",
    r"stubs?": "dangling end",
    r"glued?": "bridged",
    r"born": "inserted",
    r"seats?": "body index",
    r"wings?|shel(f|ves)|halls?": "module",
    r"(?<!hi)stor(y|ies)": "run",
    r"knobs?": "discretization parameter",
    r"ladders?|rungs?": "refinement series, level",
    r"promise[sd]?": "target error",
    r"wish(es)?": "options",
    r"odd remarks": "plausibility checks",
    r"pulsations?": "angular frequency",
    r"kinks?": "discontinuity",
    r"even (mesh|rectangle|plate|material|beam)(es|s)?": "uniform",
    r"defect of the balance": "energy error",
    r"in parts of": "as a fraction of",
    r"hangs? together": "is connected",
}
FOLDERS = ("geometry", "io", "fem", "optim", "cases", "tests")
# Names of the last version that are read with a warning.
FORMER = re.compile(r'\.formerly\("[^"]*"\)|\.renames\(\{.*?\}\)', re.S)
TEXT = re.compile(r'(//[^\n]*|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*")')


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)
    names = [(re.compile(rf"\b(?:{k})\b"), v) for k, v in NAMES.items()]
    prose = [(re.compile(rf"(?<![\w.])(?:{k})(?!\w)", re.I), v) for k, v in PROSE.items()]
    words = re.compile(r"[A-Za-z_]\w*")
    known = {}  # what each identifier was found to be
    files = [root / "README.md"] + [f for folder in FOLDERS for f in sorted((root / folder).rglob("*")) if f.is_file()]
    read, found = 0, 0

    def search_names(path, text, first):
        nonlocal found
        for match in words.finditer(text):
            name = match.group()
            if name not in known:
                known[name] = next((term for p, term in names if p.fullmatch(name)), None)
            if known[name]:
                found += 1
                line = first + text.count("\n", 0, match.start())
                print(f"{path.relative_to(root)}:{line}: {name}: say {known[name]}")

    def search(path, text, first, patterns):
        nonlocal found
        for pattern, term in patterns:
            for match in pattern.finditer(text):
                line = first + text.count("\n", 0, match.start())
                found += 1
                print(f"{path.relative_to(root)}:{line}: {match.group()}: say {term}")

    for path in files:
        inside = str(path.relative_to(root))
        if inside.startswith("tests/data/") or inside in ("cases/CHANGES.md", "tests/words.py"):
            continue
        if path.suffix not in (".h", ".cpp", ".md", ".toml", ".cmake", ".txt", ".sh", ".py"):
            continue
        read += 1
        search_names(path, path.stem, 0)
        text = path.read_text(encoding="utf-8")
        if path.suffix in (".h", ".cpp"):
            text = FORMER.sub(lambda match: "\n" * match.group().count("\n"), text)
            line = 1
            for k, section in enumerate(TEXT.split(text)):
                if k % 2:
                    search(path, section, line, prose)
                else:
                    search_names(path, section, line)
                line += section.count("\n")
        else:
            search(path, text, 1, prose)
    print(f"{found} private words in {read} files")
    return 1 if found or read == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
