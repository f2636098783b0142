#!/usr/bin/env bash
# Installs what was built into an empty folder, builds the examples against that alone, and runs them.
#   installed_package.sh BUILD_FOLDER
set -euo pipefail
source=$(cd "$(dirname "$0")/../.." && pwd)
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "installed_package: $*" >&2; exit 1; }

cmake --install "$build" --prefix "$work/usr" >"$work/install.log" || { cat "$work/install.log" >&2; exit 1; }
for file in bin/penumbra include/penumbra/slam.h share/penumbra/penumbra-tiny.safetensors share/man/man1/penumbra.1 \
  share/bash-completion/completions/penumbra; do
  [[ -s $work/usr/$file ]] || fail "$file was not installed"
done
library=$(find "$work/usr" -name 'libpenumbra.so' | head -n 1)
[[ -n $library ]] || fail "libpenumbra.so was not installed"

# What the library shows is its own, and of that only what the headers name: a program may have another fmt.
shown=$(nm -DC --defined-only "$library" | sed -E 's/^[0-9a-f]+ . //' | grep -vE '^(typeinfo|vtable|std::)')
strange=$(grep -vE '^penumbra::(Slam|Rig|Segmenter|version|evaluate|read_)' <<<"$shown" || true)
[[ -z $strange ]] || fail "the library shows more than its headers: $(head -n 5 <<<"$strange")"

cmake -S "$source/apps/examples" -B "$work/examples" -DCMAKE_PREFIX_PATH="$work/usr" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_CXX_FLAGS="-Wall -Wextra -Wpedantic -Werror" >"$work/configure.log" 2>&1 ||
  { cat "$work/configure.log" >&2; exit 1; }
cmake --build "$work/examples" >"$work/build.log" 2>&1 || { cat "$work/build.log" >&2; exit 1; }
export PKG_CONFIG_PATH=$(dirname "$library")/pkgconfig
if command -v pkg-config >/dev/null; then
  pkg-config --exists --print-errors penumbra || fail "pkg-config does not know it"
fi

"$work/usr/bin/penumbra" synth --frames 12 --size 640x188 --out "$work/street" >/dev/null
drive=$work/street/sequences/00
read -r fx cx fy cy bf < <(awk '$1 == "P0:" {fx = $2; cx = $4; fy = $7; cy = $8} $1 == "P1:" {bf = -$5}
                               END {print fx, cx, fy, cy, bf / fx}' "$drive/calib.txt")
cat >"$work/calibration.yaml" <<YAML
sensor: stereo
fx: $fx
fy: $fy
cx: $cx
cy: $cy
baseline: $bf
width: 640
height: 188
YAML
LD_LIBRARY_PATH=$(dirname "$library") "$work/examples/embed_stereo" "$work/calibration.yaml" "$drive/image_0" \
  "$drive/image_1" >"$work/poses.txt"
(($(grep -c '^0000' "$work/poses.txt") == 12)) || { cat "$work/poses.txt" >&2; fail "expected 12 poses"; }
LD_LIBRARY_PATH=$(dirname "$library") "$work/examples/detect" "$work/usr/share/penumbra/penumbra-tiny.safetensors" \
  "$source/docs/images/street-presets.jpg" >"$work/things.txt"
grep -q 'car' "$work/things.txt" || { cat "$work/things.txt" >&2; fail "expected a car"; }
echo "installed, built against and run: $(wc -l <<<"$shown") functions shown"
