#include "apps/network/segment_report.h"

#include <fmt/format.h>

#include <iterator>

#include "nn/base/counted.h"

namespace penumbra::apps {

std::string image_text(const SegmentedImage& image, const std::vector<std::string>& names, float show_above) {
  std::string text =
      fmt::format("{}: {} x {}, {} in {:.2f} s", image.path.string(), image.size.width, image.size.height,
                  counted(image.detections.size(), "instance"), image.seconds);
  if (image.picture) text += " -> " + image.picture->string();
  text += "\n";
  for (const nn::Detection& detection : image.detections) {
    if (detection.score < show_above) continue;
    const nn::Box& box = detection.box;
    fmt::format_to(std::back_inserter(text), "  {:<16} {:.3f}  ({:.1f}, {:.1f}) - ({:.1f}, {:.1f})\n",
                   names[static_cast<std::size_t>(detection.label)], detection.score, box.x1, box.y1, box.x2,
                   box.y2);
  }
  return text;
}

nlohmann::ordered_json image_json(const SegmentedImage& image, const std::vector<std::string>& names,
                                  std::optional<float> show_above) {
  nlohmann::ordered_json json = {{"path", image.path.string()},
                                 {"width", image.size.width},
                                 {"height", image.size.height},
                                 {"instances", image.detections.size()},
                                 {"seconds", image.seconds}};
  if (image.picture) json["picture"] = image.picture->string();
  if (!show_above) return json;
  json["shown"] = nlohmann::ordered_json::array();
  for (const nn::Detection& detection : image.detections) {
    if (detection.score < *show_above) continue;
    const nn::Box& box = detection.box;
    json["shown"].push_back({{"class", names[static_cast<std::size_t>(detection.label)]},
                             {"label", detection.label},
                             {"score", detection.score},
                             {"box", {box.x1, box.y1, box.x2, box.y2}}});
  }
  return json;
}

}  // namespace penumbra::apps
