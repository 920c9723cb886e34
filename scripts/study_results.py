"""Selections from the results of a study, by names: what the expressions in `numbers.json` may say (see `readme-numbers`).

A `Ratio` is a list of value, low and high, or of the value alone, so that it fills one `#` or a `#[]`; `.value`, `.low`, `.high`, `.p`
(adjusted) and `.better` (a name or None) are its parts. Estimator and condition, where not said, are the last estimator of the plan and
the only condition or the one called `none`.
"""
import json
import math
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

# Order of `values` and `intervals` of a family in summary.json (src/study/metric.rs).
METRICS = ["prediction", "prediction-of-rating", "log-volume", "reference", "si", "measured", "slow", "point-to-point", "static"]
NUMBER = r"(?<![\w.])[−+-]?\d+(?:,\d{3})*(?:\.\d+)?(?:e[−+-]?\d+)?"


def number(text):
    """A number as it is printed; its unit in the last place is what `unit_of` says."""
    return float(text.replace("−", "-").replace(",", ""))


def numbers(text):
    return [number(match) for match in re.findall(NUMBER, text)]


def geometric(values):
    return math.exp(statistics.fmean(map(math.log, values)))


class Ratio(list):
    def __init__(self, value, interval=None, p=None, better=None):
        super().__init__([value] + ([interval["low"], interval["high"]] if interval else []))
        self.value, self.p, self.better = value, p, better
        self.low, self.high = (interval["low"], interval["high"]) if interval else (None, None)

    def inverse(self, logarithmic=False):
        turn = (lambda x: -x) if logarithmic else (lambda x: 1 / x)
        interval = {"low": turn(self.high), "high": turn(self.low)} if self.low is not None else None
        return Ratio(turn(self.value), interval, self.p, self.better)


def share_in(cell, group):
    """The number after a name in a cell such as "friction of shoulder 92, upper arm 6"."""
    return numbers(re.search(re.escape(group) + r" (\S+?)(?:,|$)", cell)[1])[0]


def one(found, what):
    found = list(found)
    if len(found) != 1:
        raise LookupError(f"{what}: found {len(found)}, expected one")
    return found[0]


