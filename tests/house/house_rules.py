#!/usr/bin/env python3
"""Holds the source tree against the rules of the house.

usage: house_rules.py ROOT [LINKS]

ROOT is the project's root. LINKS is the file that link_graph.cmake writes at the end of a configuration: a line a
target, `NAME<TAB>FOLDER<TAB>LIBRARY;LIBRARY...`. Prints a line a violation and exits 1 when there is one.

Arrows mean "may include and link": tracker -> firmware_host, sdk; tracker/daemon -> navproto; viewer -> navproto, sdk;
tools and tests -> all. Within tracker a module may use only modules that its CMakeLists.txt adds before it.
"""
import re
import sys
from pathlib import Path

ARROWS = {
    "firmware_host": set(),
    "navproto": set(),
    "sdk": set(),
    "tracker": {"firmware_host", "sdk"},
    "tracker/daemon": {"firmware_host", "sdk", "navproto"},
    "viewer": {"navproto", "sdk"},
    "tools": {"firmware_host", "navproto", "sdk", "tracker", "viewer"},
    "tests": {"firmware_host", "navproto", "sdk", "tracker", "viewer", "tools"},
}
FOLDERS = [name for name in ARROWS if "/" not in name]
INSTALLED = {"navproto", "sdk"}  # others see only their <armature/FOLDER/...> headers
SOURCE_SUFFIXES = {".h", ".hpp", ".c", ".cpp", ".cc"}
TEXT_SUFFIXES = SOURCE_SUFFIXES | {".md", ".txt", ".cmake", ".json", ".toml", ".py", ".sh", ".fbs", ".in", ""}
MOST_LINES_OF_A_SOURCE = 600
MOST_LINES_OF_A_README = 40
MOST_LINES_OF_A_PANEL = 400
PANELS = Path("viewer/app/panels")
# What would let a panel change what is open by itself; lines of text alone do, so that a script can hold all of it.
CHANGE = re.compile(r"\bcommanded\b|\bexecute\(|(?<!const )\b(?:Session|Model|Selecting|Editing|SphereShape)&"
                    r"|models\[[^\]]*\]->[\w.]+ ?(?:[-+*/|&]?=(?!=)|\+\+)|(?:\+\+|--)[\w.]*models\[")
PAINTS = Path("viewer/render")
PAINTS_WITH = "armature/sdk/error.h"  # all that it may know of the sdk, which is about geometry
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')
DOCUMENT_LINK = re.compile(r"\]\(([^)\s]+)\)")
UNFINISHED = re.compile(r"\b(?:TO" r"DO|FIX" r"ME|XX" r"X)\b")
# clang 14, which builds the fuzzers and reads everything for clang-tidy, rejects what of libstdc++ 12 is a view.
VIEW = re.compile(r"\bstd::(?:views\b|ranges::(?:views|subrange|unique|rotate|remove|remove_if|partition|"
                  r"stable_partition|search|equal_range|find_end)\b)")
# What systemd says of our stderr is a fact, not a setting.
ENVIRONMENT = re.compile(r'\b(?:secure_)?getenv\b(?!\("JOURNAL_STREAM"\))')
SET_BY_ARGUMENTS = {"firmware_host", "navproto", "sdk", "tracker"}  # alone, so that a run can be done again
NAMESPACE = re.compile(r"^(?:namespace ([\w:]*) ?\{|\}  // namespace)")
TYPE = re.compile(r"^(?:struct|class|enum(?: class| struct)?|union) (?:(?:alignas\([^)]*\)|\[\[[^\]]*\]\]) )*"
                  r"(\w+)(?: final)?(?: :(?!:)[^;{]*)?(?: \{|$)")  # a list of bases may go on in the next line
MACHINE_PATH = re.compile(r"(?<![\w.}])/(?:wo" r"rk|ro" r"ot|ho" r"me)/\w")


def files_of(root):
    """Every text file of the project, in order, as paths relative to `root`."""
    def walk(folder):
        for entry in sorted(folder.iterdir()):
            if entry.name in {".git", ".cache", "build", "__pycache__"}:
                continue
            if entry.is_dir():
                yield from walk(entry)
            elif entry.suffix in TEXT_SUFFIXES and not entry.is_symlink():
                yield entry.relative_to(root)
    return list(walk(root))


def text_of(path):
    return path.read_text(encoding="utf-8", errors="replace")


