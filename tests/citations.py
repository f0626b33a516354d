#!/usr/bin/env python3
"""Checks that what the project cites exists: documents, their sections, files, papers, tests.

  python3 tests/citations.py           looks at all sources, scripts and Markdown, and tests itself

A citation of a section is a document's name and its title in quotes, or several titles. A citation of a paper is a key of
REFERENCES.md in brackets. Code that theory.md links to from a section must cite that section. The names and numbers in the
rows of its table of constants must be in the code.
"""

from __future__ import annotations

import os
import re
import tempfile
import unittest
from functools import cache
from pathlib import Path
from typing import Iterator, NamedTuple

ROOT = Path(__file__).resolve().parent.parent

GENERATED = {"tables.md", "FILE.md", "results.md"}  # what lacuna-study writes
SKIPPED_FOLDERS = re.compile(r"\.(?!ci$).*|build.*|out|__pycache__|corpus|.*\.cache")
ENDINGS = {".h", ".cpp", ".py", ".sh", ".md", ".txt", ".html", ".css", ".js", ".cmake"}

MENTION = re.compile(r"(?<![\w./-])((?:[\w.-]+/)*[\w-]+\.md)\b(?!\w)")
GAP = r"[ \t]*(?:\n[ \t]*(?:///?|#|\*)?[ \t]*)?"  # a space, or the end of a comment's line
SECTIONS = re.compile(r'([\w./-]+\.md)((?:,' + GAP + r'"[^"]{1,120}")+)')
TITLE = re.compile(r'"([^"]+)"')
LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\[\]]*\])*\]\(([^()\s]+)\)")
BRACKETS = re.compile(r"(?<![\w\])])\[([A-Z][^\[\]]{2,120})\](?!\()")
PAPER = re.compile(r"[A-Z][A-Za-z-]*\d{2}[a-z]?(?=$|[\s,;])|[A-Z][\w-]+(?: et al\.| and [A-Z][\w-]+)? (?:19|20)\d\d(?=$|[\s,;])")
SOURCE = re.compile(r"(?<![\w./<*-])((?:[\w.-]+/)*[\w-]+\.(?:h|cpp|py|sh))\b(?!\w)")
TEST = re.compile(r"`([A-Z][a-z]\w*\.\w{6,})`")
CODE = re.compile(r"\]\(((?:\.\./)+[\w/]+\.(?:h|cpp))\)")  # of a section
NUMBER = re.compile(r"(?<![\w.])(?:0x[\da-fA-F.]+(?:p-?\d+)?|(?:\d[\d']*\.?\d*|\.\d+)(?:e-?\d+)?)")
DEFINED_TEST = re.compile(r"\bTEST(?:_F|_P)?\(\s*(\w+)\s*,\s*(\w+)\s*\)")


class Finding(NamedTuple):
    file: str
    line: int
    what: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.what}"


def one_line(text: str) -> str:
    return re.sub(r"\s*\n\s*(?:///?|#|\*)?\s*", " ", text)


def prose(markdown: str) -> str:
    """The text without code: blocks and spans become spaces, so that positions stay."""
    def blank(m: re.Match) -> str:
        return re.sub(r"[^\n]", " ", m.group())

    text = re.sub(r"^```.*?^```", blank, markdown, flags=re.S | re.M)
    text = re.sub(r"(?:\A|(?<=\n\n))(?:(?:    |\t).*\n|\n)+", blank, text)
    return re.sub(r"`[^`\n]*`", blank, text)


@cache
def headings(markdown: str) -> list[str]:
    return re.findall(r"^#{1,6} +(.*?) *#*$", re.sub(r"^```.*?^```", "", markdown, flags=re.S | re.M), re.M)


@cache
def anchors(markdown: str) -> set[str]:
    """Anchors, as GitHub names headings; a repeated title gets a number."""
    found: set[str] = set()
    for title in headings(markdown):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title).lower()
        name = re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")
        n = 0
        while (name if n == 0 else f"{name}-{n}") in found:
            n += 1
        found.add(name if n == 0 else f"{name}-{n}")
    return found


class Section(NamedTuple):
    title: str
    above: str  # the title of the section that it is a part of, or its own
    begin: int
    text: str


