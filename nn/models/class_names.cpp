#include "nn/models/class_names.h"

#include <array>
#include <string_view>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/text.h"
#include "nn/models/coco_categories.h"

namespace penumbra::nn {

namespace {

// COCO's category numbers have gaps, 91 in all with the background; torchvision's models keep the gaps.
constexpr std::array<const char*, 91> kCoco{
    "background",  "person",        "bicycle",       "car",          "motorcycle",     "airplane",
    "bus",         "train",         "truck",         "boat",         "traffic light",  "fire hydrant",
    "street sign", "stop sign",     "parking meter", "bench",        "bird",           "cat",
    "dog",         "horse",         "sheep",         "cow",          "elephant",       "bear",
    "zebra",       "giraffe",       "hat",           "backpack",     "umbrella",       "shoe",
    "eye glasses", "handbag",       "tie",           "suitcase",     "frisbee",        "skis",
    "snowboard",   "sports ball",   "kite",          "baseball bat", "baseball glove", "skateboard",
    "surfboard",   "tennis racket", "bottle",        "plate",        "wine glass",     "cup",
    "fork",        "knife",         "spoon",         "bowl",         "banana",         "apple",
    "sandwich",    "orange",        "broccoli",      "carrot",       "hot dog",        "pizza",
    "donut",       "cake",          "chair",         "couch",        "potted plant",   "bed",
    "mirror",      "dining table",  "window",        "desk",         "toilet",         "door",
    "tv",          "laptop",        "mouse",         "remote",       "keyboard",       "cell phone",
    "microwave",   "oven",          "toaster",       "sink",         "refrigerator",   "blender",
    "book",        "clock",         "vase",          "scissors",     "teddy bear",     "hair drier",
    "toothbrush"};

std::vector<std::string> split(std::string_view text, std::string_view separators) {
  std::vector<std::string> names;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(separators), text.size());
    std::string_view name = text.substr(0, end);
    while (!name.empty() && (name.back() == '\r' || name.back() == ' ')) name.remove_suffix(1);
    while (!name.empty() && name.front() == ' ') name.remove_prefix(1);
    if (!name.empty()) names.emplace_back(name);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return names;
}

// The list of the file or of the weights' metadata and its place for messages; no names where there is none.
struct NameList {
  std::vector<std::string> names;
  std::string place;
};

NameList listed_names(const StateDict& weights, const std::filesystem::path& file) {
  NameList list;
  const auto listed = weights.metadata.find("classes");
  if (!file.empty()) {
    list = {split(read_text_file(file, "a list of class names"), "\n"), file.string()};
  } else if (listed != weights.metadata.end()) {
    const bool has_lines = listed->second.find('\n') != std::string::npos;  // then names may hold commas
    list = {split(listed->second, has_lines ? "\n" : ","), weights.source + ", metadata classes"};
  }
  for (const std::string& name : list.names) {
    const std::string shown = printable(name);
    if (shown == name) continue;
    throw InputError(list.place, "class names of at most 120 bytes in plain UTF-8", "'" + shown + "'");
  }
  return list;
}

bool is_background(const std::string& name) {
  return name == "background" || name == "__background__" || name == "_background_" || name == "BG";
}

std::vector<std::string> checked(std::vector<std::string> names, int classes, const std::string& place,
                                 bool has_background) {
  const int count = static_cast<int>(names.size());
  const bool is_coco = classes == static_cast<int>(kCoco.size());
  // With one name more than outputs, one of a network without a background is not known to be it by counting.
  const bool fits = count == classes - 1 || (is_coco && count == kCocoClasses) ||
                    (count == classes && (has_background || is_background(names.front())));
  if (!fits) {
    const int outputs = is_coco ? kCocoClasses : classes - 1;
    throw InputError(place,
                     has_background ? fmt::format("{} (or {} without the background)",
                                                  counted(classes, "class name"), classes - 1)
                                    : counted(outputs, "class name"),
                     fmt::format("{}", count));
  }
  if (is_coco && count == kCocoClasses) {
    std::vector<std::string> spread(kCoco.size(), "unused");
    spread[0] = "background";
    for (int c = 0; c < count; ++c) {
      spread[static_cast<std::size_t>(category_of_class(c, kCocoClasses))] =
          names[static_cast<std::size_t>(c)];
    }
    return spread;
  }
  if (count == classes - 1) names.insert(names.begin(), "background");
  return names;
}

}  // namespace

std::vector<std::string> class_names(const StateDict& weights, int classes, const std::filesystem::path& file,
                                     bool has_background) {
  NameList list = listed_names(weights, file);
  if (!list.place.empty()) return checked(std::move(list.names), classes, list.place, has_background);
  if (classes == static_cast<int>(kCoco.size())) return {kCoco.begin(), kCoco.end()};
  std::vector<std::string> names{"background"};
  for (int c = 1; c < classes; ++c) names.push_back(fmt::format("class {}", c));
  return names;
}

std::vector<std::string> output_names(const StateDict& weights, int outputs,
                                      const std::filesystem::path& file) {
  NameList list = listed_names(weights, file);
  if (!list.place.empty()) {
    if (static_cast<int>(list.names.size()) == outputs) return std::move(list.names);
    throw InputError(list.place, counted(outputs, "class name"), fmt::format("{}", list.names.size()));
  }
  std::vector<std::string> names;
  for (int c = 0; c < outputs; ++c) names.push_back(fmt::format("class {}", c));
  return names;
}

}  // namespace penumbra::nn
