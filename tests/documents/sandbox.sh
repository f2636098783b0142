# Makes what the examples of the docs and of `--help` speak of, small, in the present folder: bash sandbox.sh PENUMBRA SOURCE.
# Weights are those of the small network that comes along, under the names of the examples; classifiers are those of
# resnet18.safetensors, which must be there, for as many classes as imagenet_classes.txt has lines.
set -eu
penumbra=$1 source=$2
synth() { "$penumbra" synth --size 310x94 --overwrite "$@" 2>/dev/null >&2; }

mkdir -p build out
ln -s "$penumbra" build/penumbra
ln -s "$source/weights_tools" weights_tools

# KITTI: the first sequence has as many frames as docs/evaluation.md takes.
synth --frames 100 --out kitti
cp -rl kitti/sequences/00 kitti/sequences/06
rm kitti/sequences/06/image_?/0000[6-9]?.png
for i in 04 06 07; do cp kitti/poses/00.txt kitti/poses/$i.txt; done
ln -s kitti/poses poses
for name in monday tuesday wednesday tomorrow nightly; do
  mkdir $name
  for i in 0 1 2 3 4 5 6 7; do printf '%s\n' "0.$i"; done > $name/times.txt
  for side in 0:left 1:right; do
    mkdir $name/${side#*:}
    for i in 0 1 2 3 4 5 6 7; do cp -l kitti/sequences/00/image_${side%:*}/00000$i.png $name/${side#*:}/; done
  done
  printf 'fx: 179.8\nfy: 179.8\ncx: 151.34\ncy: 46.28\nbaseline: 0.537\n' > $name/calibration.yaml
done
cp -r monday my_camera
ln -s my_camera my_robot
for i in 0 1 2 3 4 5 6 7; do echo "0.$i 9.0 0.0"; done > wheels.txt

# EuRoC: two cameras that happen to be rectified.
for camera in 0 1; do
  folder=V1_01_easy/mav0/cam$camera
  mkdir -p $folder/data
  echo '#timestamp [ns],filename' > $folder/data.csv
  for i in 0 1 2 3 4 5 6 7; do
    cp -l kitti/sequences/00/image_$camera/00000$i.png $folder/data/140363657${i}000000000.png
    echo "140363657${i}000000000,140363657${i}000000000.png" >> $folder/data.csv
  done
  cat > $folder/sensor.yaml <<YAML
T_BS:
  cols: 4
  rows: 4
  data: [1.0, 0.0, 0.0, $camera.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
resolution: [310, 94]
intrinsics: [179.8, 179.8, 151.34, 46.28]
distortion_model: radial-tangential
distortion_coefficients: [0.0, 0.0, 0.0, 0.0]
YAML
done
sed -i 's/1.0, 0.0, 0.0, 1.0,/1.0, 0.0, 0.0, 0.537,/' V1_01_easy/mav0/cam1/sensor.yaml
mkdir V1_01_easy/mav0/state_groundtruth_estimate0
for i in 0 1 2 3 4 5 6 7; do
  awk -v i=$i 'NR == i + 1 { printf "140363657%d000000000,%s,%s,%s,1,0,0,0\n", i, $4, $8, $12 }' kitti/poses/00.txt
done > V1_01_easy/mav0/state_groundtruth_estimate0/data.csv
synth --sensor rgbd --frames 8 --out rgbd_dataset_freiburg1_xyz
cp rgbd_dataset_freiburg1_xyz/groundtruth.txt groundtruth.txt

# Calibration files of other tools.
for i in 0 1; do
  printf 'cam%s:\n  camera_model: pinhole\n  intrinsics: [70, 70, 40, 30]\n  distortion_model: radtan\n' $i
  printf '  distortion_coeffs: [0.01, 0, 0, 0]\n  resolution: [80, 60]\n'
done > camchain.yaml
echo '  T_cn_cnm1: [1, 0, 0, -0.1, 0, 1, 0, 0, 0, 0, 1, 0]' >> camchain.yaml
for side in left:0 right:-7; do
  printf 'image_width: 80\nimage_height: 60\ncamera_matrix:\n  data: [70, 0, 40, 0, 70, 30, 0, 0, 1]\ndistortion_model: plumb_bob\n'
  printf 'distortion_coefficients:\n  data: [0.01, 0, 0, 0, 0]\nrectification_matrix:\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n'
  printf 'projection_matrix:\n  data: [70, 0, 40, %s, 0, 70, 30, 0, 0, 0, 1, 0]\n' ${side#*:}
done | csplit -sz -f camera_info - '/^image_width/' '{*}'
mv camera_info00 left.yaml
mv camera_info01 right.yaml
for i in 1 2; do
  printf 'K%s: [70, 0, 40, 0, 70, 30, 0, 0, 1]\nD%s: [0.01, 0, 0, 0, 0]\n' $i $i
done > stereo.yml
printf 'R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [-0.1, 0, 0]\n' >> stereo.yml

synth --frames 8 --annotations --out out/street
ln -s street out/06
synth --scene office --frames 6 --annotations --out out/walking_xyz
synth --frames 2 --annotations --out street
cp street/annotations/instances.json instances_val2017.json
ln -s street val2017
cp -l street/sequences/00/image_0/*.png street/
mkdir -p DATA/tum DATA/euroc DATA/coco
cp -rl kitti DATA/kitti
cp -rl rgbd_dataset_freiburg1_xyz DATA/tum/
cp -rl V1_01_easy DATA/euroc/V1_01_easy_sparse
ln -s ../../street DATA/coco/images
cp instances_val2017.json DATA/coco/instances_val2017_80.json

# Maps of one camera.
"$penumbra" slam monday --save-map monday.map --out out/monday >/dev/null 2>&1
"$penumbra" slam tuesday --frames 1: --save-map tuesday.map --out out/tuesday >/dev/null 2>&1
mkdir night
cp monday.map night/a.map
cp tuesday.map night/b.map
printf 'a ../monday -\nb ../tuesday - --frames 0:3\n' > night/manifest.txt
"$penumbra" fleet plan night/manifest.txt --out out/night --program "$penumbra" >/dev/null
out/night/here.sh >/dev/null 2>&1

# A run, its pictures as photographs, and results under the names that other examples write.
"$penumbra" slam kitti --sequence 00 --save-map out/00.map --out out/00 >/dev/null 2>&1
cp out/00/trajectory_*.txt out/
cp out/trajectory_kitti.txt a.txt
cp out/trajectory_tum.txt .
mkdir photos
cp out/00/gallery/00000*.jpg photos/
cp photos/000000.jpg street/
cp photos/000000.jpg photo.jpg
cp photos/000000.jpg bird.jpg
cp kitti/sequences/00/image_0/000000.png street.png
cp street.png photo.png
mkdir -p out/block out/baseline out/mine
cp -rl kitti/. out/block/
rm -r out/block/sequences/06 out/block/poses
mkdir out/block/poses
cp kitti/poses/00.txt out/block/poses/
cp -r out/block out/shifted
small="$source/weights_tools/models/penumbra-tiny.safetensors"
for name in maskrcnn.safetensors maskrcnn_resnet50_fpn_coco.pth maskrcnn_resnet50_fpn.pth maskrcnn_r50fpn.pth maskrcnn.pth w.safetensors yolov5s.pt \
    mam.safetensors fpn.safetensors yolov5n-seg.pt yolov5n-seg.pth yolov5n-seg.safetensors yolov5n.safetensors out/baseline/weights.safetensors out/mine/weights.safetensors; do
  cp "$small" $name
done
cp resnet18.safetensors resnet50.pth
printf '{ "tracker": { "search_radius": 12, "mismatch_filter": { "mode": "compensated" } } }' > mine.json
"$penumbra" segment --coco-images val2017 --annotations instances_val2017.json --weights w.safetensors --out found >/dev/null 2>&1
cp found/results.json boxes.json
cp -r out out.fresh  # every document begins with this one
