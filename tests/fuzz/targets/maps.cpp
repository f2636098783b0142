// The reader of saved maps.
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

bool read(const std::string& bytes) {
  const MemoryFile file(bytes);
  return is_read([&] { require_sound(*slam::read_map(file.path())); });
}

}  // namespace

bool read_map_file(std::string_view bytes) {
  const bool is_whole = read(std::string(bytes));
  read(repair_map(bytes));  // the fuzzer's way past the checksum; what a test gives must be right by itself
  return is_whole;
}

}  // namespace penumbra::fuzz
