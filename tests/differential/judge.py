"""Renders a scene by all rows, and tells what is wrong with what comes out.

Means are compared with those of bpt. If a row differs by SIEVE errors in a channel, it and its reference are rendered
anew: with other random numbers, MORE times as long. If it still differs by CONFIRM errors, this is done once more. A
row that differs three times is a find. The three are independent, so that the chances of a false alarm multiply. Tails,
which make a short render's own error too small, are shorter in long renders, and a row that missed rare light meets it
there. Light that is rarer still is met by some of SEEDS more renders, whose spread then says what their own errors do not.
"""

import json
import math
import random
import statistics
import subprocess
import time

import rows as rows_

ITERATIONS = 64
REFERENCE = 4  # times as many iterations for the reference
SIEVE, CONFIRM, MORE = 3.0, 3.3, (16, 64)
VERIFY = 1e-4  # what lacuna-render itself warns above
ROUNDING = 2e-5
SEEDS = 8  # of as many iterations as the last long render, before it is a find
NOISE = 0.2  # a mean with a larger relative error has not met most of its light
MOST_RAYS = 1e7  # of a long render, which is cut to this many
SECONDS = 300  # for one render
USAGE = 2  # the exit code where settings do not go together
DRAWS = 5


def tail(z):
    """Chance that the worst of three channels is off by z errors."""
    return 3 * 2 * (1 - statistics.NormalDist().cdf(z))


def false_alarm():
    """The chance of a false alarm in one comparison."""
    return tail(SIEVE) * tail(CONFIRM) ** len(MORE)


