#!/usr/bin/env bash
# Makes scaleproof-VERSION-x86_64-linux.tar.xz: a folder that runs wherever it lies, with nothing installed, on any Linux whose libc is not older
# than this machine's. Called by `./run package`, after the build.
#
#   .ci/package.sh                   the archive, in out/package
#   .ci/package.sh --folder DIR      only the folder that is packed
set -euo pipefail

home=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
asked=''
if [ "${1:-}" = --folder ]; then
  asked=$(realpath -m -- "${2:?--folder needs a folder}")
  [ ! -e "$asked" ] || { printf 'error: %s is there already: name a new folder\n' "$asked" >&2; exit 2; }
fi
cd "$home"
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$home/target}"

# What cargo and `./run test` tell a test that calls this: build scripts would run again for it, now and in the next `./run test`.
for name in $(compgen -e CARGO_PKG_) $(compgen -e CARGO_MANIFEST_) RUSTC_BOOTSTRAP; do unset "$name"; done

say() { printf '[package] %s\n' "$*" >&2; }
stop() { printf 'error: %s\n' "$*" >&2; exit 2; }
# shellcheck source=.ci/carried.sh
. "$home/.ci/carried.sh"

version=$(sed -n '/^version = / { s/.*"\(.*\)"/\1/p; q }' Cargo.toml)
name="scaleproof-$version-$(uname -m)-linux"
folder=${asked:-$home/out/package/$name}
[ -n "$asked" ] || rm -rf "$home/out/package/$name"
onnxruntime=$(dirname "${ORT_DYLIB_PATH:-/}")
for text in LICENSE ThirdPartyNotices.txt; do
  [ -e "$onnxruntime/$text" ] || stop "ONNX Runtime with its licence is not in $onnxruntime: ./run fetches it where there is a network"
done
mkdir -p "$folder/lib" "$folder/licences"

# The program, which looks for its libraries beside itself; so do the libraries, for theirs (an RPATH, not a RUNPATH).
say "linking"
cargo rustc --quiet --release --locked --bin scaleproof -- \
  -C strip=symbols -C 'link-arg=-Wl,--disable-new-dtags,-rpath,$ORIGIN/lib'
cp "$CARGO_TARGET_DIR/release/scaleproof" "$folder/"

say "libraries"
carry_libraries "$folder/scaleproof" "$folder/lib" "$folder/licences"

runtime=$(basename "$(realpath "$ORT_DYLIB_PATH")")
cp "$onnxruntime/$runtime" "$folder/lib/"
ln -s "$runtime" "$folder/lib/libonnxruntime.so"
for text in LICENSE ThirdPartyNotices.txt; do
  cp "$onnxruntime/$text" "$folder/licences/onnxruntime-$text"
done

say "licences"
carry_licences "$folder/licences"

say "manual pages, completions, the stored photos, the guide"
"$folder/scaleproof" manuals -o "$folder/man/man1" >/dev/null
mkdir -p "$folder/completions"
for shell in bash zsh fish; do
  "$folder/scaleproof" completions "$shell" > "$folder/completions/scaleproof.$shell"
done
# What belongs to the project, and not what else lies in its folders.
parts=(captures calibration detectors docs print_templates crates/detect/src/manifests ARCHITECTURE.md CHANGELOG.md)
{ git -c safe.directory='*' ls-files -z "${parts[@]}" 2>/dev/null || find "${parts[@]}" -type f -print0; } | tar -c --null -T - | tar -x -C "$folder"
{ sed -n 1p README.md; printf '\n(This is the unpacked archive: type `./scaleproof` wherever this page and the guide have `./run`.)\n'; sed 1d README.md; } > "$folder/README.md"

[ -z "$asked" ] || exit 0
say "packing"
archive="$home/out/package/$name.tar.xz"
tar -C "$(dirname "$folder")" --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner -c "$name" | xz -T0 -6 > "$archive.partial"
mv "$archive.partial" "$archive"
say "$(du -m "$archive" | cut -f1) MB; needs glibc $(ldd --version | sed -n '1s/.* //p') or newer"
printf '%s\n' "$archive"
