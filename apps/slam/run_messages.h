// A run's results as messages of ROS 2, in CDR, with the definitions that viewers need.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slam/geometry/trajectory.h"
#include "slam/map/dense/occupancy_grid.h"
#include "slam/map/ply.h"

namespace penumbra::apps {

// Frames of reference: "map" is the run's own (x right, y down, z forward of the first camera), "camera" the
// left camera's. "world" is "map" with z up, as viewers have it; of a run with --body, the body's frame where
// the map began, and the body hangs between map and camera.
struct MessageType {
  const char* name;
  std::string definition;
};
extern const MessageType kPoseStamped, kPath, kPointCloud2, kTransforms, kCompressedImage, kOccupancyGrid;

// In `frame`, "map" or "world".
std::string pose_message(std::int64_t time, std::string_view frame, const slam::SE3& pose);
std::string path_message(std::int64_t time, std::string_view frame, const slam::Trajectory& poses);
std::string cloud_message(std::int64_t time, const std::vector<slam::PlyVertex>& points);
struct Transform {
  std::string parent, child;
  slam::SE3 T_parent_child;
};
std::string transforms_message(std::int64_t time, const std::vector<Transform>& transforms);
// T_world_map where no body says which way is up: z of the camera is ahead, -y up.
slam::SE3 z_up();

// A JPEG of what the camera saw.
std::string jpeg_message(std::int64_t time, std::string_view jpeg);
// A plan of the floor in its own frame, "plan".
std::string plan_message(std::int64_t time, const slam::OccupancyGrid& plan);

std::int64_t nanoseconds_of(double seconds);

}  // namespace penumbra::apps
