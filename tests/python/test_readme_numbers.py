"""Tables of READMEs and RESULTS against the values of the last run of each study, prose against tables, and the measures of prose; both checkers
against pages with mistakes."""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"

README = """# A study
The error is 1.82 of the other, in 12 motions. It is better under
none of the effects.

| condition | ratio |
|---|---|
| none | **1.82 [1.38, 2.39]** |
| lag | 0.92 [0.80, 1.10] |
"""
RESULTS = """# Results

| item | ratio |
|---|---|
| the same | 1.5 |
| the same | 2.5 |
"""
NUMBERS = {
    "results": "a-study",
    "entries": [
        {"table": "| condition | ratio |", "rows": "conditions", "cells": ["bold(over('a'))"],
         "values": {"none": [[1.8199, 1.3837, 2.3939, True]], "lag": [[0.921, 0.8, 1.0999, False]]}},
        {"table": "| item | ratio |", "in": "RESULTS.md", "by_row": [["the same", ["x"]], ["the same", ["y"]]],
         "values": [["the same", [[1.5]]], ["the same", [[2.5]]]]},
    ],
}


def checked(readme=README, results=RESULTS):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "README.md"
        path.write_text(readme)
        path.with_name("RESULTS.md").write_text(results)
        path.with_name("study.toml").write_text("motions = 12\n")
        path.with_name("numbers.json").write_text(json.dumps(NUMBERS))
        return subprocess.run([sys.executable, SCRIPTS / "readme-numbers", "--stored", path], capture_output=True, text=True)


class ReadmeNumbers(unittest.TestCase):
    def test_every_page_has_the_numbers_of_its_study(self):
        for more in [[], [SCRIPTS.parent / "benches/peers/README.md"]]:
            run = subprocess.run([sys.executable, SCRIPTS / "readme-numbers", "--stored", *more], capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, run.stderr)

    def test_the_front_figure_shows_the_numbers_of_the_table(self):
        [table, *_] = json.loads((SCRIPTS.parent / "experiments/06-model-error/numbers.json").read_text())["entries"]
        figure = json.loads((SCRIPTS.parent / "reports/gallery/readme/criteria.json").read_text())
        names = {None: "none", "torque-constant": "torque constants", "stribeck": "Stribeck"}
        first_cells = {row: first for first, row in table["rows"].items()}
        for robot, call in zip(figure, ["(over(", "on_robot('puma-560', "], strict=True):
            for ratio in robot["ratios"]:
                with self.subTest(robot=robot["robot"], **{k: ratio[k] for k in ("effect", "criterion")}):
                    effect, error = ratio["effect"], ratio["error"]
                    column = [f"{call}'{ratio['criterion']}', condition=row))" in cell for cell in table["cells"]].index(True)
                    value = table["values"][first_cells[names.get(effect, (effect or "").replace("-", " "))]][column]
                    better = ratio["criterion"] if value[0] < 1 else robot["reference"]
                    interval = error["interval"]
                    self.assertEqual([error["difference"], interval["low"], interval["high"]], value[:3])
                    self.assertEqual(error["better"], better if value[3] else None)

    def test_right_numbers_pass_and_all_of_tables_are_counted(self):
        run = checked()
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("8 of 8 numbers in tables", run.stdout)

    def test_a_wrong_cell_is_found_with_its_line(self):
        for right, wrong, line in [("1.38,", "1.39,", 7), ("0.92 ", "0.93 ", 8), ("**1.82 [1.38, 2.39]**", "1.82 [1.38, 2.39]", 7)]:
            with self.subTest(wrong):
                run = checked(README.replace(right, wrong))
                self.assertEqual(run.returncode, 1)
                self.assertIn(f"README.md:{line}: ", run.stderr)

    def test_a_row_that_is_gone_or_out_of_order_is_found(self):
        self.assertIn("found the rows none; expected none, lag", checked(README.replace("| lag | 0.92 [0.80, 1.10] |\n", "")).stderr)
        self.assertIn("RESULTS.md:5: ", checked(results=RESULTS.replace("1.5", "x").replace("2.5", "1.5").replace("x", "2.5")).stderr)

    def test_a_number_in_a_sentence_is_one_of_a_table_or_a_setting(self):
        for right, wrong in [("1.82 of", "1.83 of"), ("12 motions", "13 motions")]:
            with self.subTest(wrong):
                self.assertIn("README.md:2: found 1", checked(README.replace(right, wrong)).stderr)
        # Rounded further than the table, and with the other sign.
        self.assertEqual(checked(README.replace("is 1.82", "is −1.8")).returncode, 0)


class Words(unittest.TestCase):
    def measured(self, text, name="page.md"):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / name
            path.write_text(text)
            return subprocess.run([sys.executable, SCRIPTS / "words", path], capture_output=True, text=True)

    def test_every_page_that_is_held_keeps_the_bounds(self):
        run = subprocess.run([sys.executable, SCRIPTS / "words"], capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)

    def test_plain_sentences_pass_and_tables_and_code_are_no_prose(self):
        run = self.measured("# A page\n\nThe arm moves. It has 6 joints.\n\n| a | b |\n|---|---|\n| 1 2 3 4 5 6 | 7 8 9 |\n\n```sh\narmid 1 2 3 4 5 6\n```\n")
        self.assertEqual(run.returncode, 0, run.stderr)

    def test_each_bound_is_held_with_the_line(self):
        for text, words in [("One two three. " + "word " * 46 + "end.", "longest sentence"), ("Found 1, 2 and 3 in one.", "numbers in a sentence"),
                            (" ".join(f"It has {n} arms here." for n in range(6)), "numbers in a paragraph"),
                            ("This is " + "a sentence " * 9 + "of words.", "mean sentence"), ("word " * 31 + "end. One two three.", "over 30 words")]:
            with self.subTest(words):
                run = self.measured("# Page\n\n" + text + "\n")
                self.assertEqual(run.returncode, 1)
                self.assertIn(f"page.md:3: ", run.stderr)
                self.assertIn(words, run.stderr)


if __name__ == "__main__":
    unittest.main()
