#!/bin/sh
# Installs twinecho in .venv where needed, and runs the main job; arguments replace it.
. "$(dirname "$0")/setup.sh"
[ $# -gt 0 ] || set -- run box-scene wrap-errors --quick
exec .venv/bin/twinecho "$@"
