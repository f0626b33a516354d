#!/usr/bin/env bash
# Whether the sources are laid out as .clang-format says (clang-format 14, Debian 12's).
#
#   bash .ci/format.sh          names the files that are not; exit 1 where there are any
#   bash .ci/format.sh --fix    lays them out
set -euo pipefail
cd "$(dirname "$0")/.."

mapfile -t sources < <(find libcore preprocess render tests -name '*.h' -o -name '*.cpp' 2>/dev/null | sort)
if [[ ${1:-} == --fix ]]; then
    clang-format -i "${sources[@]}"
    exit
fi

# One call for all: to start it takes longer than to read a file. What is wrong begins `FILE:LINE:`.
if ! said=$(clang-format --dry-run -Werror "${sources[@]}" 2>&1); then
    mapfile -t bad < <(sed -n 's/^\([^ :]*\):[0-9]*:[0-9]*: error:.*/\1/p' <<<"$said" | sort -u)
    printf '%s\n' "${bad[@]:-$said}"
    echo "clang-format: ${#bad[@]} of ${#sources[@]} files differ; bash .ci/format.sh --fix lays them out"
    exit 1
fi
echo "clang-format: ${#sources[@]} files are laid out"
