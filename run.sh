#!/bin/sh
# Installs twinecho in .venv where needed, and runs the main job; arguments replace it.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
(. "$here/setup.sh")
[ $# -gt 0 ] || set -- run box-scene wrap-errors --quick
exec "$here/.venv/bin/twinecho" "$@"
