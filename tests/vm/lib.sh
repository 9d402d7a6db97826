# What the scripts of this folder share: packages, a root file system in memory, a boot.

vm=$PWD/target/vm

skip() { echo "skipped: $*" >&2; exit 77; }

# read_options ARGUMENT...   sets `install`, `keep`, `filter` and `tests` by what the script was given
read_options() {
  tests=() keep= install= filter=--skip=numbers::
  while [ $# -gt 0 ]; do
    case $1 in
      --install) install=yes ;;
      --numbers) filter=numbers::; VM_SECONDS=${VM_SECONDS:-400} ;;
      --keep) keep=${2:?--keep needs a folder}; shift ;;
      -*) sed -n '2,/^set/{/^set/!s/^# \{0,1\}//p}' "$0"; exit 2 ;;
      *) tests+=("$1") ;;
    esac
    shift
  done
}

# need INSTALL THING:PACKAGE...   the commands, or files by a pattern with a slash, are there, or are installed, or all is skipped
need() {
  local install=$1 missing=() pair
  shift
  for pair in "$@"; do
    case ${pair%%:*} in
      /*) compgen -G "${pair%%:*}" > /dev/null ;;
      *) command -v "${pair%%:*}" > /dev/null ;;
    esac || missing+=("${pair##*:}")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  if [ -n "$install" ] && [ "$(id -u)" = 0 ] && command -v apt-get > /dev/null; then
    { apt-get update --quiet && DEBIAN_FRONTEND=noninteractive apt-get install --yes --quiet --no-install-recommends "${missing[@]}"; } \
      > /dev/null || skip "apt-get can't install ${missing[*]}"
  else
    skip "no ${missing[*]} here: apt-get install ${missing[*]}, or run this with --install"
  fi
}

# suite_apt SUITE COMMAND...   apt of another release of Debian, from the mirror that this machine uses, with a state of its own
suite_apt() {
  local suite=$1 tool=$2 state=$vm/apt-$1
  shift 2
  mkdir -p "$state"/{lists/partial,cache/archives/partial,parts}
  touch "$state/status"
  "$tool" -o APT::Sandbox::User=root -o Dir::Etc::sourceparts="$state/parts" -o Dir::Etc::sourcelist=/dev/null -o Dir::State="$state" \
    -o Dir::State::status="$state/status" -o Dir::Cache="$state/cache" -o APT::Architecture=amd64 -o APT::Architectures=amd64 \
    -o APT::Install-Recommends=false -o Acquire::Languages=none "$@"
}

# suite_update SUITE   the lists of a release; once a day is enough
suite_update() {
  local suite=$1 state=$vm/apt-$1 here file
  [ -z "$(find "$state/updated" -mtime -1 2> /dev/null)" ] || return 0
  command -v apt-get > /dev/null || skip "no apt-get here, which brings the kernel"
  here=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
  mkdir -p "$state/parts"
  for file in /etc/apt/sources.list /etc/apt/sources.list.d/debian.sources; do
    [ ! -s "$file" ] || sed "s/\b$here\b/$suite/g" "$file" > "$state/parts/${file##*/}"
  done
  suite_apt "$suite" apt-get update --quiet > "$state/log" 2>&1 || skip "apt can't reach Debian's $suite: $(tail -n 1 "$state/log")"
  touch "$state/updated"
}

# fetch_kernel SUITE   sets `kernel` to a folder with boot/ and lib/modules/
fetch_kernel() {
  local suite=$1 package
  kernel=$vm/$suite
  [ ! -e "$kernel/whole" ] || return 0
  suite_update "$suite"
  package=$(suite_apt "$suite" apt-cache depends linux-image-amd64 | sed -n 's/.*Depends: \(linux-image-[0-9]\S*\)$/\1/p' | head -n 1)
  [ -n "$package" ] || skip "apt knows no linux-image-amd64 of $suite"
  echo "downloading $package of $suite" >&2
  rm -rf "$kernel"
  mkdir -p "$kernel"
  (cd "$kernel" && suite_apt "$suite" apt-get download --quiet "$package") > "$kernel.log" 2>&1 || skip "apt can't download $package: $(tail -n 1 "$kernel.log")"
  # Kept is what can matter here: 400 MB are network, graphics and the like.
  dpkg-deb --fsys-tarfile "$kernel"/*.deb | tar -x -C "$kernel" --wildcards './boot/vmlinuz*' '*/kernel/drivers/'{media,virtio,block,usb,dma-buf} \
    '*/kernel/'{fs,lib,crypto,arch} '*/kernel/drivers/input/input-core*' 2> /dev/null || true
  # Debian 13 has the modules under usr/.
  [ -d "$kernel/lib" ] || mv "$kernel/usr/lib" "$kernel/lib"
  rm -f "$kernel"/*.deb
  touch "$kernel/whole"
}

# fetch_libcamera INSTALL   sets `sysroot` to a folder with Debian 13's libcamera-dev and all that it needs, and what cargo needs to build with it
fetch_libcamera() {
  local package
  sysroot=$vm/libcamera
  need "$1" g++:g++ pkg-config:pkg-config '/usr/lib/llvm-*/lib/libclang*.so.1:libclang1-19' '/usr/lib/llvm-*/lib/clang/*/include/stddef.h:libclang-common-19-dev'
  if [ ! -e "$sysroot/whole" ]; then
    suite_update trixie
    echo "downloading libcamera-dev of trixie and what it needs" >&2
    rm -rf "$sysroot"
    mkdir -p "$sysroot"
    # apt holds each package to the hash that the release's signature vouches for.
    suite_apt trixie apt-get install --download-only --yes --quiet libcamera-dev > "$sysroot.log" 2>&1 \
      || skip "apt can't download libcamera-dev: $(tail -n 1 "$sysroot.log")"
    for package in "$vm"/apt-trixie/cache/archives/*.deb; do dpkg-deb --extract "$package" "$sysroot"; done
    suite_apt trixie apt-get clean
    touch "$sysroot/whole"
  fi
  export PKG_CONFIG_SYSROOT_DIR=$sysroot PKG_CONFIG_LIBDIR=$sysroot/usr/lib/x86_64-linux-gnu/pkgconfig
  LIBCLANG_PATH=$(dirname "$(compgen -G '/usr/lib/llvm-*/lib/libclang*.so.1' | sort --version-sort | tail -n 1)")
  export LIBCLANG_PATH
}

