#!/usr/bin/env bash
# Tries what `./run package` has made where nothing of the build is seen: an empty Debian (debootstrap), in which the .deb
# is installed, used and removed, and the static program runs; qemu's emulation of ARM's processors; an empty Python
# environment for the wheel.
#   try_packages.sh FOLDER        as root, with access to Debian's packages
set -euo pipefail
source=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(cd "$1" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "try_packages: $*" >&2; exit 1; }
say() { printf '== %s\n' "$*" >&2; }

deb=$(ls "$folder"/*.deb) tarball=$(ls "$folder"/*-"$(uname -m)"-static.tar.gz)
root=$work/debian
# shellcheck source=/dev/null
. /etc/os-release
say "An empty Debian $VERSION_CODENAME"
debootstrap --variant=minbase "$VERSION_CODENAME" "$root" >"$work/debootstrap.log" 2>&1 ||
  { tail -n 5 "$work/debootstrap.log" >&2; exit 1; }
cp /etc/apt/sources.list.d/* "$root/etc/apt/sources.list.d/" 2>/dev/null || true
cp /etc/apt/apt.conf.d/*prox* "$root/etc/apt/apt.conf.d/" 2>/dev/null || true
# Nothing of the environment outside but the way to the packages: it may name compilers and launchers.
inside() {
  chroot "$root" env -i HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive PATH=/usr/sbin:/usr/bin:/sbin:/bin \
    ${http_proxy+http_proxy="$http_proxy"} ${https_proxy+https_proxy="$https_proxy"} "$@"
}

say "The static program in it"
tar -xzf "$tarball" -C "$root/root"
inside bash -c '/root/penumbra-*/penumbra --version' || fail "the static program does not run"

if [[ $(uname -m) == x86_64 ]] && arm=$(ls "$folder"/*-aarch64-static.tar.gz 2>/dev/null); then
  say "The static program for ARM, on qemu's emulation of a processor, beside this machine's"
  mkdir "$work/arm" "$work/native"
  tar -xzf "$arm" -C "$work/arm" --strip-components 1
  tar -xzf "$tarball" -C "$work/native" --strip-components 1
  "$work/native/penumbra" synth --frames 12 --size 310x94 --out "$work/street" >/dev/null
  for name in arm native; do
    program=("$work/$name/penumbra")
    [[ $name == native ]] || program=(qemu-aarch64 -cpu cortex-a76 "${program[@]}")
    "${program[@]}" --version
    "${program[@]}" slam "$work/street" --deterministic --out "$work/$name/run" >/dev/null
    "${program[@]}" eval --groundtruth "$work/street/poses/00.txt" --estimate "$work/$name/run/trajectory_kitti.txt" --json >"$work/$name/error.json"
  done
  python3 - "$work"/{arm,native}/error.json <<'PYTHON' || fail "ARM finds another path"
import json, sys
arm, native = (json.load(open(path))["ape_m"]["rmse"] for path in sys.argv[1:])
print(f"error of the path: {arm:.4f} m on ARM, {native:.4f} m here")
sys.exit(abs(arm - native) > 0.01)
PYTHON
fi

say "The .deb in it"
find "$root" -xdev -path "$root/root" -prune -o -path "$root/var" -prune -o -type f -print | sort >"$work/before"
cp "$deb" "$root/root/"
inside apt-get -q update >"$work/apt.log" 2>&1
seconds=$SECONDS
inside bash -c 'apt-get -q install -y --no-install-recommends /root/*.deb' >>"$work/apt.log" 2>&1 ||
  { tail -n 20 "$work/apt.log" >&2; fail "the .deb cannot be installed"; }
say "installed in $((SECONDS - seconds)) s: $(inside dpkg -L penumbra | wc -l) paths"
inside penumbra --version
inside penumbra synth --frames 6 --size 320x96 --out /root/street >/dev/null
inside penumbra slam /root/street --out /root/run >/dev/null
say "A program that uses the library"
inside apt-get -q install -y --no-install-recommends g++ cmake make >>"$work/apt.log" 2>&1
cp -r "$source/apps/examples" "$root/root/examples"
inside bash -c 'cmake -S /root/examples -B /root/examples/build && cmake --build /root/examples/build' >"$work/build.log" 2>&1 ||
  { tail -n 20 "$work/build.log" >&2; fail "the examples do not build"; }
inside bash -c '/root/examples/build/detect /usr/share/penumbra/penumbra-tiny.safetensors /root/street/sequences/00/image_0/000000.png'
inside dpkg --purge penumbra >>"$work/apt.log" 2>&1
left=$(find "$root/usr" -path '*enumbra*' | head -n 5)
[[ -z $left ]] || fail "after its removal there is still $left"

if wheel=$(ls "$folder"/*.whl 2>/dev/null); then
  say "The wheel in an empty Python"
  python3 -m venv "$work/venv"
  "$work/venv/bin/pip" install -q "$wheel"
  (cd "$work" && venv/bin/python -c 'import penumbra; print("penumbra for Python", penumbra.__version__)')
fi
say "All of them work"
