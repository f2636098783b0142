// The readers of saved maps and plans, and of the odometry that a cognitive map is made with.
#include <cmath>

#include "slam/brain/map/map_file.h"
#include "slam/brain/motion/odometry_file.h"
#include "slam/map/dense/plan_file.h"
#include "slam/map/map_file.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/repair.h"
#include "tests/fuzz/target.h"

namespace penumbra::fuzz {

namespace {

void require_sound(const slam::Map& map) {
  for (const slam::KeyFrame* keyframe : map.keyframes()) {
    require(keyframe->T_cw.is_finite(), "poses are finite");
    require(static_cast<int>(keyframe->points.size()) == keyframe->features->size(), "a slot a feature");
  }
  for (const auto& point : map.points()) {
    require(point->position.allFinite(), "positions are finite");
    require(!point->observations.empty(), "every point is seen");
    for (const slam::Observation& o : point->observations) {
      require(o.keyframe->points.at(static_cast<std::size_t>(o.feature)) == point.get(),
              "points and keyframes agree who sees what");
    }
  }
}

void require_sound(const slam::brain::StoredMap& stored) {
  require(stored.views.size() == stored.map.nodes().size(), "a view a node");
  for (const slam::brain::Node& node : stored.map.nodes()) require(node.pose.is_finite(), "poses are finite");
  for (const slam::brain::Link& link : stored.map.links()) {
    require(link.from != link.to && std::min(link.from, link.to) >= 0 &&
                std::max(link.from, link.to) < stored.map.size(),
            "links are between nodes");
  }
}

bool read(const std::string& bytes) {
  const MemoryFile file(bytes);
  return is_read([&] { require_sound(*slam::read_map(file.path())); });
}

bool read_cognitive(const std::string& bytes) {
  const MemoryFile file(bytes);
  return is_read([&] { require_sound(slam::brain::read_cognitive_map(file.path())); });
}

}  // namespace

bool read_map_file(std::string_view bytes) {
  const bool is_whole = read(std::string(bytes));
  read(repair_map(bytes));  // the fuzzer's way past the checksum; what a test gives must be right by itself
  return is_whole;
}

bool read_cognitive_map_file(std::string_view bytes) {
  const bool is_whole = read_cognitive(std::string(bytes));
  read_cognitive(repair_map(bytes));  // its header is that of a map file
  return is_whole;
}

bool read_odometry_file(std::string_view bytes) {
  const MemoryFile file{std::string(bytes)};
  return is_read([&] {
    double last = -HUGE_VAL;
    for (const slam::brain::OdometrySample& sample : slam::brain::read_odometry(file.path())) {
      require(sample.time > last, "times increase");
      require(std::isfinite(sample.speed) && std::isfinite(sample.turn_rate), "motion is finite");
      last = sample.time;
    }
  });
}

// Without the image that it names, which may be anywhere.
bool read_plan_file(std::string_view bytes) {
  const MemoryFile file(bytes);
  return is_read([&] {
    using slam::PlanFile;
    const PlanFile plan = slam::read_plan_file(file.path());
    require(plan.cell >= PlanFile::kLeastCell && plan.cell <= PlanFile::kMostCell, "cells have a size");
    require(plan.origin.cwiseAbs().maxCoeff() <= PlanFile::kFarthestOrigin, "origins are near");
    require(std::isfinite(plan.occupied) && std::isfinite(plan.free), "thresholds are finite");
    require(!plan.image.empty(), "images have names");
  });
}

}  // namespace penumbra::fuzz