def sections_of(markdown: str) -> list[Section]:
    """The sections, from one heading of the second level or below to the next."""
    found: list[Section] = []
    above = ""
    starts = [m.start() for m in re.finditer(r"^##+ ", markdown, re.M)] + [len(markdown)]
    for begin, end in zip(starts, starts[1:]):
        level, title = re.match(r"(#+) +(.*)", markdown[begin:end]).groups()
        above = title if level == "##" else above
        found.append(Section(title, above, begin, markdown[begin:end]))
    return found


def numbers(code: str) -> set[float]:
    def value(number: str) -> float:
        plain = number.replace("'", "")
        return float.fromhex(plain) if plain.startswith("0x") else float(plain)

    return {value(m.group()) for m in NUMBER.finditer(code)}


class Project:
    def __init__(self, root: Path):
        self.root = root
        self.files: dict[str, str] = {}
        for folder, folders, names in os.walk(root):
            folders[:] = sorted(f for f in folders if not SKIPPED_FOLDERS.fullmatch(f))
            for name in sorted(names):
                path = Path(folder) / name
                if path.suffix in ENDINGS or path.parent.name == ".ci":
                    key = path.relative_to(root).as_posix()
                    self.files[key] = path.read_text(encoding="utf-8", errors="replace")
        self.documents = {name for name in self.files if name.endswith(".md")}
        self.keys = self.papers()
        self.surnames = {re.match(r"[A-Z][A-Za-z-]*?(?=\d| |$)", key).group() for key in self.keys}
        self.tests = {f"{a}.{b}" for name, text in self.files.items() if name.startswith("tests/")
                      for a, b in DEFINED_TEST.findall(text)}

    def papers(self) -> set[str]:
        rows = re.findall(r"^\| *([^|]+?) *\|", self.files.get("REFERENCES.md", ""), re.M)
        return {row for row in rows if PAPER.match(row)}

    def document(self, name: str, file: str) -> str | None:
        """The document that `file` means by `name`: beside it, from the root, or the only one of that name."""
        for base in (Path(file).parent, Path(".")):
            path = os.path.normpath((base / name).as_posix())
            if path in self.documents:
                return path
        ending = [d for d in self.documents if ("/" + d).endswith("/" + name)]
        return ending[0] if len(ending) == 1 else None

    def findings(self) -> Iterator[Finding]:
        for file, text in self.files.items():
            if file == "tests/citations.py":
                continue
            checks = [self.mentions, self.sections, self.cited_papers]
            if file.endswith(".md"):
                checks += [self.links, self.sources, self.named_tests]
            if Path(file).name == "theory.md":
                checks += [self.citations_back, self.constants]
            for check in checks:
                for at, what in check(file, text):
                    yield Finding(file, text.count("\n", 0, at) + 1, what)

    def mentions(self, file: str, text: str) -> Iterator[tuple[int, str]]:
        for m in MENTION.finditer(text):
            name = m.group(1)
            if Path(name).name in GENERATED:
                continue
            if self.document(name, file):
                number = re.match(r" \d[\d, -]*", text[m.end():m.end() + 12])
                if number:
                    yield m.start(), f"{name}{number.group().rstrip(', -')}: expected a section's title, found a number"
                continue
            if any(("/" + d).endswith("/" + name) for d in self.documents):
                yield m.start(), f"{name}: expected which of several, found its name alone"
            else:
                yield m.start(), f"{name}: no such document"

    def sections(self, file: str, text: str) -> Iterator[tuple[int, str]]:
        for m in SECTIONS.finditer(text):
            document = self.document(m.group(1), file)
            for title in map(one_line, TITLE.findall(m.group(2))):
                if document and title not in (re.sub("`", "", t) for t in headings(self.files[document])):
                    yield m.start(), f'{document} has no section "{title}"'

    def cited_titles(self, source: str, document: str) -> set[str]:
        return {one_line(title) for m in SECTIONS.finditer(self.files[source])
                if self.document(m.group(1), source) == document for title in TITLE.findall(m.group(2))}

    def citations_back(self, file: str, text: str) -> Iterator[tuple[int, str]]:
        """Finds code that a section links to and that cites neither this section nor another one that links to it."""
        places: dict[str, int] = {}
        titles: dict[str, set[str]] = {}
        for section in sections_of(text):
            for m in CODE.finditer(section.text):
                source = os.path.normpath((Path(file).parent / m.group(1)).as_posix())
                if source in self.files:  # links() says so of others
                    places.setdefault(source, section.begin + m.start())
                    titles.setdefault(source, set()).update({section.title, section.above})
        for source, expected in titles.items():
            if not self.cited_titles(source, file) & expected:
                yield places[source], f'{source} does not cite {" or ".join(sorted(expected))}'

    def constants(self, file: str, text: str) -> Iterator[tuple[int, str]]:
        """Checks rows `NAME` numbers, `NAME` numbers; numbers | file, file | ..: the code of these files must have
        them."""
        table = next((s for s in sections_of(text) if s.title == "Constants"), None)
        for m in re.finditer(r"^\| *(.*?) *\| *(.*?) *\|", table.text if table else "", re.M):
            if m.group(1) == "constant" or not m.group(1).strip("-"):
                continue
            place = table.begin + m.start()
            code = ""
            for name in re.split(r",\s*", m.group(2)):
                found = [f for f in self.files if ("/" + f).endswith("/" + name)]
                if len(found) != 1:
                    yield place, f"{name}: expected one source, found {len(found)}"
                    continue
                code += self.files[found[0]] + ";"
                if not self.cited_titles(found[0], file):
                    yield place, f"{found[0]} does not cite {file}"
            yield from ((place, fault) for fault in self.constants_of(m.group(1), code))

    @staticmethod
    def constants_of(cell: str, code: str) -> Iterator[str]:
        """What `code` lacks. The numbers after a name, up to a semicolon, must be in one statement with it."""
        absent = "not in the code that the row names"
        for name, rest in re.findall(r"(?:`(\w+)`)?([^`]+|(?<=`)$)", cell):
            with_name, _, alone = rest.partition(";") if name else ("", "", rest)
            statements = re.findall(rf"\b{name}\b[^;]*", code) if name else []
            if name and not statements:
                yield f"`{name}`: {absent}"
            for number in sorted(numbers(with_name) - numbers(" ".join(statements)) if statements else ()):
                yield f"{number:g} of `{name}`: {absent}"
            for number in sorted(numbers(alone) - numbers(code) if numbers(alone) else ()):
                yield f"{number:g}: {absent}"

    def links(self, file: str, text: str) -> Iterator[tuple[int, str]]:
        for m in LINK.finditer(prose(text)):
            target, _, anchor = m.group(1).partition("#")
            if re.match(r"[a-z]+:", target):
                continue
            path = os.path.normpath((Path(file).parent / target).as_posix()) if target else file
            if not (self.root / path).exists():
                yield m.start(), f"link to {m.group(1)}: no such file"
            elif anchor and anchor not in anchors(self.files.get(path, "")):
                yield m.start(), f"link to {m.group(1)}: no such section"

    def sources(self, file: str, text: str) -> Iterator[tuple[int, str]]:
        for m in SOURCE.finditer(text):
            name = m.group(1)
            beside = os.path.normpath((Path(file).parent / name).as_posix())
            if re.search(r"(?<![A-Za-z])[A-Z]{4,}(?![A-Za-z])", name) or beside in self.files:
                continue  # FOLDER/NAME_test.cpp stands for many
            if not any(("/" + f).endswith("/" + os.path.normpath(name)) for f in self.files):
                yield m.start(), f"{name}: no such source"

    def cited_papers(self, file: str, text: str) -> Iterator[tuple[int, str]]:
        for m in BRACKETS.finditer(text):
            for piece in one_line(m.group(1)).split(";"):
                piece = piece.strip()
                key = PAPER.match(piece)
                if key and key.group() not in self.keys:
                    yield m.start(), f"[{piece}]: no such key in REFERENCES.md"
                elif not key and re.match(r"[A-Z][A-Za-z-]*(?=$| [\d(]| p\.| eq| fig| sec)", piece) \
                        and piece.split()[0] in self.surnames:
                    yield m.start(), f"[{piece}]: expected a key of REFERENCES.md, found a name"

    def named_tests(self, file: str, text: str) -> Iterator[tuple[int, str]]:
        for m in TEST.finditer(text):
            if m.group(1) not in self.tests:
                yield m.start(), f"{m.group(1)}: no such test"


