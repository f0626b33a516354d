#!/usr/bin/env python3
"""Checks the studies of tests/studies/ against render/study/study.schema.json, as they are and with --quick.

  python3 tests/study_schema.py        (needs Debian's python3-jsonschema; skipped with exit code 77 without it)
"""

from __future__ import annotations

import copy
import json
import re
import sys
import unittest
from pathlib import Path

try:
    import jsonschema
except ImportError:
    print("study_schema: python3-jsonschema is not installed")
    sys.exit(77)

ROOT = Path(__file__).resolve().parent.parent
SCHEMA = json.loads((ROOT / "render/study/study.schema.json").read_text(encoding="utf-8"))
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)
STUDIES = sorted((ROOT / "tests/studies").glob("*.json"))
COMMENT = re.compile(r'("(?:\\.|[^"\\])*")|//[^\n]*')  # a text is kept whole


def parsed(text: str) -> dict:
    return json.loads(COMMENT.sub(lambda m: m.group(1) or "", text))


def merged(target: object, patch: object) -> object:
    """A JSON merge patch (RFC 7386)."""
    if not isinstance(patch, dict):
        return patch
    result = dict(target) if isinstance(target, dict) else {}
    for key, value in patch.items():
        if value is None:
            result.pop(key, None)
        else:
            result[key] = merged(result.get(key), value)
    return result


def quick(study: dict) -> dict:
    rest = {key: value for key, value in study.items() if key != "quick"}
    return merged(rest, study["quick"])


def fits(study: object) -> bool:
    return VALIDATOR.is_valid(study)


class Studies(unittest.TestCase):
    def test_the_schema_is_one(self):
        jsonschema.Draft202012Validator.check_schema(SCHEMA)

    def test_there_are_some(self):
        self.assertGreater(len(STUDIES), 5)

    def test_each_fits(self):
        for path in STUDIES:
            with self.subTest(path.name):
                study = parsed(path.read_text(encoding="utf-8"))
                VALIDATOR.validate(study)
                VALIDATOR.validate(quick(study))

    def test_what_lacuna_study_refuses_does_not_fit(self):
        good = parsed((ROOT / "tests/studies/door.json").read_text(encoding="utf-8"))
        self.assertTrue(fits(good))

        def spoilt(change) -> dict:
            study = copy.deepcopy(good)
            change(study)
            return study

        for change in (
            lambda s: s.update(colour="red"),
            lambda s: s.pop("title"),
            lambda s: s.pop("time"),
            lambda s: s.update(seeds=[1, 1]),
            lambda s: s.update(seeds=[1_000_000]),
            lambda s: s.update(measures=["psnr"]),
            lambda s: s.update(bounds={"mape": [0]}),
            lambda s: s["scenes"][0].pop("reference"),
            lambda s: s["scenes"][0]["options"].update(iterations=3),
            lambda s: s["scenes"][0]["options"].update(effect=[]),
            lambda s: s["scenes"][0]["options"].update(width=[128, 72]),
            lambda s: s["scenes"][0].update(reference={"method": "pt", "iterations": 2, "parts": 0}),
            lambda s: s["scenes"][0]["crops"][0].update(width=0),
            lambda s: s["methods"][0].update(vary={"a": [1], "b": [2]}),
        ):
            self.assertFalse(fits(spoilt(change)))


class Comments(unittest.TestCase):
    def test_are_taken_out_and_texts_are_not(self):
        self.assertEqual(parsed('{"a": "x//y"} // z'), {"a": "x//y"})


if __name__ == "__main__":
    unittest.main()