class Judge:
    def __init__(self, render, effects, scene, folder, seed):
        self.program, self.scene, self.folder = render, scene, folder
        self.r = random.Random(seed + 1_000_000)
        self.path = scene.gltf.write(folder)
        self.options = scene.options + rows_.switched_off(effects, self.r)
        self.finds = []

    def render(self, method, options, iterations, seed, threads=1, more=(), refusable=False):
        """The report of a render. None if it failed, which is a find unless the row may refuse the scene."""
        arguments = [self.path.name, *self.options, "--method", method, *options, "--iterations", str(iterations),
                     "--seed", str(seed), "--prepare", "--cache", "cache", "--threads", str(threads), *more]
        out = self.folder / "out.pfm"
        report = self.folder / "out.json"
        command = [self.program, *arguments, "-o", out.name, "--json", report.name, "--quiet"]
        begin = time.monotonic()
        try:
            ran = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=SECONDS)
        except subprocess.TimeoutExpired:
            return {"slow": True, "arguments": arguments}
        if ran.returncode == USAGE and refusable:
            return {"refused": True}
        if ran.returncode:
            last = (ran.stderr.strip() or "nothing on stderr").splitlines()[-1]
            if any(refusal in last for refusal in rows_.REFUSALS.get(method, ())):
                return None
            self.find("exit", method, arguments, f"exit code {ran.returncode}: {last}")
            return None
        found = json.loads(report.read_text())
        found.update(wall=time.monotonic() - begin, arguments=arguments, picture=out.read_bytes())
        if found["invalid_samples"]:
            self.find("invalid", method, arguments, f"{found['invalid_samples']} invalid samples")
        verify = found.get("verify")
        if verify and (not float(verify["max_difference"]) <= VERIFY or verify["not_a_number"]):
            self.find("weights", method, arguments, f"weights differ by {verify['max_difference']}, "
                      f"{verify['not_a_number']} not a number: {verify.get('replay')}")
        return found

    def find(self, kind, method, arguments, what):
        self.finds.append({"kind": kind, "method": method, "arguments": arguments, "what": what})

    def judge(self, every_row):
        """What was found, by row; `finds` has what is wrong."""
        found = {"effects": [], "rows": {}}
        reference = self.render("bpt", [], ITERATIONS * REFERENCE, 1)
        if reference is None:
            return found
        if "slow" in reference:
            self.find("time", "bpt", reference["arguments"], f"more than {SECONDS} s")
            return found
        simulated = set(reference["effects"]["simulated"])
        found.update(effects=sorted(simulated), mean=numbers(reference["mean_rgb"]))
        chosen = every_row
        if not any(found["mean"]):  # the program looks for the reason, which takes a second: two rows are enough
            chosen = self.r.sample(every_row, min(2, len(every_row)))
        threads = self.r.choice(chosen)
        for row in chosen:
            seed = self.r.randrange(2, 10 ** 6)
            left_out = [name for name in reference["effects"]["left_out"] if f"{name}=off" not in self.options]
            options, report = self.first(row, left_out, seed)
            if report is None:
                continue
            if "slow" in report:
                self.find("time", row.name, report["arguments"], f"more than {SECONDS} s")
                continue
            if row is threads:
                again = self.render(row.name, options, ITERATIONS, seed, threads=2)
                if again and "slow" not in again and again["picture"] != report["picture"]:
                    self.find("threads", row.name, report["arguments"], "two threads make another picture")
            found["rows"][row.name] = self.compare(row, options, report, reference, simulated)
        return found

    def first(self, row, left_out, seed):
        """Settings that go together, and the report of a render with them."""
        for draw in range(DRAWS):
            options = self.draw(row, left_out)
            report = self.render(row.name, options, ITERATIONS, seed, more=["--verify"], refusable=draw + 1 < DRAWS)
            if report is None or "refused" not in report:
                break
        return options, report

    def draw(self, row, left_out):
        switches = rows_.switches(row, left_out, self.r)
        return rows_.settings(row, self.r, self.scene.unit, switches) + switches

    def compare(self, row, options, report, reference, simulated):
        nearly = rows_.nearly_smooth(self.scene.gltf.root["materials"])
        kind = rows_.expectation(row, options, simulated, nearly)
        z = deviation(report, reference, kind)
        found = {"kind": kind, "z": z, "relative": relative(report, reference), "verify": report["verify"]["max_difference"],
                 "wall": report["wall"], "options": options, "rounds": 0}
        rays = max(report["rays"], reference["rays"] / REFERENCE, 1)
        for number, more in enumerate(MORE):
            if abs(z) < (CONFIRM if number else SIEVE):
                return found
            iterations = max(4, min(more, int(MOST_RAYS / rays))) * ITERATIONS
            seed = self.r.randrange(2, 10 ** 6)
            report = self.render(row.name, options, iterations, seed)
            reference = self.render("bpt", [], iterations * REFERENCE, seed + 1)
            if not report or not reference or "slow" in report or "slow" in reference:
                found["undecided"] = f"{z:.3g} errors after {number} long renders; the next takes too long"
                return found
            z = deviation(report, reference, kind)
            found.update(rounds=number + 1, last=z)
        if abs(z) >= CONFIRM and noise(report) > NOISE:
            found["undecided"] = f"{z:.3g} errors after long renders that are nothing but noise"
        elif abs(z) >= CONFIRM:
            spread = self.over_seeds(row.name, options, iterations)
            if spread and abs(deviation(spread, reference, kind)) < CONFIRM:
                found["undecided"] = f"{z:.3g} errors after long renders, but seeds differ: {text(spread)} over {SEEDS}"
                return found
            self.find("mean", row.name, report["arguments"],
                      f"mean {text(report)} by {row.name}, {text(reference)} by bpt: {z:.3g} errors, expected {kind}")
        return found

    def over_seeds(self, method, options, iterations):
        """Mean and error of SEEDS renders, as in a report, the error from what they differ by. None if one is not there."""
        reports = [self.render(method, options, iterations, self.r.randrange(2, 10 ** 6)) for _ in range(SEEDS)]
        if not all(report and "slow" not in report for report in reports):
            return None
        channels = list(zip(*(numbers(report["mean_rgb"]) for report in reports)))
        return {"mean_rgb": [statistics.mean(c) for c in channels],
                "mean_rgb_stderr": [statistics.stdev(c) / math.sqrt(SEEDS) for c in channels]}


def numbers(values):
    return [float(v) for v in values]


def text(report):
    return " ".join(f"{m:.4g} +- {e:.1g}" for m, e in zip(report["mean_rgb"], report["mean_rgb_stderr"]))


def deviation(report, reference, kind):
    """How far the channel that differs most is off, in errors; 0 on the side that is allowed."""
    worst = 0.0
    for m, e, m0, e0 in zip(*(numbers(r[name]) for r in (report, reference) for name in ("mean_rgb", "mean_rgb_stderr"))):
        difference = m - m0
        if kind == "any" or (kind == "at most" and difference < 0):
            continue
        error = math.hypot(e, e0, ROUNDING * m0)
        z = difference / error if error > 0 else math.copysign(math.inf, difference) if difference else 0.0
        if not abs(z) <= abs(worst):
            worst = z
    return worst


def noise(report):
    """The error of a row's own mean as a share of it; 0 where it is black."""
    mean, error = (sum(numbers(report[name])) for name in ("mean_rgb", "mean_rgb_stderr"))
    return error / mean if mean else 0.0


def relative(report, reference):
    """How far all channels together are off, and the error of that, in shares of the reference; None: it is black."""
    m, e, m0, e0 = (sum(numbers(r[name])) for r in (report, reference) for name in ("mean_rgb", "mean_rgb_stderr"))
    return [(m - m0) / m0, math.hypot(e, e0) / m0] if m0 > 0 else None
