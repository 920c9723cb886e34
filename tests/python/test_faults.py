"""Which runs `scripts/faults` performs again: streams that tripped by their current after this machine had held set-points back."""

import json
import unittest

from fault_rows import HANDED, STREAMED
from fault_run import LATE_MS, Broken, Late, Run


class Excuses(unittest.TestCase):
    def excuse(self, mode=STREAMED, trip="current-clamp", rest="confirmed", silence_ms=2 * LATE_MS):
        run = Run.__new__(Run)
        run.mode = mode
        said = {"detail": "tripped", "trip": {"name": trip, "reason": "effort", "rest": {"outcome": rest}}}
        said["stamps"] = {"longest_silence_s": 1e-3 * silence_ms}
        # As on a terminal: words before the answer and after it.
        run.excuse(f"tripped\n{json.dumps(said)}\n")

    def test_a_stream_that_came_late_shows_nothing(self):
        self.assertRaises(Late, self.excuse)

    def test_no_other_run_is_excused(self):
        for other in ({"mode": HANDED}, {"trip": "overspeed"}, {"silence_ms": LATE_MS / 2}):
            with self.subTest(**other):
                self.excuse(**other)

    def test_a_late_stream_that_is_not_seen_at_rest_is_a_fault(self):
        with self.assertRaises(Broken) as found:
            self.excuse(rest="not-confirmed")
        self.assertNotIsInstance(found.exception, Late)


if __name__ == "__main__":
    unittest.main()
