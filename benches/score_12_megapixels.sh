#!/usr/bin/env bash
# Photos a second, end to end, at 12 megapixels: `scaleproof score` against benches/python_pipeline.py, same threads, same photos.
#
#   benches/score_12_megapixels.sh FOLDER PYTHON WEIGHTS [THREADS] [COPIES]
#
# FOLDER is made and filled (about 20 MB a copy); PYTHON has opencv-python-headless, onnxruntime, pycocotools and numpy; WEIGHTS is a folder with
# yolox_nano.onnx. The photos are the sixteen plain and random ones of captures/skyline enlarged to 4000×3000 px, each COPIES (8) times with other bytes at its end, so that
# nothing is known from before. Build first, by any ./run command. Start-up of both programs counts.
set -euo pipefail
folder=$1 python=$2 weights=$3 threads=${4:-2} copies=${5:-8}
home=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
program=${SCALEPROOF:-$home/target/release/scaleproof}

"$python" - "$home/captures/skyline" "$folder" "$copies" <<'PYTHON'
import json, shutil, sys
from pathlib import Path
import cv2
source, folder, copies = Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3])
(folder / "tags").mkdir(parents=True, exist_ok=True)
session = json.loads((source / "session.json").read_text())
photos = []
for photo in [photo for photo in session["photos"] if photo["variant"] in ("normal", "random")]:
    picture = cv2.resize(cv2.imread(str(source / photo["file"])), (4000, 3000), interpolation=cv2.INTER_CUBIC)
    jpeg = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, 92])[1].tobytes()
    for copy in range(copies):
        name = f"{copy:02}_{photo['file']}"
        (folder / "tags" / name).write_bytes(jpeg + str(copy).encode())
        photos.append({**photo, "file": name, "place": f"place {copy}"})  # of one place they would count once
for name in ["scene.toml", "camera.yaml"]:
    shutil.copy(source / name, folder / "tags" / name)
(folder / "tags" / "session.json").write_text(json.dumps({**session, "photos": photos}))
PYTHON

# rate WHAT COMMAND…: photos a second by the clock, and the processor's milliseconds for each, which other programs disturb less
rate() {
  local what=$1 times; shift
  times=$( { TIMEFORMAT='%R %U %S'; time "$@" >/dev/null 2>&1; } 2>&1 )
  awk -v what="$what" -v n="$photos" '{ printf "%-48s %6.1f photos/s  %5.0f ms of processor a photo\n", what, n / $1, 1000 * ($2 + $3) / n }' <<<"$times"
}
score() { rm -rf "$folder/cache"; "$program" score "$1" --detector yolox_nano --detectors "$weights" --threads "$threads" --cache "$folder/cache" \
  --out "$2"; }
photos=$((16 * copies))

score "$folder/tags" "$folder/out" >/dev/null 2>&1   # also gives the truth for the others
"$python" - "$folder" <<'PYTHON'
import csv, json, shutil, sys
from pathlib import Path
folder = Path(sys.argv[1])
(folder / "given").mkdir(exist_ok=True)
rows = {row["file"]: row for row in csv.DictReader(open(folder / "out/photos.csv"))}
session = json.loads((folder / "tags/session.json").read_text())
for photo in session["photos"]:
    row = rows[photo["file"]]
    photo["box_xyxy_px"] = [float(row[f"truth_{side}_px"]) for side in ["x1", "y1", "x2", "y2"]]
    photo["viewpoint"] = {key: float(row[key]) for key in ["azimuth_deg", "pitch_deg", "distance_mm"]}
    link = folder / "given" / photo["file"]
    if not link.exists():
        link.hardlink_to(folder / "tags" / photo["file"])
for name in ["scene.toml", "camera.yaml"]:
    shutil.copy(folder / "tags" / name, folder / "given" / name)
(folder / "given/session.json").write_text(json.dumps(session))
PYTHON

python_run() { "$python" "$home/benches/python_pipeline.py" "$folder/tags" "$folder/out/coco_truth.json" "$weights/yolox_nano.onnx" \
  --threads "$threads" "$@"; }
echo "$photos photos of 4000×3000 px, $threads threads"
rate "scaleproof score, poses from the tags" score "$folder/tags" "$folder/out"
rate "scaleproof score, the same again (kept results)" "$program" score "$folder/tags" --detector yolox_nano --detectors "$weights" \
  --threads "$threads" --cache "$folder/cache" --out "$folder/out"
rate "scaleproof score, truth and viewpoint given" score "$folder/given" "$folder/out_given"
rate "Python, truth given" python_run
rate "Python, truth given, a pool of threads" python_run --pool
rate "Python, tags searched too" python_run --tags
rate "Python, tags searched too, a pool of threads" python_run --tags --pool
echo "AP@0.5 and others of scaleproof, by texture:"
"$program" score "$folder/given" --detector yolox_nano --detectors "$weights" --cache "$folder/cache" --out "$folder/out_given" 2>/dev/null |
  head -2
echo "of Python: $(python_run | tail -1)"
