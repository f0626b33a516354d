#!/usr/bin/env bash
# Builds everything and runs the tests, except those of a night: bash tests/run.sh [--quick] [-- CTEST OPTIONS]
#
#   --quick    leaves out the tests that take longer than seconds (label `slow`)
#
# Installs missing Debian packages first (apt-get, as root or through sudo). The last lines are ctest's.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../.ci/setup.sh"

preset=all
while (($#)); do
    case $1 in
        --quick) preset=quick ;;
        -h | --help)
            sed -n '2,6s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
            exit 0
            ;;
        --)
            shift
            break
            ;;
        *)
            echo "tests/run.sh: expected --quick or nothing, found '$1'; see --help" >&2
            exit 2
            ;;
    esac
    shift
done

install_packages build test
(install_packages browser) || say "No browser: the test of lacuna-study's page will be skipped"

say "Layout of the sources"
bash "$project/.ci/format.sh"

SECONDS=0
# An earlier demo may have configured the same directory without them.
configure -DLACUNA_TESTS=ON -DLACUNA_BENCHMARKS=ON -DLACUNA_MPI=ON
build_targets
say "Built in $SECONDS s"

say "Scenes: the files are what their generator makes"
python3 -B -m unittest discover -s "$project/scenes" -t "$project/scenes"
python3 "$project/scenes/make_scenes.py" --check

say "Hard cases: each has a test, and the table is of these tests"
python3 "$project/tests/stability_table.py" --check

say "Tests ($preset)"
cd "$project"
exec ctest --preset "$preset" --parallel "$(nproc)" "$@"
