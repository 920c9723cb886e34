"""The pages tell the truth. Each command in a `console` block of `docs/` is run, and its answer is the one on the page. Each command of
armid in an `sh` block of any page has only flags and values that there are.

A page runs in an empty folder, or in a copy of the folder with the page's name. Answers are compared without their numbers. `…` stands for
the rest of an answer. `WRITE=1` writes the answers anew, as many lines of each as the page shows.
"""

import os
import re
import shlex
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
ARMID = Path(os.environ["ARMID"]).resolve()
SHELL = re.compile(r"^```sh\n(.*?)^```$", re.MULTILINE | re.DOTALL)
BLOCK = re.compile(r"^```console\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def commands(block):
    """Words behind `armid` of each command of it in a block of shell; pipes and lists of commands are taken apart."""
    for line in re.sub(r"\$\w+", "1", block.replace("\\\n", " ")).splitlines():
        words = shlex.shlex(line, posix=True, punctuation_chars="|&;<>()")
        words.whitespace_split = True
        command = []
        for word in [*words, ";"]:
            if word and set(word) <= set("|&;<>()"):
                if command[:4] == ["cargo", "run", "--release", "--"]:
                    command[:4] = ["armid"]
                if command[:1] == ["armid"]:
                    # Words behind a second `--` are for another program.
                    yield command[1 : command.index("--") if "--" in command else None]
                command = []
            else:
                command.append(word)


def steps(block):
    """Command and shown lines of each step of a block."""
    parts = re.split(r"^\$ (.*)\n", block, flags=re.MULTILINE)
    if parts[0].strip():
        raise ValueError(f'found "{parts[0].strip()}", expected a block that begins with "$ "')
    return [(command, answer.splitlines()) for command, answer in zip(parts[1::2], parts[2::2], strict=True)]


def without_numbers(line):
    return re.sub(r"\s+", " ", re.sub(r"\b[0-9a-f]{64}\b|[-+]?\d[\d.e+-]*", "#", line)).strip()


def shown_of(answer, shown):
    """As many lines of an answer as a page shows of it."""
    return [*answer[: len(shown) - 1], "…"] if shown and shown[-1] == "…" else answer


class Pages(unittest.TestCase):
    maxDiff = None

    def run_page(self, page):
        """The page with the answers of now; its differences but for numbers are failures."""
        text = page.read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) / "work"
            data = page.with_suffix("")
            if data.is_dir():
                shutil.copytree(data, folder)
            else:
                folder.mkdir()
            environment = {**os.environ, "PATH": f"{ARMID.parent}{os.pathsep}{os.environ['PATH']}"}

            def anew(match):
                out = []
                for command, shown in steps(match[1]):
                    run = subprocess.run(
                        ["bash", "-c", command], cwd=folder, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300
                    )
                    where = f"{page.relative_to(ROOT)}: {command}"
                    self.assertEqual(run.returncode, 0, f"{where}\n{run.stdout}")
                    lines = shown_of([line.rstrip() for line in run.stdout.splitlines()], shown)
                    if not os.environ.get("WRITE"):
                        self.assertEqual([*map(without_numbers, lines)], [*map(without_numbers, shown)], where)
                    out += [f"$ {command}", *lines]
                return "```console\n" + "\n".join(out) + "\n```"

            return BLOCK.sub(anew, text)

    def test_every_command_of_the_pages_gives_the_answer_shown(self):
        pages = [page for page in sorted((ROOT / "docs").rglob("*.md")) if BLOCK.search(page.read_text(encoding="utf-8"))]
        self.assertGreaterEqual(len(pages), 2)
        for page in pages:
            with self.subTest(page=page.name):
                text = self.run_page(page)
                if os.environ.get("WRITE"):
                    page.write_text(text, encoding="utf-8")

    def test_every_command_in_a_block_of_shell_has_flags_and_values_that_there_are(self):
        listed = subprocess.run(["git", "ls-files", "*.md"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
        count = 0
        for page in listed.split():
            for block in SHELL.findall((ROOT / page).read_text(encoding="utf-8")):
                for words in commands(block):
                    count += 1
                    # Help is shown once all words before it are understood; nothing is performed.
                    run = subprocess.run([ARMID, *words, "--help"], capture_output=True, text=True)
                    self.assertEqual(run.returncode, 0, f"{page}: armid {shlex.join(words)}\n{run.stderr}")
        self.assertGreater(count, 60)

    def test_the_figure_of_base_parameters_is_what_reduce_says(self):
        folder = ROOT / "docs/concepts"
        drawn = subprocess.run(
            ["python3", folder / "base_parameters.py"], env={**os.environ, "ARMID": str(ARMID)}, check=True, capture_output=True, text=True
        )
        self.assertEqual(drawn.stdout, (folder / "base-parameters.svg").read_text(encoding="utf-8"))


if __name__ == "__main__":
    unittest.main()
