#!/usr/bin/env bash
# Makes docs/conformance.md from docs/conformance.tsv (the table of the rules of VRML97) and the names of cases in
# tests/. Prints how many rules pass, fail and are not done.
#
#   scripts/conformance.sh            writes docs/conformance.md
#   scripts/conformance.sh --check    writes nothing; fails if the file is out of date
#
# Exits with 1 if a row has no state, or is marked pass without an existing test.
set -eu
cd "$(dirname "$0")/.."
# The standard library is sufficient. Without site packages, Python starts faster.
exec python3 -I -S - "$@" <<'PYTHON'
import collections, fnmatch, pathlib, re, sys

TABLE, PAGE = pathlib.Path("docs/conformance.tsv"), pathlib.Path("docs/conformance.md")
KINDS = ["static", "dynamic", "navigation", "script", "sound"]
STATES = ["pass", "fail", "not done"]
problems = []

# Names of all cases, with the files that contain them. A name may consist of several literals.
cases = collections.defaultdict(set)
literal = r'"(?:[^"\\]|\\.)*"'
for file in sorted(pathlib.Path("tests").rglob("*.cpp")):
    for found in re.findall(r"\bTEST_CASE\(\s*(" + literal + r"(?:\s*" + literal + r")*)", file.read_text()):
        name = "".join(part[1:-1] for part in re.findall(literal, found))
        cases[re.sub(r"\\(.)", r"\1", name)].add(file.relative_to("tests").as_posix())


def matches(pattern):
    """Returns the tests that a pattern of the table names: pairs of file and title, or a file alone."""
    if pattern.startswith("tests/"):
        return [(pattern[len("tests/"):], "")] if pathlib.Path(pattern).is_file() else []
    if "*" not in pattern:
        return [(file, pattern) for file in sorted(cases.get(pattern, ()))]
    parts = re.compile(".*".join(re.escape(part) for part in pattern.split("*")) + r"\Z")
    return [(file, name) for name in sorted(cases) if parts.match(name) for file in sorted(cases[name])]


def cell(text):
    return text.replace("|", "\\|").replace("*", "\\*").replace("_", "\\_").replace("<", "&lt;")


counts = collections.Counter()
sections = []
seen = set()
for number, line in enumerate(TABLE.read_text().splitlines(), 1):
    if line.startswith("#:") or not line.strip():
        continue
    if line.startswith("#"):
        sections.append((line[1:].strip(), []))
        continue
    columns = (line.split("\t") + [""] * 6)[:6]
    clause, kind, state, rule, tests, remark = columns
    where = f"{TABLE}:{number}: "
    if line.count("\t") > 5:
        problems.append(where + "more than six columns")
    if not clause or not rule:
        problems.append(where + "no clause or no rule")
    if kind not in KINDS:
        problems.append(where + f"kind '{kind}'; expected one of {', '.join(KINDS)}")
    if state not in STATES:
        problems.append(where + f"state '{state}'; expected one of {', '.join(STATES)}")
    if (clause, rule) in seen:
        problems.append(where + "the rule stands there twice")
    seen.add((clause, rule))
    held = collections.OrderedDict()
    for pattern in filter(None, tests.split("; ")):
        found = matches(pattern)
        if not found:
            problems.append(where + f"no test '{pattern}'")
        for file, name in found:
            held.setdefault(file, []).append(name)
    if state == "pass" and not held:
        problems.append(where + "pass, but no test")
    if state == "fail" and not remark:
        problems.append(where + "fail, but no word on how")
    counts[kind, state] += 1
    names = []
    for file, of_file in held.items():
        of_file = list(dict.fromkeys(name for name in of_file if name))
        names.append(f"`{file}`" + (": " + ", ".join(f"\"{cell(name)}\"" for name in of_file) if of_file else ""))
    if not sections:
        sections.append(("", []))
    sections[-1][1].append(
        f"| {clause} | {kind} | {'**' + state + '**' if state == 'fail' else state} | {cell(rule)}"
        f"{' (' + cell(remark) + ')' if remark else ''} | {'<br>'.join(names)} |")

page = ["# Conformance with VRML97, rule by rule", "",
        "`scripts/conformance.sh` makes this page from `docs/conformance.tsv` and the titles of the tests; change those, not this",
        "page. Clauses are those of ISO/IEC 14772-1:1997; rules are in our own words. *pass*: the listed tests check the rule.",
        "*fail*: a test showed a violation, which the row describes. *not done*: all other rules, also working ones without a test.",
        "For some rules, Table 7-1 of the standard requires less.", "",
        "| kind | " + " | ".join(STATES) + " | all |", "| --- |" + " --: |" * (len(STATES) + 1)]
for kind in KINDS + ["all"]:
    row = [sum(n for (k, s), n in counts.items() if (kind == "all" or k == kind) and s == state) for state in STATES]
    page.append(f"| {kind} | " + " | ".join(map(str, row + [sum(row)])) + " |")
for title, rows in sections:
    page += ["", f"## {title}", "", "| clause | kind | state | rule | tests |", "| --- | --- | --- | --- | --- |"] + rows
text = "\n".join(page) + "\n"

if sys.argv[1:] == ["--check"]:
    if not PAGE.is_file() or PAGE.read_text() != text:
        problems.append(f"{PAGE} is stale: run scripts/conformance.sh")
elif sys.argv[1:]:
    sys.exit("usage: conformance.sh [--check]")
else:
    PAGE.write_text(text)
for problem in problems:
    print(problem)
if sys.argv[1:] != ["--check"]:
    print(", ".join(f"{sum(n for (_, s), n in counts.items() if s == state)} {state}" for state in STATES))
sys.exit(1 if problems else 0)
PYTHON
