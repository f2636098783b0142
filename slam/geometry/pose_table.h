// Text files with one pose a line, as tables of numbers: what all formats of trajectories have in common.
//
// Numbers are separated by blanks, commas or semicolons, and may be quoted. Commas between digits are decimal
// commas where semicolons or blanks separate. Lines that start with '#', '%' or "//" are comments, and so are
// a first line of names and what follows a '#'. Where such a line before the poses names the columns
// (slam/geometry/pose_columns.h), they are put into TUM's order and the others are left out; a line that only
// names a quaternion says whether its w comes first.
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
  std::vector<PoseLine> lines;   // at least one
  bool has_commas = false;       // or semicolons
  bool is_named = false;         // the columns have names: the values are [t] x y z qx qy qz qw
  std::optional<bool> w_first;   // of the quaternions in the file, as names say
  std::optional<TimeUnit> unit;  // of the times, as the names say
  std::vector<std::string> notes;
  std::string place(const PoseLine& line) const;  // "file:line"
};

// Throws InputError (file:line) for a word that is no finite number, names that are not those of a pose,
// lines that do not have as many fields as names, and where there is no line.
PoseTable read_pose_table(const std::filesystem::path& path);

}  // namespace penumbra::slam
