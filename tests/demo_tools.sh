#!/usr/bin/env bash
# Checks that render/demo.sh builds every program that the READMEs use, because newcomers copy commands from them.
# bash tests/demo_tools.sh BUILD
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

target=$(sed -n 's/^build_targets //p' render/demo.sh)
built=$(ninja -C "$1" -t inputs "$target")
missing=()
while read -r program; do
    grep -q "/CMakeFiles/$program\.dir/" <<<"$built" || missing+=("$program")
done < <(grep -oh 'lacuna-[a-z]\+' README.md */README.md | sort -u)
if ((${#missing[@]} > 0)); then
    echo "$target: expected it to build all tools, found it without ${missing[*]}" >&2
    exit 1
fi
