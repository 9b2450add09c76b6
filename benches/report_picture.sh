#!/usr/bin/env bash
# docs/report.png: what the demo's report begins with, as on a screen 1280 px wide.
#
#   ./run demo && benches/report_picture.sh out/demo/report.html docs/report.png
#
# Needs Chromium (or $CHROMIUM).
set -euo pipefail
"${CHROMIUM:-chromium}" --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=1280,1130 --screenshot="$(realpath "$2")" "file://$(realpath "$1")" 2>/dev/null
