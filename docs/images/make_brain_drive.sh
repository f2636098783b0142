#!/bin/sh
# Draws brain-drive.png, brain-map.svg, brain-error.svg and brain-places.png: what `penumbra brain` makes of rough odometry.
#
#     docs/images/make_brain_drive.sh KITTI FOLDER
#
# KITTI: the odometry data, of which the poses of 00 and 06 are taken. FOLDER: for the drives and runs, some 4 GB. Needs
# build/penumbra and chromium-headless-shell; run it from the top of the source tree.
set -eu
kitti=$1 folder=$2 images=docs/images
for drive in 00 06; do
  [ -e "$folder/$drive" ] ||
    build/penumbra synth --path "$kitti/poses/$drive.txt" --size 620x188 --colour --seed 900 --out "$folder/$drive"
  build/penumbra brain "$folder/$drive" --noise rough --seed 900 --out "$folder/run-$drive"
done
cp "$folder/run-06/cognitive_map.svg" $images/brain-map.svg
cp "$folder/run-06/error.svg" $images/brain-error.svg
cp "$folder/run-06/places.png" $images/brain-places.png
cat > "$folder/drive.html" <<HTML
<body style="margin:0;background:white"><img src="run-00/believed.svg" width="560"><img src="run-00/trajectory.svg" width="560"></body>
HTML
chromium-headless-shell --no-sandbox --window-size=1120,500 --screenshot=$images/brain-drive.png "file://$(realpath "$folder")/drive.html"
