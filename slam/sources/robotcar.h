// Oxford RobotCar as it is downloaded: raw images of a Bumblebee XB3, whose lenses the tables of its SDK
// undo.
//
//   DRIVE/stereo/left, right      MICROSECONDS.png, a mosaic of bayer filters (GBRG); the wide pair, 24 cm
//   DRIVE/stereo/centre, right    where left/ is missing: the narrow pair, 12 cm
//   DRIVE/stereo.timestamps       "MICROSECONDS CHUNK" of all frames: where truth is interpolated
//   models/                       of the SDK, in DRIVE, beside it, or in robotcar-dataset-sdk/ there:
//     stereo_wide_left.txt        fx fy cx cy 0, then T_camera_image, 4 x 4, of x ahead, y right, z down
//     stereo_wide_left_distortion_lut.bin    doubles: columns of all pixels, row by row, then rows:
//                                            out(u, v) = in(column(u, v), row(u, v))
//   extrinsics/                   beside models/: stereo.txt, x y z roll pitch yaw of T_camera_vehicle, and
//                                 ins.txt of T_vehicle_ins
//   rtk.csv, gps/ins.csv          truth: timestamp, northing, easting, down, roll, pitch, yaw of its columns
//   vo/vo.csv                     or its own odometry: source_timestamp destination_timestamp x y z roll
//                                 pitch yaw of T_destination_source
//
//   R = Rz(yaw) Ry(pitch) Rx(roll)
//   T_w_image = T_w_ins (T_camera_vehicle T_vehicle_ins)^-1 T_camera_image;   vo: the vehicle in place of ins
//
// Source: Maddern et al., 1 Year, 1000km: The Oxford RobotCar Dataset (IJRR 2017), and its SDK.
#pragma once

#include <filesystem>

#include "slam/sources/paired_folders.h"

namespace penumbra::slam {

bool is_robotcar(const std::filesystem::path& path);

// Throws InputError naming the file and what is wrong with it; where the SDK's models are missing, where they
// are looked for and whence they come.
PairedFolders describe_robotcar(const std::filesystem::path& path);

}  // namespace penumbra::slam