class Citations(unittest.TestCase):
    def test_all_are_there(self):
        found = list(Project(ROOT).findings())
        self.assertEqual(found, [], "\n" + "\n".join(map(str, found)))

    def test_methods_and_their_parts_cite_their_theory(self):
        for pattern in ("libcore/methods/*.cpp", "libcore/resampling/*.h", "libcore/subspace/*.h"):
            for path in sorted(ROOT.glob(pattern)):
                if path.name != "registry.cpp":
                    with self.subTest(path.name):
                        self.assertRegex(path.read_text(encoding="utf-8"), r"theory\.md," + GAP + '"')

    def test_every_section_of_the_theory_names_its_files(self):
        text = (ROOT / "libcore/doc/theory.md").read_text(encoding="utf-8")
        for section in re.split(r"^## ", text, flags=re.M)[1:]:
            title = section.split("\n", 1)[0]
            if title not in ("Symbols", "Constants"):
                with self.subTest(title):
                    self.assertRegex(section, r"\]\((?:\.\./)+[\w/]+\.(?:h|cpp)\)")


class Planted(unittest.TestCase):
    """A small project with one fault at a time."""

    GOOD = {
        "REFERENCES.md": "# References\n\n| key | |\n|---|---|\n| Su22 | Su. |\n| Duff et al. 2017 | Duff. |\n",
        "doc/theory.md": "# Theory\n\n## Cache points\n\nSee [here](#cache-points), [there](../src/a.cpp), `Suite.testsThis`.\n"
                         "\n### Lens points\n\n## Constants\n\n| constant | where | why |\n|---|---|---|\n"
                         "| `kLeast` 1e-3, `kMost` 1/16; 10000 | src/a.cpp | so |\n",
        "src/a.cpp": '// (theory.md,\n// "Cache points"), [Su22 eq 11, 12], [Duff et al. 2017]; README.md; x[Index12]\n'
                     "const double kLeast = 0.001f;\nconst double kMost = 1.0 / 16;\nint n = 10'000;\n",
        "src/README.md": "# Source\n\n[theory](../doc/theory.md#cache-points)\n",
        "tests/a.cpp": "TEST(Suite, testsThis) {}\n",
    }

    def faults(self, **changes: str) -> list[str]:
        with tempfile.TemporaryDirectory() as folder:
            for name, text in (self.GOOD | {k.replace("__", "/"): v for k, v in changes.items()}).items():
                path = Path(folder) / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            return [str(f) for f in Project(Path(folder)).findings()]

    def only(self, fault: str, text: str, file: str = "src/b.cpp"):
        found = self.faults(**{file.replace("/", "__"): text})
        self.assertEqual(len(found), 1, found)
        self.assertIn(fault, found[0])

    def test_what_is_right_is_not_found(self):
        self.assertEqual(self.faults(), [])

    def test_a_document(self):
        self.only("src/b.cpp:2: methods.md: no such document", "int x;\n// as methods.md says\n")

    def test_a_document_by_its_folder(self):
        self.only("render/README.md: no such document", "// render/README.md\n")

    def test_a_section_by_number(self):
        self.only("theory.md 5: expected a section's title", "// (theory.md 5)\n")

    def test_a_name_of_several(self):
        self.assertIn("which of several", self.faults(**{
            "a__README.md": "# A\n", "b__x.h": "// README.md\n"})[0])

    def test_a_section(self):
        self.only('no section "Eye points"', '// (theory.md, "Eye points")\n')

    def test_a_section_over_two_lines(self):
        self.only('no section "Cache dots"', '/// (theory.md,\n/// "Cache\n/// dots")\n')

    def test_a_second_section(self):
        self.only('no section "Cache dots"', '// (theory.md, "Cache points",\n// "Cache dots")\n')

    def theory(self, old: str, new: str) -> str:
        """The good theory.md with a change."""
        self.assertIn(old, self.GOOD["doc/theory.md"])
        return self.GOOD["doc/theory.md"].replace(old, new)

    def code_of_lens_points(self, text: str) -> list[str]:
        return self.faults(**{
            "doc__theory.md": self.theory("### Lens points\n", "### Lens points\n\n[b](../src/b.cpp)\n"), "src__b.cpp": text})

    def test_code_that_cites_its_section_or_the_one_above(self):
        for title in ("Lens points", "Cache points"):
            self.assertEqual(self.code_of_lens_points(f'// (theory.md, "{title}")\n'), [])

    def test_code_that_does_not_cite_its_section(self):
        for text in ("int x;\n", '// (theory.md, "Constants")\n', '// (theory.md)\n'):
            self.assertEqual(self.code_of_lens_points(text),
                             ["doc/theory.md:9: src/b.cpp does not cite Cache points or Lens points"])

    def constants(self, row: str, **changes: str) -> list[str]:
        return self.faults(**{"doc__theory.md": self.theory("| so |\n", f"| so |\n{row}\n")}, **changes)

    def test_a_constant(self):
        self.assertEqual(self.constants("| `kFewest` 3 | src/a.cpp | |"),
                         ["doc/theory.md:14: `kFewest`: not in the code that the row names"])

    def test_the_number_of_a_constant(self):
        self.assertEqual(self.constants("| `kLeast` 10000 | src/a.cpp | |"),
                         ["doc/theory.md:14: 10000 of `kLeast`: not in the code that the row names"])

    def test_a_number_without_a_name(self):
        self.assertEqual(self.constants("| `kLeast`; 0.002 | src/a.cpp | |"),
                         ["doc/theory.md:14: 0.002: not in the code that the row names"])

    def test_the_source_of_a_constant(self):
        self.assertEqual(self.constants("| 16 | src/a.cpp, gone | |"),
                         ["doc/theory.md:14: gone: expected one source, found 0"])

    def test_a_source_of_several(self):
        self.assertEqual(self.constants("| 16 | src/a.cpp, a.cpp | |"),
                         ["doc/theory.md:14: a.cpp: expected one source, found 2"])

    def test_code_with_a_constant_that_does_not_cite_the_theory(self):
        self.assertEqual(self.constants("| 16 | b.cpp | |", **{"src__b.cpp": "int x = 16;\n"}),
                         ["doc/theory.md:14: src/b.cpp does not cite doc/theory.md"])

    def test_a_link(self):
        self.only("link to gone.png: no such file", "[x](gone.png)\n", "doc/b.md")

    def test_a_link_whose_text_has_two_lines(self):
        self.only("link to gone.png: no such file", "[x\ny](gone.png)\n", "doc/b.md")

    def test_an_anchor(self):
        self.only("theory.md#gone: no such section", "[x](theory.md#gone)\n", "doc/b.md")

    def test_an_anchor_of_its_own(self):
        self.only("#gone: no such section", "# B\n\n[x](#gone)\n", "doc/b.md")

    def test_a_link_in_code_is_none(self):
        self.assertEqual(self.faults(**{"doc__b.md": "# B\n\n    [x](gone.png)\n\n`[x](gone.png)`\n"}), [])

    def test_a_source(self):
        self.only("methods/gone.h: no such source", "As `methods/gone.h` says, and `methods/NAME.cpp`.\n", "doc/b.md")

    def test_a_key(self):
        self.only("[Su23 eq 1]: no such key", "// [Su23 eq 1]\n")

    def test_the_second_key_of_two(self):
        self.only("[Heitz18]: no such key", "// [Su22; Heitz18]\n")

    def test_a_key_over_two_lines(self):
        self.only("[Ng et al. 2016]: no such key", "// [Ng et al.\n// 2016]\n")

    def test_a_name_without_its_year(self):
        self.only("[Su 5.3]: expected a key", "// [Su 5.3]\n")

    def test_a_test(self):
        self.only("Suite.testsThat: no such test", "`Suite.testsThat`\n", "doc/b.md")


if __name__ == "__main__":
    unittest.main()
