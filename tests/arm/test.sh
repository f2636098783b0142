#!/usr/bin/env bash
# Tests a build for 64-bit ARM on qemu's emulation of three processors: one that has all instructions, one that has
# dot products of bytes, one that has nothing but NEON.
#   test.sh PENUMBRA FOLDER      PENUMBRA: the program for this machine, with which results are compared;
#                                FOLDER: the build for ARM, with its sysroot
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
native=$(realpath "$1") build=$(realpath "$2")
weights=$here/../../weights_tools/models/penumbra-tiny.safetensors
export QEMU_LD_PREFIX=$build/sysroot
export PENUMBRA_DATA=/nonexistent  # photographs and trained networks take hours here
work=$build/arm-test
rm -rf "$work" && mkdir -p "$work"
fail() { echo "tests/arm: $*" >&2; exit 1; }
say() { printf '\n== %s\n' "$*" >&2; }
on() { local cpu=$1; shift; qemu-aarch64 -cpu "$cpu" "$@"; }

# Left out, for whole networks on whole images, which take minutes each.
left_out='MaskRcnn.*:Allocations.*:Afnet.Repeats*:Yolov5.Repeats*'
# What multiplies: the tests of kernels and of the layers that are made of them.
layers='*Conv*:*Linear*:*LowPrecision*:*PackedWeights*:*Activations*:Isa/*Test*:Isa/*Differences*:Isa/DiscMoments*:RoiAlign*:*Attention*:Onnx*'

say "Which instruction set each processor gets"
for pair in max:neon-bf16 cortex-a76:neon-dot cortex-a72:neon; do
  on "${pair%:*}" "$build/penumbra" info --cpu --json >"$work/cpu.json"
  grep -q "\"isa\": \"${pair#*:}\"" "$work/cpu.json" || fail "${pair%:*}: expected ${pair#*:}, found $(cat "$work/cpu.json")"
  echo "${pair%:*}: ${pair#*:}"
done

# gtest_on CPU PROGRAM FILTER: in as many parts as there are processors here.
gtest_on() {
  local parts part failed=0
  local -a running=()
  parts=$(nproc)
  for ((part = 0; part < parts; ++part)); do
    GTEST_TOTAL_SHARDS=$parts GTEST_SHARD_INDEX=$part on "$1" "$build/$2" --gtest_brief=1 --gtest_filter="$3" &
    running+=($!)
  done
  for part in "${running[@]}"; do wait "$part" || failed=1; done
  ((failed == 0)) || fail "$2 on $1"
}
say "Tests of nn, images and weights_tools: all instructions"
gtest_on max test_nn "*-$left_out"
gtest_on max test_codecs "ImageFile*:PngRows*:*Pixels*"
gtest_on max test_weights_tools "*"
say "Tests of the layers: dot products; NEON alone"
gtest_on cortex-a76 test_nn "$layers-$left_out"
gtest_on cortex-a72 test_nn "$layers-$left_out"

say "Detections beside those of this machine"
"$native" synth --out "$work/street" --path block --frames 60 --size 310x94 --colour >/dev/null
# detect NAME OPTIONS PROGRAM...
detect() {
  local name=$1 options=$2
  shift 2
  # shellcheck disable=SC2086
  "$@" segment "$work/street/sequences/00/image_2/000006.png" --weights "$weights" --json --show-above 0.3 \
    --out "$work/found" $options >"$work/$name.json"
}
# same NAME PIXELS SCORE
same() { python3 "$here/same_detections.py" "$work/native.json" "$work/$1.json" "$2" "$3"; }
detect native "" "$native"
detect baseline "--isa baseline" on max "$build/penumbra"
detect neon "" on cortex-a72 "$build/penumbra"
detect bf16 "--precision bf16" on max "$build/penumbra"
# As between this program and torchvision.
same baseline 0.02 2e-4
same neon 0.02 2e-4
same bf16 1 0.03

say "A drive on two processors, twice each, beside this machine's"
# drive NAME PROGRAM...
drive() { local name=$1; shift; "$@" slam "$work/street" --deterministic --out "$work/$name" >/dev/null 2>"$work/$name.log"; }
# far NAME OTHER_PATH: the root mean square of their distances in metres.
far() {
  "$native" eval --groundtruth "$2" --estimate "$work/$1/trajectory_kitti.txt" --align none --json |
    python3 -c 'import json, sys; print(json.load(sys.stdin)["ape_m"]["rmse"])'
}
drive native "$native"
echo "native: $(far native "$work/street/poses/00.txt") m from the truth"
for cpu in max cortex-a72; do
  for time in first second; do drive "$cpu-$time" on "$cpu" "$build/penumbra"; done
  for file in trajectory_kitti.txt trajectory_tum.txt keyframes_tum.txt map.ply; do
    cmp "$work/$cpu-first/$file" "$work/$cpu-second/$file" || fail "$cpu: two runs, two $file"
  done
  apart=$(far "$cpu-first" "$work/native/trajectory_kitti.txt")
  echo "$cpu: $(far "$cpu-first" "$work/street/poses/00.txt") m from the truth, $apart m from this machine's path"
  python3 -c "import sys; sys.exit(not $apart < 0.01)" || fail "$cpu: another path than this machine's"
done
say "All is well"
