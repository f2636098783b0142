// Text files with one pose a line, as tables of numbers: what all formats of trajectories have in common.
//
// Numbers are separated by blanks, commas or semicolons. Lines that start with '#' are comments, and so is a
// first line of names. A comment or such a line that names the columns says whether a quaternion's w comes
// before its x.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "slam/geometry/time_unit.h"

namespace penumbra::slam {

struct PoseLine {
  int line = 0;                // 1-based
  FileTime first;              // the first number with all its digits: a time, in some formats
  std::vector<double> values;  // all numbers, the first one included
};

struct PoseTable {
  std::string path;
  std::vector<PoseLine> lines;  // at least one
  bool has_commas = false;
  std::optional<bool> w_first;                    // what the names of the columns say
  std::string place(const PoseLine& line) const;  // "file:line"
};

// Throws InputError (file:line) for a word that is no finite number, and where there is no line.
PoseTable read_pose_table(const std::filesystem::path& path);

}  // namespace penumbra::slam
