# Sourced by render/demo.sh and tests/run.sh: where the project is, its packages, configure and build.
# .ci/packages is the only list of packages.

project=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build="$project/build"
export LC_ALL=C  # decimal points, whatever the country

say() { printf '\n== %s\n' "$*" >&2; }

fail() {
    printf 'error: %s\n' "$*" >&2
    exit 1
}

# install_packages KIND...: installs what is missing of these kinds of .ci/packages.
install_packages() {
    local kind package _ missing=()
    if ! { command -v apt-get && command -v dpkg-query; } >/dev/null; then
        fail "expected Debian 12 (apt-get), found another system; install what .ci/packages" \
            "lists by hand and build with: cmake --preset release && cmake --build --preset release"
    fi
    while read -r kind package _; do
        [[ " $* " == *" $kind "* ]] || continue
        [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) == installed ]] ||
            missing+=("$package")
    done <"$project/.ci/packages"
    if ((${#missing[@]} == 0)); then
        say "Packages: all there"
        return
    fi

    say "Packages: installing ${missing[*]}"
    local root=()
    if [[ $(id -u) != 0 ]]; then
        command -v sudo >/dev/null ||
            fail "expected root or sudo to install packages, found neither; as root, run:" \
                "apt-get install --no-install-recommends ${missing[*]}"
        root=(sudo)
    fi
    local apt=("${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -y -q
        -o Dpkg::Use-Pty=0 -o Acquire::Retries=3)
    # The lists may be old or not there at all.
    { "${apt[@]}" update &&
        "${apt[@]}" install --no-install-recommends "${missing[@]}"; } </dev/null >&2 ||
        fail "apt-get could not install ${missing[*]}; its own message is above"
}

# configure [-DNAME=VALUE...]: the preset `release`, in build/.
configure() {
    say "Configuring $build"
    # Imath's own configuration reports a Python module that Debian packages apart: noise.
    (cd "$project" && cmake --preset release "$@") >&2
}

# build_targets [TARGET...]: all targets where none is named.
build_targets() {
    local targets=()
    (($# == 0)) || targets=(--target "$@")
    say "Building ${*:-everything} with $(nproc) jobs"
    (cd "$project" && cmake --build --preset release --parallel "$(nproc)" "${targets[@]}") >&2
}
