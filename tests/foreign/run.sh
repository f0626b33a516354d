#!/usr/bin/env bash
# Installs a build for a moment and uses it as a stranger would: bash tests/foreign/run.sh BUILD
#
# Programs run from a folder that the prefix was moved to; manual pages are there; a project of its
# own finds the library, renders and adds a method; uninstalling leaves nothing.
set -euo pipefail
build=$(realpath "$1")
sources=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
work=$(mktemp -d)
made=$build/install_folders.txt

# What the user installed from this build stays known.
for list in "$build/install_manifest.txt" "$made"; do
    [[ ! -e $list ]] || mv "$list" "$work/"
done
restore() {
    mv "$work/install_manifest.txt" "$work/install_folders.txt" "$build/" 2>/dev/null || true
    rm -rf "$work"
}
trap restore EXIT
fail() {
    echo "foreign: $*" >&2
    exit 1
}

cmake --install "$build" --prefix "$work/prefix" >"$work/install.log" || fail "$(<"$work/install.log")"
cp -r "$work/prefix" "$work/moved"

for program in compare merge render skeletonize study train voxelize; do
    "$work/moved/bin/lacuna-$program" --version >/dev/null || fail "lacuna-$program does not run"
    page=$work/moved/share/man/man1/lacuna-$program.1.gz
    [[ -s $page ]] || fail "lacuna-$program has no manual page"
    if command -v man >/dev/null; then
        messages=$(LC_ALL=C.UTF-8 MANWIDTH=80 man --warnings -l "$page" 2>&1 >/dev/null)
        [[ -z $messages ]] || fail "$page: $messages"
    fi
    [[ -s $work/moved/share/bash-completion/completions/lacuna-$program ]] ||
        fail "lacuna-$program has no completion"
done

"$work/moved/bin/lacuna-render" "$work/moved/share/lacuna/scenes/door.glb" -o "$work/door.exr" \
    --quiet --method bpt --width 32 --iterations 1 --cache "$work/cache" >/dev/null

export XDG_CACHE_HOME=$work/cache
cmake -S "$sources" -B "$work/foreign" -DCMAKE_BUILD_TYPE=Debug \
    -DCMAKE_PREFIX_PATH="$work/moved" >"$work/configure.log" || fail "$(<"$work/configure.log")"
cmake --build "$work/foreign" >"$work/build.log" || fail "$(<"$work/build.log")"
"$work/foreign/picture" || fail "a square of radiance 1.5 is another one"
"$work/foreign/method" "$work/moved/share/lacuna/scenes/door.glb" ||
    fail "a method from outside makes another picture than pt"

cmake -DBUILD="$build" -DFOLDERS="$made" -P "$sources/../../render/install/uninstall.cmake"
left=$(find "$work/prefix" -mindepth 1)
[[ -z $left ]] || fail "expected nothing after uninstalling, found: $left"
