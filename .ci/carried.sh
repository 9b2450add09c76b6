# shellcheck shell=bash
# What the archive and the wheel carry beside the program: libraries and licences. Sourced; `say` and `stop` are the caller's.

# What every Linux has: the C library and what belongs to it.
is_libc() { case "$1" in linux-vdso*|ld-linux*|libc.so*|libm.so*|libdl.so*|libpthread.so*|librt.so*|libresolv.so*|libutil.so*) true ;; *) false ;; esac; }

# carry_libraries BINARY LIB_FOLDER LICENCE_FOLDER [REGEX]: the libraries that a binary is linked with, but those of libc and those that match, each
# with the licence of its Debian package.
carry_libraries() {
  local linked library path real package
  command -v dpkg-query >/dev/null || stop "there is no dpkg-query: the licences of the libraries are looked up in Debian's packages"
  linked=$(ldd "$1" | awk '$2 == "=>" { print $1, $3 }' | sort)
  while read -r library path; do
    if is_libc "$(basename "$library")"; then continue; fi
    if [[ -n ${4:-} && $library =~ ${4:-} ]]; then continue; fi
    [ -e "$path" ] || stop "the library $library was not found"
    cp -L "$path" "$2/$library"
    # Some packages list their files under /lib, which is /usr/lib by now.
    real=$(realpath "$path")
    package=$({ dpkg-query -S "$real" || dpkg-query -S "${real#/usr}"; } 2>/dev/null | head -1 | cut -d: -f1) || true
    [ -e "/usr/share/doc/$package/copyright" ] || stop "no licence found for $library"
    cp "/usr/share/doc/$package/copyright" "$3/$package.txt"
  done <<< "$linked"
}

# carry_licences LICENCE_FOLDER ARGUMENT…: the texts that every crate in the program came with, and the names of their licences; the arguments are
# cargo's for the program.
carry_licences() {
  local folder=$1 sources="${CARGO_HOME:-$HOME/.cargo}/registry/src" crate number text
  shift
  cargo tree --locked "$@" -e normal --prefix none --format '{p} | {l}' | sed 's/ (\*)$//; s/ (proc-macro)//' | sort -u |
    grep -v '^scaleproof' > "$folder/crates.txt"
  while read -r crate number _; do
    # Crates of one version come from one place.
    for text in "$sources"/*/"$crate-${number#v}"/{LICENSE,LICENCE,License,COPYING,COPYRIGHT,NOTICE,UNLICENSE,license}*; do
      [ -f "$text" ] || continue
      cp --no-preserve=mode "$text" "$folder/crate-$crate-$(basename "$text").txt"
    done
  done < "$folder/crates.txt"
  cp LICENSE-APACHE LICENSE-MIT "$folder/"
  cp crates/core/fonts/*[Ll][Ii][Cc][Ee]* "$folder/" 2>/dev/null || true
}
