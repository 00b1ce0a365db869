# Makes the local virtual environment, or brings it up to date; sourced by `run.sh` and `test.sh`, which set $here.
set -eu
cd "${here:-.}"
python=${PYTHON:-python3}
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || {
    echo "Python is $("$python" -V 2>&1); it must be 3.11 or later (name another with PYTHON=...)" >&2
    exit 2
}
[ -x .venv/bin/python ] || "$python" -m venv .venv
if ! cmp -s pyproject.toml .venv/installed.toml; then
    .venv/bin/python -m pip install --quiet --disable-pip-version-check --editable '.[test]'
    cp pyproject.toml .venv/installed.toml
fi