class Results:
    """One folder that `armid study` wrote."""

    def __init__(self, folder, python=sys.executable):
        self.folder, self.python = pathlib.Path(folder), python
        self.printed = {}
        if self.folder.is_dir() and not (self.folder / "summary.json").exists():  # of no study: files that `read` reads
            self.name, self.summary = self.folder.name, None
            return
        self.summary = json.loads((self.folder / "summary.json").read_text())
        if "plan" in self.summary:
            plan = self.plan = self.summary["plan"]
            self.name, self.estimators = plan["name"], plan["identification"]["estimators"]
            self.families = [family["name"] for family in plan["design"]]
            self.conditions = [c["condition"]["name"] for c in self.summary["conditions"]]
        else:  # of several robots
            self.name, self.estimators, self.conditions = self.summary["name"], self.summary["estimators"], self.summary["conditions"]
        self.compared = None

    def words(self):
        """The names that an expression may use."""
        return {name: getattr(self, name) for name in dir(self) if not name.startswith("_")}

    def findings(self, condition=None):
        name = condition or ("none" if "none" in self.conditions else one(self.conditions, "conditions"))
        return one((c for c in self.summary["conditions"] if c["condition"]["name"] == name), f"condition {name}")["findings"]

    def over(self, first, second="d-optimal", metric="prediction", condition=None, estimator=None):
        """The error of one family over that of another, as `comparisons` has it."""
        if self.compared is None:
            self.compared = {(c["condition"]["name"], x["metric"], x["estimator"], x["first"], x["second"]): x
                             for c in self.summary["conditions"] for x in c["findings"]["comparisons"]}
        where = (condition or ("none" if "none" in self.conditions else one(self.conditions, "conditions")), metric, estimator or self.estimators[-1])
        turned = (*where, first, second) not in self.compared
        x = self.compared[(*where, second, first) if turned else (*where, first, second)]
        ratio = Ratio(x["difference"], x["interval"], x["p_adjusted"], x["better"])
        return ratio.inverse(metric == "log-volume") if turned else ratio

    def lead(self, effect, first, metric="prediction", scale=100):
        """Size at which the lead over `first` ends as an effect grows, with its interval, in `levels.json` that `armid report --figure levels`
        writes; without the upper end if that is beyond all sizes; "no lead" and "at none of these" if it does not."""
        levels = one((x for x in json.loads((self.folder / "levels.json").read_text()) if x["effect"] == effect), effect)
        lead = one((x for x in levels["ratios"] if (x["criterion"], x["metric"]) == (first, metric)), first)["lead"]
        if isinstance(lead, str):
            return {"none": "no lead", "remains": "at none of these"}[lead]
        ends = lead["ends"]
        return [scale * x for x in (ends["size"], ends["low"], ends["high"]) if x is not None]

    def better_under(self, first, second="d-optimal", metric="prediction", conditions=None):
        """Names of the conditions under which the first family is called better than the second."""
        return [c for c in conditions or self.conditions if self.over(first, second, metric, c).better == first]

    def undecided_under(self, first, second="d-optimal", metric="prediction", conditions=None):
        return [c for c in conditions or self.conditions if self.over(first, second, metric, c).better is None]

    def family(self, name, condition=None, estimator=None):
        """Scores of one family."""
        wanted = (name, estimator or self.estimators[-1])
        return one((f for f in self.findings(condition)["families"] if (f["family"], f["estimator"]) == wanted), f"family {wanted}")

    def value(self, name, metric="prediction", condition=None, estimator=None):
        """Geometric mean of a family's error over its designs, with its interval."""
        family, place = self.family(name, condition, estimator), METRICS.index(metric)
        return Ratio(family["values"][place], family["intervals"][place])

    def parameter(self, name, family, condition=None, estimator=None):
        """`bias` (with its interval), `std`, `stated_std`, `rmse`, `coverage` and so on of one parameter."""
        place = [p["name"] for p in self.summary["parameters"]].index(name)
        return self.family(family, condition, estimator)["parameters"][place]

    def over_arms(self, first, second="d-optimal", metric="prediction", condition=None, estimator=None):
        """The ratio with drawn arms as units: a `Ratio` with `.range`, `.first_better` and `.share` (interval of the share of such arms)."""
        pairs = {(x["first"], x["second"]): x for x in self.findings(condition)["over_truths"]
                 if (x["metric"], x["estimator"]) == (metric, estimator or self.estimators[-1])}
        turned = (first, second) not in pairs
        x = pairs[(second, first) if turned else (first, second)]
        ratio = Ratio(x["ratio"], x["interval"])
        ends = [x["range"]["low"], x["range"]["high"]]
        if turned:
            ratio, ends = ratio.inverse(), [1 / ends[1], 1 / ends[0]]
        ratio.range, ratio.first_better = ends, x["truths"] - x["first_better"] if turned else x["first_better"]
        ratio.share = [x["share_interval"]["low"], x["share_interval"]["high"]]
        return ratio

    def foretold(self, value, metric="prediction", condition=None, estimator=None):
        """Rank correlation of a value of the designs with their error."""
        x = one((x for x in self.findings(condition)["foretelling"]
                 if (x["value"], x["metric"], x["estimator"]) == (value, metric, estimator or self.estimators[-1])), f"foretelling by {value}")
        return Ratio(x["rank_correlation"], x["interval"])

    def estimator_over(self, estimator, family, metric="prediction", condition=None):
        """The error of an estimator over that of the reference, on the same recordings."""
        x = one((x for x in self.findings(condition)["estimator_comparisons"]
                 if (x["metric"], x["estimator"], x["family"]) == (metric, estimator, family)), f"comparison of {estimator}")
        return Ratio(x["ratio"], x["interval"])

    def coverages(self, condition=None, estimator=None, families=None):
        """Coverage of stated intervals, in %, by family."""
        return {f["family"]: 100 * f["coverage"] for f in self.findings(condition)["families"]
                if f["estimator"] == (estimator or self.estimators[-1]) and (families is None or f["family"] in families)}

    def designs(self, family):
        """Designs of one family, by start: `certificate`, `evaluations`, `termination`."""
        place = self.families.index(family)
        return [d for d in self.summary["designs"] if d["family"] == place]

    def median_errors(self, family, condition=None):
        """Median over runs of the torque prediction error of each design of a family, N·m, last estimator."""
        errors = self.findings(condition)["design_prediction"][len(self.estimators) - 1]
        return [errors[k]["median"] for k, d in enumerate(self.summary["designs"]) if d["family"] == self.families.index(family)]

    def atlas(self, effect, level, estimator=None):
        """The entry of one effect: `prediction_ratio` as a `Ratio`, the bias of each parameter in stated deviations by name, and so on."""
        x = one((x for x in self.summary["atlas"]["entries"]
                 if (x["effect"], x["level"], x["estimator"]) == (effect, level, estimator or self.estimators[-1])), f"{effect} {level}")
        names = [p["name"] for p in self.summary["parameters"]]
        return {**x, "prediction": Ratio(x["prediction_ratio"], x["prediction_interval"]),
                "kinds": dict(zip(self.summary["atlas"]["kinds"], x["kind_ratios"])),
                "in_std": {n: Ratio(p["in_std"], p["in_std_interval"]) for n, p in zip(names, x["parameters"])},
                "worst": [names[k] for k in x["worst"]]}

    def quantity(self, name):
        """A quantity of the claims about the paper, by its name."""
        x = one((q for claim in self.summary["paper"]["claims"] for q in claim["quantities"] if q["name"] == name), f"quantity {name}")
        ratio = Ratio(x["value"], x["interval"])
        ratio.samples = x["samples"]
        return ratio

    def on_robot(self, robot, first, second="d-optimal", metric="prediction", condition="none"):
        """Of a study on several robots: the comparison on one of them."""
        place = [r["robot"] for r in self.summary["robots"]].index(robot)
        if self.compared is None:
            self.compared = {(x["condition"], x["metric"], x["estimator"], x["first"], x["second"]): x for x in self.summary["comparisons"]}
        where = (condition, metric, self.estimators[-1])
        turned = (*where, first, second) not in self.compared
        x = self.compared[(*where, second, first) if turned else (*where, first, second)]["robots"][place]
        ratio = Ratio(x["difference"], x["interval"], x["p_adjusted"], x["better"])
        return ratio.inverse() if turned else ratio

    def better_on(self, robot, first, second="d-optimal", metric="prediction"):
        """Of a study on several robots: names of the conditions under which the first family is called better than the second on that robot."""
        return [c for c in self.conditions if self.on_robot(robot, first, second, metric, c).better == first]

    def agreement(self, metric):
        """Of a study on several robots: how many comparisons the robots agree on, by word."""
        return one((x for x in self.summary["agreements"] if (x["metric"], x["estimator"]) == (metric, self.estimators[-1])), metric)

    def script(self, path, row, column, *arguments, place=0):
        """A cell of the Markdown tables that a script of the repository prints of these results; `row` is its first cell or cells, `place`
        which of several tables that have that column, which may be its number."""
        row = (row,) if isinstance(row, str) else tuple(row)
        for header, rows in [table for table in self.tables(path, *arguments) if isinstance(column, int) or column in table[0]][place:]:
            if isinstance(column, int) or column in header:
                for cells in rows:
                    if tuple(cells[:len(row)]) == row:
                        return cells[column if isinstance(column, int) else header.index(column)]
        raise LookupError(f"{path} printed no column \"{column}\" with a row {row}")

    def text(self, path, *arguments):
        """What a script of the repository prints of these results."""
        if (path, arguments) not in self.printed:
            root = pathlib.Path(__file__).resolve().parents[1]
            command = [self.python, str(root / path), str(self.folder.resolve()), *arguments]
            # Some draw figures where they stand, too.
            with tempfile.TemporaryDirectory() as elsewhere:
                run = subprocess.run(command, capture_output=True, text=True, cwd=elsewhere)
            if run.returncode:
                raise RuntimeError(f"{path}: {run.stderr.strip().splitlines()[-1:]}")
            self.printed[path, arguments] = run.stdout
        return self.printed[path, arguments]

    def tables(self, path, *arguments):
        """Of every table that a script prints: its header's cells, and the cells of its rows."""
        out, header = [], None
        for line in self.text(path, *arguments).splitlines():
            cells = [cell.strip() for cell in line.strip().strip("|").split(" | ")] if line.startswith("|") else None
            if cells is None:
                header = None
            elif header is None:
                header = cells
                out.append((header, []))
            elif not line.startswith("|--") and not line.startswith("| --"):
                out[-1][1].append(cells)
        return out

    def paired(self, first, second):
        """Torque prediction error of one family over that of another, paired by start, with the 95 % t interval over designs: a median over
        runs for each design, and thus of one run its error. For pairs that `comparisons` has not."""
        logs = [math.log(a / b) for a, b in zip(self.median_errors(first), self.median_errors(second))]
        free, middle = len(logs) - 1, statistics.fmean(logs)
        # The quantile by bisection of the distribution, whose density is integrated by Simpson's rule.
        scale = math.exp(math.lgamma((free + 1) / 2) - math.lgamma(free / 2)) / math.sqrt(free * math.pi)
        density = lambda x: scale * (1 + x * x / free) ** (-(free + 1) / 2)
        inside = lambda t: t / 1500 * sum((1 if k in (0, 1000) else 4 if k % 2 else 2) * density(t * k / 1000) for k in range(1001))
        low, high = 0.0, 50.0
        for _ in range(50):
            low, high = ((low + high) / 2, high) if inside((low + high) / 2) < 0.95 else (low, (low + high) / 2)
        half = low * statistics.stdev(logs) / math.sqrt(len(logs))
        return Ratio(math.exp(middle), {"low": math.exp(middle - half), "high": math.exp(middle + half)})

    def shares_of_variance(self, metric="prediction", without=()):
        """Of a grid: the share of criterion, family of trajectories and harmonics in the variance of the logarithms of the means, in %."""
        of = {tuple(name.split()): math.log(self.value(name, metric).value) for name in self.families if name.split()[0] not in without}
        means = [{level: statistics.fmean(v for key, v in of.items() if key[k] == level) for level in {key[k] for key in of}} for k in range(3)]
        return [100 * statistics.pvariance([means[k][key[k]] for key in of]) / statistics.pvariance(of.values()) for k in range(3)]

    def paired_runs(self, column, first, second, condition="none"):
        """Ratio of geometric means of a column of `runs.parquet` over designs that share their start, with the 95 % t interval of its logarithm."""
        script = ("import sys, json, numpy, pyarrow.parquet as p; from scipy import stats\n"
                  "rows = p.read_table(sys.argv[1], filters=[('condition', '=', sys.argv[3])]).to_pylist()\n"
                  "a, b = (numpy.log([r[sys.argv[2]] for r in sorted(rows, key=lambda r: r['design']) if r['family'] == f]) for f in sys.argv[4:])\n"
                  "t = stats.ttest_1samp(a - b, 0.0); print(json.dumps(numpy.exp([(a - b).mean(), *t.confidence_interval(0.95)]).tolist()))")
        run = subprocess.run([self.python, "-c", script, str(self.folder / "runs.parquet"), column, condition, first, second],
                             capture_output=True, text=True, check=True)
        value, low, high = json.loads(run.stdout)
        return Ratio(value, {"low": low, "high": high})

    def of_design(self, effect, level="realistic", family=None, estimator=None):
        """As `atlas`, of one of several designs (the first unless said); a combination goes by its condition. `bias` in units, `coverage` in %."""
        wanted = (family or self.families[0], estimator or self.estimators[-1])
        x = one((x for x in self.summary["atlas"]["entries"] if (x["family"], x["estimator"]) == wanted
                 and ((x["effect"], x["level"]) == (effect, level) or x["effect"] is None and x["condition"] == effect)), f"{effect} {level}")
        named = [(p["name"], p["reference_unit"], q) for p, q in zip(self.summary["parameters"], x["parameters"])]
        scaled = lambda q, key, unit: Ratio(unit * q[key], {end: unit * q[key + "_interval"][end] for end in ("low", "high")})
        return {**x, "prediction": Ratio(x["prediction_ratio"], x["prediction_interval"]), "kinds": dict(zip(self.summary["atlas"]["kinds"], x["kind_ratios"])),
                "in_std": {n: scaled(q, "in_std", 1) for n, _, q in named}, "bias": {n: scaled(q, "in_units", u) for n, u, q in named},
                "coverage": 100 * self.family(wanted[0], x["condition"], wanted[1])["coverage"]}

    def first_cells(self, path, column, place=0):
        """First cells of the rows of a table that a script prints of these results."""
        return [cells[0] for cells in [rows for header, rows in self.tables(path) if column in header][place]]

    def ranks(self, column, place=0):
        """By estimator, a column of a table of `experiments/09-estimators/ranking` as a `Ratio`, `better` where it is bold. `place`: 0 torque prediction,
        1 measured torque, 2 parameters, 3 intervals (held, biased, without an estimate), which alone have the reference's row."""
        path, out = "experiments/09-estimators/ranking", {}
        for first in self.first_cells(path, column, place):
            cell, name = self.script(path, first, column, place=place), first.strip("`")
            if name != self.estimators[-1] or place == 3:
                value, *ends = numbers(cell)
                interval = {"low": ends[0], "high": ends[1]} if ends else None
                out[name] = Ratio(value, interval, better=name if "**" in cell else None)
        return out

    def read(self, file):
        """A file of the folder: JSON; lines of JSON; a dictionary from the first cell of each row to the others of a CSV file and of tables in
        Markdown, and from what stands before a colon to what follows of a text."""
        text = (self.folder / file).read_text()
        if file.endswith(".md"):
            rows = [[cell.strip() for cell in line.strip().strip("|").split(" | ")] for line in text.splitlines() if line.startswith("|")]
            return {first.strip("` "): rest for first, *rest in rows}
        if file.endswith((".csv", ".txt")):
            mark = "," if file.endswith(".csv") else ": "
            return {line.split(mark)[0]: line.split(mark)[1:] for line in text.splitlines()}
        return [json.loads(line) for line in text.splitlines()] if file.endswith(".jsonl") else json.loads(text)
