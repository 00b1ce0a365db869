#!/bin/sh
# Installs twinecho in .venv where needed, checks style and types, and passes the tests; arguments go to pytest.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$here"
. "$here/setup.sh"
.venv/bin/ruff check --quiet
.venv/bin/ruff format --check --quiet
.venv/bin/mypy --no-error-summary
exec .venv/bin/python -m pytest -n 2 --dist worksteal "$@"