def folder_of(path):
    """The folder whose arrows hold for a path: its top-level folder, or tracker/daemon."""
    parts = Path(path).parts
    return "tracker/daemon" if parts[:2] == ("tracker", "daemon") else parts[0]


def may_use(user, used):
    """Whether a file or target of folder `user` may use one of folder `used`."""
    if user == used or user not in ARROWS:
        return True
    if used not in ARROWS:
        return True
    if user.split("/")[0] == used.split("/")[0]:
        return used != "tracker/daemon"
    return used.split("/")[0] in ARROWS[user]


def tracker_order(root):
    """Rank of each module of tracker, as its CMakeLists.txt adds them; what lies in tracker/ itself comes after its
    stages, the daemon last."""
    cmake = root / "tracker" / "CMakeLists.txt"
    added = re.findall(r"^\s*add_subdirectory\((\w+)\)", text_of(cmake), re.M) if cmake.exists() else []
    stages = [name for name in added if name != "daemon"]
    return {name: rank for rank, name in enumerate(stages + ["", "daemon"])}


def tracker_module(path):
    """`forest` for tracker/forest/x.h, `` for tracker/pipeline.h, None outside tracker."""
    parts = Path(path).parts
    if parts[0] != "tracker":
        return None
    return parts[1] if len(parts) > 2 else ""


def includes_of(root, path):
    for number, line in enumerate(text_of(root / path).splitlines(), 1):
        if match := INCLUDE.match(line):
            yield number, match[1] == '"', match[2]


def resolved(root, quoted, name):
    """The project's file that an include names, relative to root; None where it is somebody else's."""
    if quoted:
        return Path(name) if (root / name).is_file() else None
    if name.startswith("armature/") and name.count("/") >= 2:
        return Path(name.split("/")[1]) / "include" / name
    return None


def against_order(order, user, used):
    """A message where tracker module of `user` may not use that of `used` (both paths), else None."""
    a, b = tracker_module(user), tracker_module(used)
    if a is None or b is None or a == b:
        return None
    for module in (a, b):
        if module not in order:
            return f"tracker/{module} is no module of tracker/CMakeLists.txt"
    if order[b] > order[a]:
        return f"tracker/{a} comes before tracker/{b}"
    return None


def check_includes(root, files):
    order = tracker_order(root)
    graph = {}
    for path in files:
        if path.suffix not in SOURCE_SUFFIXES or len(path.parts) < 2 or path.parts[0] not in FOLDERS:
            continue
        graph[path] = []
        for number, quoted, name in includes_of(root, path):
            where = f"{path}:{number}"
            used = resolved(root, quoted, name)
            if used is None:
                if quoted and not name.endswith("_generated.h"):
                    yield f'{where}: "{name}" is no path from the project\'s root'
                continue
            graph[path].append(used)
            if not may_use(folder_of(path), folder_of(used)):
                yield f"{where}: {folder_of(path)} may not include {used}"
            elif message := against_order(order, path, used):
                yield f"{where}: {message} and may not include {used}"
            top = used.parts[0]
            if quoted and top in INSTALLED and path.parts[0] not in {top, "tests"}:
                yield f"{where}: {top} is installed: include <armature/{top}/...>"
    yield from cycles(graph)


def cycles(graph):
    """Files that include each other in a circle."""
    done, trail = set(), []

    def visit(path):
        if path in trail:
            circle = trail[trail.index(path):] + [path]
            yield "include cycle: " + " -> ".join(map(str, circle))
            return
        if path in done:
            return
        trail.append(path)
        for used in graph.get(path, []):
            yield from visit(used)
        trail.pop()
        done.add(path)

    for path in sorted(graph):
        yield from visit(path)


def check_links(root, links):
    order = tracker_order(root)
    rows = [line.split("\t") for line in text_of(links).splitlines() if line]
    home = {name: Path(folder) for name, folder, _ in rows}
    if not home:
        yield f"{links}: names no target"
    for name, folder, libraries in rows:
        for used in sorted(set(re.findall(r"[\w.+-]+(?:::[\w.+-]+)?", libraries)) & set(home)):
            user_home, used_home = home[name], home[used]
            if user_home.parts[:1] == ("..",) or not user_home.parts or not used_home.parts:
                continue
            if not may_use(folder_of(user_home), folder_of(used_home)):
                yield f"{folder}/CMakeLists.txt: {name} may not link {used} of {used_home}"
            elif message := against_order(order, user_home / "x", used_home / "x"):
                yield f"{folder}/CMakeLists.txt: {message}: {name} may not link {used}"


