"""The parts of a night. Each returns a dictionary: `summary`, one line; `rows`, a table of it, the head first; and
`findings`, whose absence is success."""

import os
import re
import shutil
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import long_render

ROOT = Path(__file__).resolve().parents[2]
JOBS = str(os.cpu_count())
DICTIONARIES = ROOT / "tests" / "fuzz" / "dictionaries"
CORPUS = ROOT / "tests" / "fuzz" / "corpus"
# The fuzzer's temporary files are in memory if possible, because parsers read files.
MEMORY = {"TMPDIR": "/dev/shm"} if Path("/dev/shm").is_dir() else {}
SUPPRESSIONS = Path(__file__).with_name("threads.supp")
# A processor of 2010 with SSE 4.2 but without AVX. Emulation takes some twenty times as long.
OLD_PROCESSOR = ("qemu-x86_64", "-cpu", "Westmere")
# Test programs that start no other program, because that one would not be emulated.
ALONE = ("base", "image", "material", "scene", "bidir", "resampling", "specular", "subspace", "skeleton", "voxel")
# Suites that use threads, as a pattern for ctest -R.
THREADED = "^(ThreadPool|Library|Render|Live|Study|Train)"


class Failed(Exception):
    """A part lacks something that it needs."""


def run(command, log, **how):
    """Runs a command. Returns its output, which `log` keeps, and its exit code."""
    done = subprocess.run([str(c) for c in command], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace", **how)
    log.parent.mkdir(parents=True, exist_ok=True)
    log.write_text(done.stdout)
    return done.stdout, done.returncode


def build(preset, log, *targets, settings=()):
    for command in (["cmake", "--preset", preset, *settings],
                    ["cmake", "--build", "--preset", preset, "--parallel", JOBS,
                     *(["--target", *targets] if targets else [])]):
        if run(command, log)[1] != 0:
            raise Failed(f"preset {preset} does not build: {log}")
    return ROOT / {"release": "build"}.get(preset, f"build-{preset}")


def tests_of(output):
    """From ctest's output: the number of tests that ran, seconds, and the names of those that failed."""
    ran = re.search(r"tests failed out of (\d+)", output)
    seconds = re.search(r"Total Test time \(real\) =\s+([\d.]+)", output)
    failed = re.findall(r"^\s+\d+ - (\S.*?) \((?!Skipped)", output, re.M)
    return int(ran[1]) if ran else 0, float(seconds[1]) if seconds else 0.0, failed


def suite(preset, log, *chosen, environment=()):
    """Runs a preset's tests. Returns their number, the seconds, and those that failed."""
    output, code = run(["ctest", "--test-dir", build(preset, log.with_suffix(".build.log")), "--parallel", JOBS,
                        "--output-on-failure", "--timeout", 7200, *chosen], log, env=os.environ | dict(environment))
    count, seconds, failed = tests_of(output)
    if code != 0 and not failed:
        failed = [f"ctest ended with {code}: {log}"]
    return count, seconds, failed


def sanitizers(options):
    """The suite under AddressSanitizer and UndefinedBehaviorSanitizer."""
    count, seconds, failed = suite("debug", options.out / "sanitizers.log", *(["-LE", "slow|night"] if options.quick else []))
    which = "without the slow tests" if options.quick else "the whole suite"
    return {"summary": f"AddressSanitizer and UndefinedBehaviorSanitizer, {which}: {count} tests in {seconds:.0f} s",
            "rows": [], "findings": failed}


def threads(options):
    """The suites that use threads, under ThreadSanitizer."""
    count, seconds, failed = suite("threads", options.out / "threads.log", "-LE", "slow|night", "-R", THREADED,
                                   environment={"TSAN_OPTIONS": f"suppressions={SUPPRESSIONS}"})
    return {"summary": f"ThreadSanitizer, what has threads, without the slow tests: {count} tests in {seconds:.0f} s",
            "rows": [], "findings": failed}


def on_old_processor(program, log):
    """A program of tests on OLD_PROCESSOR: a row of the table, and findings."""
    begin = time.monotonic()
    output, code = run([*OLD_PROCESSOR, program, "--gtest_filter=-*Slow.*"], log)
    passed = re.search(r"\[  PASSED  \] (\d+) tests?\.", output)
    failed = sorted(set(re.findall(r"^\[  FAILED  \] (\S+)", output, re.M)))
    findings = [f"{program.name}: {test}" for test in failed]
    if code != 0 and not findings:
        findings.append(f"{program.name}: ended with {code}: {log}")
    return [program.name, int(passed[1]) if passed else 0, f"{time.monotonic() - begin:.0f} s"], findings


def baseline(options):
    """The build for any x86-64: the quick tests here, and programs that start no other on an emulated old processor."""
    count, seconds, failed = suite("baseline", options.out / "baseline.log", "-LE", "slow|night")
    if not shutil.which(OLD_PROCESSOR[0]):
        raise Failed(f"{OLD_PROCESSOR[0]} is missing: apt-get install qemu-user")
    folder = ROOT / "build-baseline" / "tests"
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        done = list(pool.map(lambda name: on_old_processor(folder / f"test_{name}", options.out / f"baseline-{name}.log"),
                             ALONE[:1] if options.quick else ALONE))
    return {"summary": f"built without AVX2: {count} quick tests in {seconds:.0f} s; on an emulated processor that has none "
                       f"({OLD_PROCESSOR[-1]}) {sum(row[1] for row, _ in done)} more",
            "rows": [["program of tests, emulated", "passed", "time"], *(row for row, _ in done)],
            "findings": failed + [finding for _, found in done for finding in found]}


def fuzzed(output):
    """From libFuzzer's output: executions, edges, features, and the inputs that it kept as findings."""
    count = re.search(r"stat::number_of_executed_units:\s+(\d+)", output)
    covered = re.findall(r"cov: (\d+) ft: (\d+)", output)
    edges, features = covered[-1] if covered else (0, 0)
    return (int(count[1]) if count else 0, int(edges), int(features),
            re.findall(r"Test unit written to (\S+)", output))


def fuzz_parser(name, program, options):
    """Fuzzes one parser: a row of the table, and findings. An input may take 20 seconds, and the memory of
    fuzz_main.cpp."""
    log = options.out / f"fuzz-{name}.log"
    dictionary, known = DICTIONARIES / f"{name}.dict", CORPUS / name
    output, code = run(
        [program, options.out / "fuzz" / name, *([known] if known.exists() else []),
         f"-runs={options.executions}", f"-max_total_time={options.seconds_each}", "-print_final_stats=1", "-timeout=20",
         "-len_control=100",  # libFuzzer's default, which it drops for mutators
         "-rss_limit_mb=4096", f"-artifact_prefix={options.out}/findings/{name}-",
         *([f"-dict={dictionary}"] if dictionary.exists() else [])],
        log, env={**os.environ, **MEMORY, "LACUNA_FUZZ_PARSER": name})
    executions, edges, features, kept = fuzzed(output)
    findings = [f"{name}: {path}" for path in kept]
    if code != 0 and not kept:
        findings.append(f"{name}: ended with {code}: {log}")
    return [f"`{name}`", executions, edges, features], findings


def fuzz(options):
    """Every parser of tests/fuzz/parsers.h, as many at a time as there are processors."""
    folder = build("fuzz", options.out / "fuzz-build.log") / "tests"
    inputs = options.out / "fuzz"
    if run([folder / "fuzz_seeds", inputs], options.out / "fuzz-seeds.log")[1] != 0:
        raise Failed(f"no seeds: {options.out / 'fuzz-seeds.log'}")
    (options.out / "findings").mkdir(exist_ok=True)
    names = options.parser or sorted(folder.name for folder in inputs.iterdir())
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        done = list(pool.map(lambda name: fuzz_parser(name, folder / "fuzz", options), names))
    head = ["parser", "executions", "edges", "features"]
    last = options.last.get("fuzz", {}).get("rows", [])[1:] if options.parser else []  # of other parsers
    rows = {row[0]: row for row in [*last, *(row for row, _ in done)]}
    return {"summary": f"libFuzzer, {sum(row[1] for row in rows.values())} executions",
            "rows": [head, *(rows[name] for name in sorted(rows))],
            "findings": [finding for _, found in done for finding in found]}


def counted(output):
    """From the output of hostile/run.py: what was done and how often, and what was wrong. Messages of renders come
    first."""
    rows, wrong = [], []
    for line in output.splitlines():
        done = re.match(r" *(\d+)  (.+)", line)
        if done:
            rows.append([done[2], int(done[1])])
        elif rows and not re.match(r"\d+ wrong$", line):
            wrong.append(line)
    return rows, wrong


def hostile(options):
    """Calls that fail, signals and kills, limits, odd surroundings."""
    folder = build("release", options.out / "hostile-build.log", "lacuna_tools", "faults")
    log = options.out / "hostile.log"
    output, code = run(["python3", "-B", "tests/hostile/run.py", folder, folder / "tests" / "libfaults.so",
                        *(["--quick"] if options.quick else [])], log)
    rows, wrong = counted(output)
    if code != 0 and not wrong:
        wrong = [f"ended with {code}: {log}"]
    return {"summary": f"{sum(times for _, times in rows)} faults put in", "rows": [["what was done", "times"], *rows],
            "findings": wrong}


def compared(output):
    """From the output of differential/run.py: its last line, and the findings."""
    total = re.search(r"^\d+ scenes, \d+ comparisons$", output, re.M)
    return total[0] if total else "", re.findall(r"^(scene \d+, .+)$", output, re.M)


def tried(output):
    """From the output of differential/pieces.py: its last line, and the findings."""
    total = re.search(r"^\d+ command lines, .*$", output, re.M)
    return total[0] if total else "", re.findall(r"^(line \d+: .+)$", output, re.M)


def with_the_days_seeds(name, read, options, command):
    """Runs a script of differential/ with arguments, which `command` lists for a build folder. Returns what `read`
    finds in the output: its last line, and the findings."""
    folder = build("release", options.out / f"{name}-build.log", "lacuna_tools")
    log = options.out / f"{name}.log"
    script, *arguments = command(folder)
    output, code = run(["python3", "-B", f"tests/differential/{script}", *arguments, "--first", options.seed], log)
    total, finds = read(output)
    if code != 0 and not finds:
        finds = [f"ended with {code}: {log}"]
    return total, finds


def differential(options):
    """Random scenes that no night before has had."""
    total, finds = with_the_days_seeds("differential", compared, options, lambda folder: [
        "run.py", folder / "render" / "lacuna-render", options.out / f"differential-{options.seed}", "--scenes", options.scenes])
    return {"summary": f"{total} from seed {options.seed} on", "rows": [], "findings": finds}


def pieces(options):
    """Random command lines that no night before has had."""
    total, finds = with_the_days_seeds("pieces", tried, options, lambda folder: [
        "pieces.py", folder / "render", "--lines", options.lines])
    return {"summary": f"{total}, from seed {options.seed} on, on 1 and 3 threads, interrupted, and out of parts", "rows": [],
            "findings": finds}


def studies(options):
    """The quick forms of the studies of our own scenes."""
    folder = build("release", options.out / "studies-build.log", "lacuna_tools")
    files = sorted(p for p in (ROOT / "tests" / "studies").glob("*.json") if not p.stem.endswith("-shared"))
    findings = []
    for study in files[:1] if options.quick else files:
        log = options.out / f"study-{study.stem}.log"
        code = run([folder / "render" / "lacuna-study", study, "--quick", "-o", options.out / "studies" / study.stem],
                   log)[1]
        if code != 0:
            findings.append(f"{study.stem}: ended with {code}: {log}")
    return {"summary": f"{1 if options.quick else len(files)} quick studies", "rows": [], "findings": findings}


def endurance(options):
    """One long render."""
    folder = build("release", options.out / "endurance-build.log", "lacuna_tools")
    rows, findings = long_render.measure(folder / "render", options.long_scene, 60 * options.minutes,
                                         options.out / "endurance")
    return {"summary": f"{options.long_scene.name} by `auto` for {options.minutes} minutes at 1920 x 1080", "rows": rows,
            "findings": findings}


PARTS = {part.__name__: part for part in (sanitizers, threads, baseline, fuzz, hostile, differential, pieces, studies, endurance)}
