#!/usr/bin/env bash
# The C libraries under sanitizers: C AprilTag, compiled with AddressSanitizer, and OpenCV, the system's, whose heap AddressSanitizer watches
# where it calls the C library, and valgrind, on fewer pictures, everywhere.
#
#   fuzz/sanitize.sh              all parts
#   fuzz/sanitize.sh PART …       some of them
#
#   raw       C AprilTag below this program's guard, every size from 1×1 to 64×64: from which size on it is clean. Sizes below the guard
#             (LEAST_SIDE_PX in crates/pose/src/tags/search.rs) are expected to fail: that they do shows that the sanitizer is on
#   sizes     the same sizes through every tag detector
#   photos    the stored photos, whole and shrunk by 2, 3 and 4, through every tag detector and the pose
#   corpus    fuzz/corpus through its parsers, its photos through every tag detector
#   boards    the stored board photos through the calibration
#   valgrind  some sizes, two photos and one board photo under valgrind's memcheck
#
# Needs gcc with libasan, valgrind, and no nightly compiler: stable Rust is not instrumented itself, but calls the same malloc. Builds into
# fuzz/target-asan, or CARGO_TARGET_DIR: on two cores some 15 minutes the first time, of which the second program takes 3; then all parts
# take some 45 minutes on one core. What each process said lies in sanitize/ there.
#
# Exit code: 0 when nothing was found, 1 when something was, 2 when a part could not run.
set -euo pipefail

fuzz=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
program=scaleproof-sanitize
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$fuzz/target-asan}
mkdir -p "$CARGO_TARGET_DIR"
CARGO_TARGET_DIR=$(cd "$CARGO_TARGET_DIR" && pwd)
logs=$CARGO_TARGET_DIR/sanitize
mkdir -p "$logs"

# The parsers write files; none of them stays.
TMPDIR=$(mktemp -d); export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT

# A graphics driver's own faults are not asked for.
export OPENCV_OPENCL_RUNTIME=disabled
# Leaks are not: some of what Rust and OpenCV hold until the end has no pointer left. An absurd size is refused as without the sanitizer.
export ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1

say() { printf '[sanitize] %s\n' "$*"; }
stop() { printf 'error: %s\n' "$*" >&2; exit 2; }

# --- building --------------------------------------------------------------------------------------------------------

# The program NAME, its C compiled with FLAGS. Only AprilTag's C and what stands on it differ between the two programs, so that they share
# all other dependencies; .cargo/config.toml has AprilTag compiled from the crate's own source.
build() { # NAME FLAGS, and what the last crate is compiled with
  local name=$1 flags=$2 triple
  shift 2
  triple=$(rustc -vV | sed -n 's/^host: //p' | tr - _)
  say "building $program-$name"
  cp "$fuzz/../Cargo.lock" "$fuzz/sanitize/" # the libraries as the program has them; what is not used is left out
  (cd "$fuzz/sanitize" && env "CC_$triple=gcc" "CFLAGS_$triple=$flags" \
    cargo rustc --release --quiet --bin "$program" -- -C linker=gcc "$@") || stop "the program was not built"
  cp "$CARGO_TARGET_DIR/release/$program" "$CARGO_TARGET_DIR/$program-$name"
}

# gcc links libasan, as the first library, only where it may link its own libraries at all, which Rust forbids by default.
build_asan() {
  local symbols
  build asan '-fsanitize=address -fno-omit-frame-pointer -g -O1' -C default-linker-libraries=yes -C link-arg=-fsanitize=address
  symbols=$(nm -D --undefined-only "$CARGO_TARGET_DIR/$program-asan")
  [[ $symbols == *__asan_report_* ]] || stop "the C code was compiled without AddressSanitizer"
}

build_plain() { build plain '-g -O1'; }

# --- running ---------------------------------------------------------------------------------------------------------

findings=0
most_findings=20 # of a part; what fails everywhere needs no longer list

