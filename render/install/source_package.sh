#!/usr/bin/env bash
# Makes Debian's source package of the last commit and builds its packages: bash render/install/source_package.sh OUT
#
#   --source   only makes the source package
#
# Needs debhelper and dpkg-dev in addition to the packages of .ci/packages; runs lintian if it is installed.
set -euo pipefail
project=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")
options=(-us -uc)
if [[ ${1:-} == --source ]]; then
    options+=(-S -d)
    shift
fi
if (($# != 1)) || [[ $1 == -* ]]; then
    sed -n '2,6s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
    exit 2
fi
mkdir -p "$1"
out=$(realpath "$1")
debian=$project/render/install/debian
version=$(sed -n '1s/^lacuna (\(.*\)-[0-9]*).*/\1/p' "$debian/changelog")
folder=$out/lacuna-$version
rm -rf "$folder"

git -C "$project" archive --format=tar --prefix="lacuna-$version/" HEAD |
    xz -T0 >"$out/lacuna_$version.orig.tar.xz"
tar -C "$out" -xf "$out/lacuna_$version.orig.tar.xz"
cp -r "$debian" "$folder/debian"
packages=$(awk '$1 == "build" && $2 != "g++" { printf "%s%s", between, $2; between = ", " }' "$project/.ci/packages")
sed -i "s/@PACKAGES@/$packages, libopenmpi-dev/" "$folder/debian/control"
cd "$folder"
dpkg-buildpackage "${options[@]}"
if command -v lintian >/dev/null; then
    lintian --allow-root --no-cfg -i --fail-on error,warning ../lacuna_"$version"-*.changes
fi
