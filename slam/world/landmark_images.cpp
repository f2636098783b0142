#include "slam/world/landmark_images.h"

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

namespace penumbra::slam::synthetic {

ThingNumbers::ThingNumbers(const World& world) {
  nlohmann::ordered_json list = nlohmann::ordered_json::object();
  std::map<std::uint16_t, std::uint16_t> of_instance;
  std::uint16_t last = 0;
  for (const Object& object : world.objects) {
    const Thing thing = thing_of(object);
    const auto known = object.instance == 0 ? of_instance.end() : of_instance.find(object.instance);
    if (known != of_instance.end()) {
      numbers_.push_back(known->second);
      continue;
    }
    if (thing == Thing::nothing || last == std::numeric_limits<std::uint16_t>::max()) {
      numbers_.push_back(0);
      continue;
    }
    numbers_.push_back(++last);
    if (object.instance != 0) of_instance[object.instance] = last;
    list[std::to_string(last)] = {{"class", name_of(thing)}, {"moves", object.motion.moves}};
  }
  list_ = list.dump(1) + "\n";
}

WordImage landmark_image(const ThingNumbers& things, const RenderedView& view) {
  WordImage image(view.object.width(), view.object.height());
  std::transform(view.object.data(), view.object.data() + view.object.elements(), image.data(),
                 [&](std::int32_t object) { return things.of(object); });
  return image;
}

}  // namespace penumbra::slam::synthetic
