#!/usr/bin/env bash
# Checks that the sources are formatted as .clang-format says (clang-format 14 of Debian 12).
#
#   bash .ci/format.sh          names the files that are not; exit 1 if there are any
#   bash .ci/format.sh --fix    formats them
set -euo pipefail
cd "$(dirname "$0")/.."

mapfile -t sources < <(find libcore preprocess render tests -name '*.h' -o -name '*.cpp' 2>/dev/null | sort)
if [[ ${1:-} == --fix ]]; then
    clang-format -i "${sources[@]}"
    exit
fi

# One call for all files, because starting it takes longer than reading a file. Errors begin with `FILE:LINE:`.
if ! said=$(clang-format --dry-run -Werror "${sources[@]}" 2>&1); then
    mapfile -t bad < <(sed -n 's/^\([^ :]*\):[0-9]*:[0-9]*: error:.*/\1/p' <<<"$said" | sort -u)
    printf '%s\n' "${bad[@]:-$said}"
    echo "clang-format: ${#bad[@]} of ${#sources[@]} files differ; bash .ci/format.sh --fix lays them out"
    exit 1
fi
echo "clang-format: ${#sources[@]} files are laid out"
