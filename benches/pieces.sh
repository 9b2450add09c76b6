#!/usr/bin/env bash
# The table of pieces in docs/guide/reference/measured.md: pieces, stretch, sheets and length to cut, for several bounds, on two cars on A3.
#
#   benches/pieces.sh SKYLINE ETRON
#
# SKYLINE: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0). ETRON: the folder of model_save.obj and exterior_face.txt (RAUCA).
set -euo pipefail
if [ $# -ne 2 ]; then
    echo "usage: $0 SKYLINE ETRON" >&2
    exit 2
fi
home="$(dirname "$0")/.."
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
skyline=(--mesh "$1" --material Material.001 --length-mm 455)
etron=(--mesh "$2/model_save.obj" --faces "$2/exterior_face.txt" --length-mm 490)

row() {
    local name=$1 pieces=$2 stretch=$3
    shift 3
    "$home/run" --quiet print wrap "$@" --pattern "$home/print_templates/random16.png" --tile-mm 118 --paper a3 --dpi 72 --pieces "$pieces" --max-stretch "$stretch" \
        --json -o "$folder/pieces.pdf" >"$folder/pieces.json" 2>"$folder/said" || { echo "| $name | $pieces, $stretch | $(tail -n 1 "$folder/said") |"; return; }
    jq -r --arg name "$name" --arg asked "$pieces, $stretch" '"| \($name) | \($asked) | \(.pieces | length) | \(.sheets) | \(.mean_stretch * 1000 | round / 1000) | \(.stretch_99 * 1000 | round / 1000) | \(.largest_stretch * 100 | round / 100) | \(.cut_mm / 100 | round / 10) m | \(1000 * .surface_mm2 / .visible_mm2 | round / 10) % |"' "$folder/pieces.json"
}

echo "| model | at most: pieces, 99 % stretch | pieces | sheets | mean stretch | 99 % | largest | to cut | of the visible paint |"
echo "|---|---|---|---|---|---|---|---|---|"
# Constants: commit 86c8916 was the last with strips.
echo "| skyline, panels | | 5 | 8 | 1.053 | | 1.57 | 15.2 m | |"
echo "| skyline, panels and strips (86c8916) | | 97 | 11 | 1.030 | | 1.50 | 22.1 m | |"
for asked in "16 1.2" "24 1.2" "24 1.1" "48 1.2"; do
    # shellcheck disable=SC2086
    row skyline $asked "${skyline[@]}"
done
echo "| e-tron, panels | | 5 | 8 | 1.082 | | 1.68 | 26.3 m | |"
echo "| e-tron, panels and strips (86c8916) | | 192 | 14 | 1.037 | | 1.68 | 43.5 m | |"
for asked in "24 1.2" "36 1.2" "36 1.1" "60 1.2"; do
    # shellcheck disable=SC2086
    row e-tron $asked "${etron[@]}"
done
