"""Numbers of READMEs against the values of the last run of each study, and the checker itself against a README with wrong ones."""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CHECKER = Path(__file__).resolve().parents[2] / "scripts" / "readme-numbers"

README = """# A study
The error is 1.82 [1.54, 2.15] of the other, better under two of 20
conditions.

| condition | ratio |
|---|---|
| none | **1.82 [1.38, 2.39]** |
| lag | 0.92 [0.80, 1.10] |
"""
NUMBERS = {
    "results": "a-study",
    "entries": [
        {"text": "is #[] of the other, better under # of # conditions", "is": ["over('a')"], "values": [1.8215, 1.543, 2.149, 2, 20]},
        {"table": "| condition | ratio |", "rows": "conditions", "cells": ["bold(over('a'))"],
         "values": {"none": [[1.8199, 1.3837, 2.3939, True]], "lag": [[0.921, 0.8, 1.0999, False]]}},
    ],
}


def checked(readme):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "README.md"
        path.write_text(readme)
        path.with_name("numbers.json").write_text(json.dumps(NUMBERS))
        return subprocess.run([sys.executable, CHECKER, "--stored", path], capture_output=True, text=True)


class ReadmeNumbers(unittest.TestCase):
    def test_every_readme_has_the_numbers_of_its_study(self):
        for more in [[], [CHECKER.parents[1] / "benches/peers/README.md"]]:
            run = subprocess.run([sys.executable, CHECKER, "--stored", *more], capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, run.stderr)

    def test_the_front_figure_shows_the_numbers_of_the_tables(self):
        root = CHECKER.parents[1]
        entries = json.loads((root / "experiments/06-model-error/numbers.json").read_text())["entries"]
        figure = json.loads((root / "reports/gallery/readme/criteria.json").read_text())
        names = {None: "none", "torque-constant": "torque constants", "stribeck": "Stribeck"}
        for robot, results in zip(figure, ["06-ten-times", "06-two-robots"], strict=True):
            [table] = [e for e in entries if e.get("results") == results and e.get("table", "").startswith("| condition |")]
            for ratio in robot["ratios"]:
                with self.subTest(robot=robot["robot"], **{k: ratio[k] for k in ("effect", "criterion")}):
                    effect, error = ratio["effect"], ratio["error"]
                    column = [f"'{ratio['criterion']}', condition=row))" in cell for cell in table["cells"]].index(True)
                    value = table["values"][names.get(effect, (effect or "").replace("-", " "))][column]
                    better = ratio["criterion"] if value[0] < 1 else robot["reference"]
                    interval = error["interval"]
                    self.assertEqual([error["difference"], interval["low"], interval["high"]], value[:3])
                    self.assertEqual(error["better"], better if value[3] else None)

    def test_right_numbers_pass_and_all_are_counted(self):
        run = checked(README)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("10 of 10 numbers", run.stdout)

    def test_a_wrong_number_is_found_where_it_stands(self):
        for right, wrong, line in [("1.54,", "1.55,", 2), ("two of", "three of", 2), ("0.92 ", "0.93 ", 8), ("**1.82 [1.38, 2.39]**", "1.82 [1.38, 2.39]", 7)]:
            with self.subTest(wrong):
                run = checked(README.replace(right, wrong))
                self.assertEqual(run.returncode, 1)
                self.assertIn(f"README.md:{line}: ", run.stderr)

    def test_a_text_or_a_row_that_is_gone_is_found(self):
        self.assertIn("found 0 places", checked(README.replace("of the other", "of another")).stderr)
        self.assertIn("found the rows none; expected none, lag", checked(README.replace("| lag | 0.92 [0.80, 1.10] |\n", "")).stderr)


if __name__ == "__main__":
    unittest.main()
