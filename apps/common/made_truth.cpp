#include "apps/common/made_truth.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/image/image_file.h"
#include "slam/sources/calibration/calibration.h"
#include "slam/sources/folder_listing.h"

namespace penumbra::apps {

std::map<int, MadeInstance> read_instance_list(const std::filesystem::path& path) {
  const std::string text = nn::read_text_file(path, "the classes of the instances");
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  const std::string expected = R"(an object of {"NUMBER": {"class": NAME}})";
  if (!json.is_object()) throw InputError(path.string(), expected, "something else, or a torn file");
  std::map<int, MadeInstance> instances;
  for (const auto& [key, value] : json.items()) {
    const bool is_number = !key.empty() && key.size() <= 5 && key.find_first_not_of("0123456789") == key.npos;
    if (!is_number || !value.is_object() || !value.contains("class") || !value["class"].is_string())
      throw InputError(fmt::format("{}, \"{}\"", path.string(), key), expected, "something else");
    const nlohmann::json moving = value.value("moving", nlohmann::json(false));
    instances[std::stoi(key)] = {value["class"].get<std::string>(),
                                 moving.is_boolean() && moving.get<bool>()};
  }
  return instances;
}

TrueDepths::TrueDepths(const std::filesystem::path& recording, const std::filesystem::path& images)
    : levels_a_metre_(slam::read_camera_file(recording / "calibration.yaml").depth_factor) {
  std::vector<std::string> notes;
  files_ = slam::list_images(images, notes);
}

FloatImage TrueDepths::load(int frame, const Size& size) const {
  const WordImage levels = nn::read_depth_image(file(frame), "the true depth, a 16-bit grey PNG");
  if (levels.size() != size) {
    throw InputError(file(frame).string(), fmt::format("{}x{} pixels", size.width, size.height),
                     fmt::format("{}x{}", levels.width(), levels.height()));
  }
  FloatImage metres(size.width, size.height);
  std::transform(levels.data(), levels.data() + levels.elements(), metres.data(),
                 [&](std::uint16_t level) { return static_cast<float>(level / levels_a_metre_); });
  return metres;
}

}  // namespace penumbra::apps
