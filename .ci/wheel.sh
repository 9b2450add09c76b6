#!/usr/bin/env bash
# Makes out/wheel/scaleproof-VERSION-cp310-abi3-manylinux_….whl of the module that cargo built: the Python package, the program, the libraries they
# are linked with beyond what every Linux with Python has, the stored photos, and all licences. Called by `./run wheel`, after the build.
#
#   .ci/wheel.sh
set -euo pipefail

home=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$home"
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$home/target}"
say() { printf '[wheel] %s\n' "$*" >&2; }
stop() { printf 'error: %s\n' "$*" >&2; exit 2; }
# shellcheck source=.ci/carried.sh
. "$home/.ci/carried.sh"

module="$CARGO_TARGET_DIR/release/libscaleproof_python.so"
[ -e "$module" ] || stop "there is no $module: ./run wheel builds it"
version=$(sed -n '/^version = / { s/.*"\(.*\)"/\1/p; q }' Cargo.toml)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
package="$work/scaleproof" licences="$work/scaleproof-$version.dist-info/licenses"
mkdir -p "$package/libs" "$package/share" "$licences"

cp -r python/scaleproof/. "$package/"
cp -r python/scaleproof_detector "$work/"
find "$work" -name __pycache__ -prune -exec rm -rf {} +
strip -o "$package/_native.abi3.so" "$module"
say "libraries and licences"
# libstdc++, libgcc and zlib are in every Linux with Python; of two libstdc++ in one process the older would break the newer one's users.
carry_libraries "$module" "$package/libs" "$licences" '^lib(stdc\+\+|gcc_s|z)\.so'
find "$package/libs" -type f -exec strip --strip-unneeded {} +
carry_licences "$licences" -p scaleproof-python
# The session and the detector of `scaleproof demo`, and the calibration boards.
{ git -c safe.directory='*' ls-files -z captures/skyline calibration detectors 2>/dev/null || find captures/skyline calibration detectors -type f -print0; } |
  tar -c --null -T - | tar -x -C "$package/share"

python3 python/pack.py "$work" "$version" "$home/out/wheel"
