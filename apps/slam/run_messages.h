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
// left camera's, "world" is "map" with z up, as viewers have it.
struct MessageType {
  const char* name;
  std::string definition;
};
extern const MessageType kPoseStamped, kPath, kPointCloud2, kTransforms, kCompressedImage, kOccupancyGrid;

std::string pose_message(std::int64_t time, const slam::SE3& T_map_camera);
std::string path_message(std::int64_t time, const slam::Trajectory& poses);
std::string cloud_message(std::int64_t time, const std::vector<slam::PlyVertex>& points);
// Where the camera is, and how the map lies in the world.
std::string camera_transform_message(std::int64_t time, const slam::SE3& T_map_camera);
std::string world_transform_message(std::int64_t time);

// A JPEG of what the camera saw.
std::string jpeg_message(std::int64_t time, std::string_view jpeg);
// A plan of the floor in its own frame, "plan", and where that lies on the map: plan.T_plan_world.
std::string plan_message(std::int64_t time, const slam::OccupancyGrid& plan);
std::string plan_transform_message(std::int64_t time, const slam::OccupancyGrid& plan);

std::int64_t nanoseconds_of(double seconds);

}  // namespace penumbra::apps
