// Which thing each pixel shows: every standing or moving thing of a world has a number, from its first frame
// to its last, houses, trees, lamps and posters as well as what has an instance number.
#pragma once

#include <string>
#include <vector>

#include "slam/world/ray_caster.h"

namespace penumbra::slam::synthetic {

class ThingNumbers {
 public:
  // Counts from 1 in the order of the world's objects; objects of one instance share a number. Beyond
  // 65535 things the rest have none.
  explicit ThingNumbers(const World& world);

  // Of World::objects[object]; 0 for what is none: ground, sky, walls.
  std::uint16_t of(std::int32_t object) const {
    return object < 0 ? std::uint16_t{0} : numbers_[static_cast<std::size_t>(object)];
  }
  // {"1": {"class": "facade", "moves": false}, ...}
  const std::string& list() const { return list_; }

 private:
  std::vector<std::uint16_t> numbers_;
  std::string list_;
};

// The number that each pixel shows. `view` must have its objects.
WordImage landmark_image(const ThingNumbers& things, const RenderedView& view);

}  // namespace penumbra::slam::synthetic
