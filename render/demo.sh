#!/usr/bin/env bash
# Builds the renderer and compares its methods on one scene: bash render/demo.sh
#
# Installs missing Debian packages first (apt-get, as root or through sudo). Then renders a reference
# of scenes/door.glb, then the same picture by every method for the same time, each compared with the
# reference as it goes. Everything is written to out/demo/, the tables are printed as well.
# These variables make it longer or larger (defaults in brackets):
#   SECONDS_EACH [6]   REFERENCE_SECONDS [60]   WIDTH [192]   HEIGHT [108]
#   METHODS ["pt lt bpt lvcbpt"]   SCENE [scenes/door.glb]   OUT [out/demo]
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../.ci/setup.sh"

if [[ ${1:-} == -h || ${1:-} == --help ]]; then
    sed -n '2,9s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
    exit 0
elif (($# > 0)); then
    echo "render/demo.sh: expected no arguments, found '$1'; see --help" >&2
    exit 2
fi
seconds_each=${SECONDS_EACH:-6}
reference_seconds=${REFERENCE_SECONDS:-60}
size=(--width "${WIDTH:-192}" --height "${HEIGHT:-108}")
methods=${METHODS:-pt lt bpt lvcbpt}
scene=${SCENE:-scenes/door.glb}
out=${OUT:-out/demo}
cd "$project"

install_packages build
if [[ -f $build/CMakeCache.txt ]]; then
    configure
else
    configure -DLACUNA_TESTS=OFF -DLACUNA_BENCHMARKS=OFF
fi
build_targets lacuna-render lacuna-compare
PATH="$build/render:$PATH"

mkdir -p "$out"
reference="$out/reference.exr"
say "Reference: $scene by bpt for $reference_seconds s"
lacuna-render "$scene" -o "$reference" --method bpt --seed 2 "${size[@]}" \
    --time "${reference_seconds}s" >&2

for method in $methods; do
    say "$method for $seconds_each s"
    lacuna-render "$scene" -o "$out/$method.exr" --method "$method" "${size[@]}" \
        --time "${seconds_each}s" --reference "$reference" --log "$out/$method.csv" >&2
    lacuna-compare "$out/$method.exr" "$reference" --error-map "$out/$method-error.png" --quiet \
        >"$out/$method.txt"
    # Settings and seed determine every pixel: as many iterations give the same picture again.
    lacuna-render "$scene" -o "$out/$method.png" --method "$method" "${size[@]}" --quiet \
        --iterations "$(tail -n 1 "$out/$method.csv" | cut -d, -f1)" >/dev/null
done

# table: a row per method, from the curve's last row and what lacuna-compare said of the image.
table() {
    local method iterations seconds
    printf '%-8s %10s %8s %9s %9s\n' method iterations seconds mape relmse
    for method in $methods; do
        IFS=, read -r iterations seconds _ < <(tail -n 1 "$out/$method.csv")
        awk -v method="$method" -v iterations="$iterations" -v seconds="$seconds" '
            { value[$1] = $2 }
            END {
                printf "%-8s %10d %8.1f %8.1f%% %9.3g\n", method, iterations, seconds,
                    100 * value["mape"], value["relmse"]
            }' "$out/$method.txt"
    done
}

# curves: mape of every method after 1/10, 1/5, 1/2 of the time and all of it; the last row of the
# curve up to then counts, `-` where there was none yet.
curves() {
    local method
    awk -v t="$seconds_each" 'BEGIN {
        printf "mape after"
        for (i = split("0.1 0.2 0.5 1", part, " "); i > 0; --i) line = sprintf(" %8gs", part[i] * t) line
        print line
    }'
    for method in $methods; do
        awk -F, -v method="$method" -v t="$seconds_each" '
            BEGIN { parts = split("0.1 0.2 0.5 1", part, " ") }
            NR > 1 {
                for (i = 1; i <= parts; ++i) {
                    # The last iteration may end a little after the limit.
                    if ($2 <= part[i] * t || i == parts) mape[i] = sprintf("%.1f%%", 100 * $7)
                }
            }
            END {
                printf "%-10s", method
                for (i = 1; i <= parts; ++i) printf " %9s", (i in mape) ? mape[i] : "-"
                print ""
            }' "$out/$method.csv"
    done
}

report() {
    echo "$scene, ${size[1]} x ${size[3]} pixels, $(nproc) processors"
    echo
    table
    echo
    curves
    echo
    echo "Errors are measured against $reference, which is a rendering too and adds its own"
    echo "noise to all of them. lt cannot see mirrors and smooth glass, nor through them: what it"
    echo "leaves black stays in its error."
    echo
    echo "Pictures: $out/METHOD.png, METHOD.exr (with layers); errors in colour: METHOD-error.png;"
    echo "curves: METHOD.csv"
}

say "Result (also in $out/report.txt)"
report | tee "$out/report.txt"