# Runs PART to its end: whatever ends the process is a finding of the item it was on, and the next process begins behind it. Findings stand
# in $logs/LABEL/failed, one a line.
run_part() { # LABEL PART MOST few|'' COMMAND…
  local label=$1 part=$2 most=$3 few=$4 first=0 status log last kind number name
  shift 4
  local folder=$logs/$label
  rm -rf "$folder"
  mkdir -p "$folder"
  : >"$folder/failed"
  while :; do
    log=$folder/$first.log
    status=0
    # shellcheck disable=SC2086  # no argument when it is empty
    timeout --kill-after=30 7200 "$@" "$part" "$first" $few >"$log" 2>&1 || status=$?
    last=$(grep -aE '^(item|end) [0-9]+' "$log" | tail -n 1) || true
    read -r kind number name <<<"$last"
    case "$kind" in
      end)
        # valgrind goes on behind an error, and says so at the end.
        [ "$status" -eq 0 ] || printf 'errors while it went on: %s\n' "$log" >>"$folder/failed"
        say "$label: $number items, $(wc -l <"$folder/failed") findings"
        return ;;
      item) printf '%s\t%s\t%s\n' "$name" "$(why "$status" "$log")" "$log" >>"$folder/failed" ;;
      *) tail -n 5 "$log" >&2; stop "$label did not begin, see $log" ;;
    esac
    if [ "$(wc -l <"$folder/failed")" -ge "$most" ]; then
      say "$label: given up after $most findings, at item $number"
      return
    fi
    first=$((number + 1))
  done
}

# The line that says most of what ended a process.
why() { # STATUS LOG
  grep -aoE -m 1 'AddressSanitizer:.*|Assertion .*|panicked at .*|Process terminating .*' "$2" || printf 'exit code %s' "$1"
}

# As run_part, and whatever is found counts.
check() {
  local label=$1 found
  run_part "$@"
  found=$(wc -l <"$logs/$label/failed")
  findings=$((findings + found))
  sed 's/^/    /' "$logs/$label/failed"
}

asan_part() { check "$1" "$1" "$most_findings" '' "$CARGO_TARGET_DIR/$program-asan"; }

raw() {
  local failed=$logs/raw/failed least clean
  least=$(sed -n 's/^const LEAST_SIDE_PX: u32 = \([0-9]*\);.*/\1/p' "$fuzz/../crates/pose/src/tags/search.rs")
  [ -n "$least" ] || stop "LEAST_SIDE_PX is no longer in crates/pose/src/tags/search.rs: say here where the guard is"
  run_part raw raw 4096 '' "$CARGO_TARGET_DIR/$program-asan"
  [ -s "$failed" ] || stop "no size failed, not even 1x1: is the sanitizer on, or was the library mended?"
  clean=$(sed 's/[x\t]/ /g' "$failed" | awk '{ least = $1 < $2 ? $1 : $2; if (least > worst) worst = least } END { print worst + 1 }')
  say "raw: C AprilTag is clean where both sides have $clean px or more; this program lets it see $least px or more"
  cut -f 2 "$failed" | sed -E 's/0x[0-9a-f]+|[0-9]{4,}/…/g' | sort | uniq -c | sort -rn | head -n 5 | sed 's/^/    /'
  if [ "$clean" -gt "$least" ]; then
    findings=$((findings + 1))
    say "raw: the guard is too low, see $failed"
  fi
}

valgrind_part() {
  local part log
  for part in sizes photos boards; do
    check "valgrind-$part" "$part" "$most_findings" few valgrind --tool=memcheck --error-exitcode=99 --leak-check=no --error-limit=no \
      --num-callers=30 "$CARGO_TARGET_DIR/$program-plain"
    for log in "$logs/valgrind-$part"/*.log; do
      # An error's first line and the function it is in, once each.
      grep -aA 1 -E '^==[0-9]+== (Invalid|Conditional jump|Use of|Syscall param|Source and destination|Mismatched|Process term)' "$log" |
        sed -E 's/^==[0-9]+== *//; s/0x[0-9A-Fa-f]+/…/' | paste -sd ' ' | sed 's/ -- /\n/g' | sed "/^$/d" | sort | uniq -c | sort -rn | head -n 10 || true
    done
  done
}

main() {
  local part parts=("$@") needs_asan='' needs_plain=''
  [ $# -gt 0 ] || parts=(raw sizes photos corpus boards valgrind)
  for part in "${parts[@]}"; do
    case "$part" in
      raw | sizes | photos | corpus | boards) needs_asan=1 ;;
      valgrind) needs_plain=1; command -v valgrind >/dev/null || stop "valgrind is missing: apt-get install valgrind" ;;
      *) stop "there is no part $part: raw, sizes, photos, corpus, boards or valgrind" ;;
    esac
  done
  command -v cargo >/dev/null || stop "Rust is missing: install it with rustup (https://rustup.rs)"
  command -v gcc >/dev/null || stop "gcc is missing: apt-get install gcc"
  [ -z "$needs_asan" ] || build_asan
  [ -z "$needs_plain" ] || build_plain
  for part in "${parts[@]}"; do
    case "$part" in
      raw) raw ;;
      valgrind) valgrind_part ;;
      *) asan_part "$part" ;;
    esac
  done
  say "$findings findings"
  [ "$findings" -eq 0 ]
}

main "$@"
