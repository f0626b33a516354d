#!/usr/bin/env bash
# Builds the renderer and compares its methods on one scene: bash render/demo.sh
#
# Installs missing Debian packages first (apt-get, as root or through sudo). Then runs a study: the
# picture of scenes/door.glb by every method for the same time, three seeds each.
# The results are in out/demo/: index.html (open it in any browser), tables, curves, pictures.
# If it is stopped, the next call continues from there. These variables change it (defaults in
# brackets):
#   STUDY [tests/studies/door.json]   OUT [out/demo]
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../.ci/setup.sh"

if [[ ${1:-} == -h || ${1:-} == --help ]]; then
    sed -n '2,9s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
    exit 0
elif (($# > 0)); then
    echo "render/demo.sh: expected no arguments, found '$1'; see --help" >&2
    exit 2
fi
cd "$project"
study=${STUDY:-tests/studies/door.json}
out=${OUT:-out/demo}

install_packages build
if [[ -f $build/CMakeCache.txt ]]; then
    configure
else
    configure -DLACUNA_TESTS=OFF -DLACUNA_BENCHMARKS=OFF
fi
build_targets lacuna_tools

say "Study: $study"
"$build/render/lacuna-study" "$study" -o "$out" >&2

say "Result (all tables: $out/tables.md)"
awk '/^## / { show = /^## (Time to an error|Error at equal time)$/ } show' "$out/tables.md"
echo
echo "The page: file://$(realpath "$out")/index.html"
