# Sourced by the scripts here, from the repository root. set_up EXTRA makes .venv hold polycnc with that extra;
# once that is done it needs no network until pyproject.toml changes.

python=.venv/bin/python

say() {
    printf '%s\n' "$*" >&2
}

suitable() {
    "$1" -c 'import ensurepip, sys, venv
sys.exit(sys.implementation.name != "cpython" or sys.version_info < (3, 11))' >/dev/null 2>&1
}

find_python() {
    for candidate in ${POLYCNC_PYTHON:+"$POLYCNC_PYTHON"} python3.13 python3.12 python3.11 python3 python; do
        if suitable "$candidate"; then
            printf '%s\n' "$candidate"
            return
        fi
    done
    say "polycnc needs CPython 3.11 or newer with the venv module, and none was found on the PATH."
    say "Install one (on Debian and Ubuntu: python3 and python3-venv), or name it: POLYCNC_PYTHON=/path/to/python3"
    return 1
}

# The environment remembers where it was made: one that was copied or moved along with the folder is made anew.
usable() {
    "$python" -c 'import pip' >/dev/null 2>&1 || return 1
    [ ! -f .venv/polycnc-home ] || [ "$(cat .venv/polycnc-home)" = "$PWD" ]
}

set_up() {
    if ! usable; then
        interpreter=$(find_python) || exit 1
        say "Making .venv with $("$interpreter" --version) ..."
        "$interpreter" -m venv --clear .venv
    fi
    printf '%s\n' "$PWD" >.venv/polycnc-home
    wanted=$(cksum <pyproject.toml)
    stamp=.venv/polycnc-installed-$1
    wider="test all" # test has everything but what builds the documentation
    [ "$1" != all ] || wider=""
    for name in "$1" $wider; do
        installed=.venv/polycnc-installed-$name
        if [ -f "$installed" ] && [ "$(cat "$installed")" = "$wanted" ]; then
            return
        fi
    done
    say "Installing polycnc and what it needs into .venv (only when pyproject.toml has changed) ..."
    PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_INPUT=1 "$python" -m pip install --quiet -e ".[$1]" </dev/null || {
        say "The installation failed; pip says why above. It needs the Python package index or a mirror of it."
        exit 1
    }
    printf '%s\n' "$wanted" >"$stamp"
}
