// Wheel odometry from a file: a line a sample, `time v omega`, with spaces, tabs or commas between.
//
//   time    seconds, or nanoseconds as EuRoC has them (told by their size), of the same clock as the images
//   v       metres a second, forward
//   omega   radians a second, to the left
//
// Lines that start with '#' are comments, as in TUM's and EuRoC's files. A sample holds until the next one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "slam/brain/motion/self_motion.h"

namespace penumbra::slam::brain {

struct OdometrySample {
  double time = 0.0;  // seconds
  double speed = 0.0, turn_rate = 0.0;
};

// Throws InputError naming file and line: another number of columns, something not a finite number, a time
// that does not increase, speeds of nothing on earth, fewer than two samples.
std::vector<OdometrySample> read_odometry(const std::filesystem::path& path);

struct OdometryOfFrames {
  std::vector<std::vector<SelfMotion>> motions;  // per frame: the samples since the frame before
  std::vector<std::string> notes;                // gaps, degrees taken for radians, frames that it misses
};

// `times`: of the frames, increasing. Throws InputError naming `place` where the samples overlap with none of
// the frames. Frames before the first or after the last sample keep the nearest one's speed for at most
// kLongestGap seconds, then stand still: a note says how many. The same within gaps.
inline constexpr double kLongestGap = 1.0;
OdometryOfFrames odometry_of_frames(const std::vector<OdometrySample>& samples,
                                    const std::vector<double>& times, const std::string& place);

}  // namespace penumbra::slam::brain
