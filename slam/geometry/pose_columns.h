// Where the parts of a pose stand in a table whose columns have names.
//
// Names are those that data sets and tools use, in any case, quoted or not, with or without units:
//
//   time        t, time, timestamp, stamp, ts, with units "[ns]", "(s)", "_ns"; sec and nsec together; where
//               there is none: frame, index, id, seq
//   position    x, tx, px, pos_x, x_pos, position.x, translation.x, p_RS_R_x
//   quaternion  qx, q_x, q_RS_x, quat_x, orientation.x, rotation.x; rx where there is an rw
//
// All other columns are left out.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slam/geometry/time_unit.h"

namespace penumbra::slam {

struct PoseColumns {
  std::optional<std::size_t> time;         // none: the lines are the frames
  std::optional<std::size_t> nanoseconds;  // beside whole seconds in `time`
  std::optional<TimeUnit> unit;            // of the time, where its name says it
  bool time_is_index = false;              // no time, but a number of frames
  std::array<std::size_t, 3> position;     // x y z
  std::array<std::size_t, 4> quaternion;   // x y z w
  std::vector<std::string> names;          // of all columns
  // The first column behind those that are needed.
  std::size_t end() const;
  // The names of what is left out and no part of EuRoC's format, where velocities and biases are expected.
  std::vector<std::string> left_out() const;
};

// The names between separators (commas or semicolons, else blanks). Marks of comments, quotes and a text
// before a colon are left out.
std::vector<std::string> column_names(std::string_view header);

// None where the names are not those of a pose; in a comment, which may be prose, most parts must be named.
// Throws InputError naming `place` and the column: a part that is missing or named twice, angles (roll,
// pitch, yaw) where a quaternion should be.
std::optional<PoseColumns> find_pose_columns(const std::vector<std::string>& names, bool is_comment,
                                             const std::string& place);

// Whether a quaternion's w comes before its x; also where the names give no whole pose.
std::optional<bool> is_w_first(const std::vector<std::string>& names);

}  // namespace penumbra::slam