def check_links_of(root, path, text):
    """Links of a document to files that are not there."""
    for target in DOCUMENT_LINK.findall(text):
        if "://" not in target and not target.startswith("#"):
            if not (root / path.parent / target.split("#")[0]).exists():
                yield f"{path}: links to {target}, which is not there"


def check_panel(path, lines):
    if len(lines) > MOST_LINES_OF_A_PANEL:
        yield f"{path}: a panel of {len(lines)} lines ({MOST_LINES_OF_A_PANEL} at most)"
    for number, line in enumerate(lines, 1):
        if CHANGE.search(line):
            yield f"{path}:{number}: a panel issues commands and changes nothing itself: {line.strip()}"


def check_house(root, files):
    for path in files:
        text = text_of(root / path)
        lines = text.splitlines()
        if path.suffix in {".h", ".hpp"} and "#pragma once" not in lines:
            yield f"{path}: has no #pragma once"
        if path.suffix in SOURCE_SUFFIXES and len(lines) > MOST_LINES_OF_A_SOURCE:
            yield f"{path}: {len(lines)} lines; split it ({MOST_LINES_OF_A_SOURCE} at most)"
        if path.name == "README.md" and len(path.parts) == 2 and len(lines) > MOST_LINES_OF_A_README:
            yield f"{path}: {len(lines)} lines ({MOST_LINES_OF_A_README} at most)"
        if path.suffix == ".md":
            yield from check_links_of(root, path, text)
        if path.suffix in SOURCE_SUFFIXES and path.parent == PANELS:
            yield from check_panel(path, lines)
        if path.suffix in SOURCE_SUFFIXES and path.parent == PAINTS:
            for number, _, name in includes_of(root, path):
                if name.startswith("armature/sdk/") and name != PAINTS_WITH:
                    yield f"{path}:{number}: paints, and leaves geometry to others: no {name}"
        if path.name == "LICENSE":
            continue
        for number, line in enumerate(lines, 1):
            if UNFINISHED.search(line):
                yield f"{path}:{number}: unfinished: {line.strip()}"
            if path.suffix in SOURCE_SUFFIXES and path.parts[0] != "tests" and VIEW.search(line):
                yield f"{path}:{number}: a view, which clang 14 rejects: {line.strip()}"
            if path.suffix in SOURCE_SUFFIXES and path.parts[0] in SET_BY_ARGUMENTS and ENVIRONMENT.search(line):
                yield f"{path}:{number}: a setting from the environment: {line.strip()}"
            if MACHINE_PATH.search(line):
                yield f"{path}:{number}: a path of one machine: {line.strip()}"
    for folder in FOLDERS:
        if (root / folder).is_dir() and not (root / folder / "README.md").is_file():
            yield f"{folder}: has no README.md"


def types_of(text):
    """Types that a source defines where others see their names: (namespace, name, line)."""
    spaces = []
    for number, line in enumerate(text.splitlines(), 1):
        if found := NAMESPACE.match(line):
            if line[0] == "}":
                del spaces[-1:]
            else:
                spaces.append(found[1])
        elif (found := TYPE.match(line)) and "" not in spaces:
            yield "::".join(spaces), found[1], number


def check_names(root, files):
    """Two types of one name in one namespace are undefined behaviour, which no linker reports."""
    first = {}
    for path in files:
        if path.suffix not in {".h", ".cpp"} or path.parts[0] not in FOLDERS or path.parts[0] == "tests":
            continue
        for space, name, line in types_of(text_of(root / path)):
            other = first.setdefault((space, name), path)
            if other != path:
                yield f"{path}:{line}: {space}::{name} is also the name of a type in {other}"


def violations(root, links=None):
    files = files_of(root)
    found = [*check_includes(root, files), *check_names(root, files), *check_house(root, files)]
    if links is not None:
        found += check_links(root, links)
    return found


def main(arguments):
    if not 2 <= len(arguments) <= 3:
        print(__doc__, file=sys.stderr)
        return 2
    found = violations(Path(arguments[1]), Path(arguments[2]) if len(arguments) == 3 else None)
    for message in found:
        print(message)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