# test_program NAME   builds the tests of that name and says where the program is
test_program() {
  cargo test --no-run -p camif-vm --test "$1" 2>&1 | tee "$vm/build.log" | sed -n 's/.*Executable .*(\(.*\))$/\1/p' | grep . || { cat "$vm/build.log" >&2; exit 1; }
}

# new_root   a root file system with busybox
new_root() {
  local root=$vm/root
  rm -rf "$root" "$root".*
  mkdir -p "$root"/{bin,dev,proc,sys,tmp,out,lib/x86_64-linux-gnu,lib64,usr,modules}
  ln -s ../lib "$root/usr/lib"
  cp "$(command -v busybox)" "$root/bin/"
  cp tests/vm/init "$root/init"
  echo "$root"
}

# put_program ROOT FILE [NAME]   a program without its symbols, and the libraries that it needs
put_program() {
  local root=$1 file=$2 name=${3:-${2##*/}} library
  cp "$file" "$root/bin/$name"
  strip "$root/bin/$name" 2> /dev/null || true
  ldd "$file" | grep -o '/\S*' | while read -r library; do
    case $library in
      */ld-linux*) cp -nL "$library" "$root/lib64/" ;;
      *) cp -nL "$library" "$root/lib/x86_64-linux-gnu/" ;;
    esac
  done
}

# put_libraries ROOT SYSROOT FILE...   the libraries of SYSROOT that these need, and its loader
put_libraries() {
  local root=$1 from=$2/usr/lib file needed
  shift 2
  cp -L "$from"/x86_64-linux-gnu/ld-linux-x86-64.so.2 "$root/lib64/"
  for file in "$@"; do
    for needed in $(readelf --dynamic "$file" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p'); do
      [ ! -e "$root/lib/x86_64-linux-gnu/$needed" ] || continue
      # What it has not is the loader.
      [ -e "$from/x86_64-linux-gnu/$needed" ] || continue
      cp -L "$from/x86_64-linux-gnu/$needed" "$root/lib/x86_64-linux-gnu/"
      put_libraries "$root" "${from%/usr/lib}" "$root/lib/x86_64-linux-gnu/$needed"
    done
  done
}

# put_tests ROOT   what the machine is there for
put_tests() {
  echo "cd / && tests --ignored --test-threads=1 --nocapture $filter ${tests[*]+"${tests[*]}"}" > "$1/run-tests"
}

# put_modules ROOT MODULE...   kernel modules and those that they need, and the order in which to load them
put_modules() {
  local root=$1 module
  declare -A known=()
  shift
  for module in "$@"; do put_module "$root" "$module"; done
}

put_module() {
  local root=$1 module=${2//-/_} file needed
  [ -z "${known[$module]:-}" ] || return 0
  known[$module]=yes
  file=$(find "$kernel/lib/modules" -name "${module//_/[-_]}.ko*" | head -n 1)
  # What has no file is built in.
  [ -n "$file" ] || return 0
  case $file in
    *.xz) xz -dc "$file" ;;
    *.zst) zstd -dcq "$file" ;;
    *) cat "$file" ;;
  esac > "$root/modules/$module.ko"
  for needed in $(tr '\0' '\n' < "$root/modules/$module.ko" | sed -n 's/^depends=//p' | tr , ' '); do put_module "$root" "$needed"; done
  echo "$module" >> "$root/modules/order"
}

# boot ROOT KEEP QEMU-OPTION...   runs /run-tests in a virtual machine; ends with its exit status
boot() {
  local root=$1 keep=$2 try code
  shift 2
  (cd "$root" && find . | cpio --quiet --create --format newc) | gzip -1 > "$root.cpio.gz"
  # QEMU 7's emulation of a processor crashes newer kernels now and then, less often without CMPXCHG16B.
  for try in first second; do
    : > "$root.out"
    timeout --kill-after 5 "${VM_SECONDS:-240}" qemu-system-x86_64 -accel tcg -cpu qemu64,-cx16 -m 1024 -smp 1 -display none -no-reboot \
      -nic none -kernel "$kernel"/boot/vmlinuz-* -initrd "$root.cpio.gz" -append "console=ttyS0 quiet panic=-1" \
      -serial stdio -serial "file:$root.out" "$@" < /dev/null | tr -d '\r' | tee "$root.log" || true
    code=$(sed -n 's/.*virtual machine: exit status //p' "$root.log" | tail -n 1)
    [ -z "$code" ] || break
    echo "the $try virtual machine said no exit status (crashed, or more than ${VM_SECONDS:-240} s)" >&2
  done
  if [ -n "$keep" ]; then mkdir -p "$keep" && tar -xzf "$root.out" -C "$keep"; fi
  exit "${code:-1}"
}
