#include "slam/sources/bag_topics.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "slam/sources/camera_info.h"

namespace penumbra::slam {

namespace {

struct Sides {
  std::string_view left, right;
  bool is_infrared;
};
constexpr Sides kSides[] = {
    {"left", "right", false},           {"cam0", "cam1", false},
    {"camera0", "camera1", false},      {"cam_0", "cam_1", false},
    {"camera_0", "camera_1", false},    {"l", "r", false},
    {"infra1", "infra2", true},         {"ir1", "ir2", true},
    {"infrared_1", "infrared_2", true}, {"image0", "image1", false},
};

// `name` with every word `from` as `to`; empty where there is none. No letter or digit is next to a word.
std::string with_word(std::string_view name, std::string_view from, std::string_view to) {
  const std::string small = lower_case(name);
  const auto is_part = [&](std::size_t i) {
    return i < small.size() && ((small[i] >= 'a' && small[i] <= 'z') || (small[i] >= '0' && small[i] <= '9'));
  };
  std::string result;
  std::size_t taken = 0;
  for (std::size_t at = small.find(from); at != std::string::npos; at = small.find(from, at + 1)) {
    if (at < taken || (at > 0 && is_part(at - 1)) || is_part(at + from.size())) continue;
    result += small.substr(taken, at - taken);
    result += to;
    taken = at + from.size();
  }
  return result.empty() && taken == 0 ? std::string() : result + small.substr(taken);
}

// The namespace that an image and its camera info share: without the last word, and what image transports add
// behind it; of librealsense's topics without the last two.
std::string_view camera_namespace(std::string_view topic) {
  for (const std::string_view transport : {"/compressed", "/compressedDepth"}) {
    if (topic.ends_with(transport)) topic.remove_suffix(transport.size());
  }
  for (const std::string_view ending : {"/info/camera_info", "/image/data"}) {
    if (topic.ends_with(ending)) return topic.substr(0, topic.size() - ending.size());
  }
  return topic.substr(0, std::min(topic.size(), topic.rfind('/')));
}

bool has_word(std::string_view name, std::initializer_list<std::string_view> words) {
  const std::string small = lower_case(name);
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view w) { return small.find(w) != std::string::npos; });
}

class Chooser {
 public:
  Chooser(const BagIndex& index, const DatasetOptions& options, const std::string& place)
      : index_(index), options_(options), place_(place) {
    const TopicNames& names = options.topics;
    left_ = find_image(names.left);
    right_ = find_image(names.right);
    depth_ = find_image(names.depth);
    left_camera_ = find_camera(names.left_info);
    right_camera_ = find_camera(names.right_info);
  }

  std::optional<ChosenTopics> choose(std::string& reason) {
    if (right_ == nullptr) find_depth();
    if (depth_ == nullptr) find_stereo();
    reason = reason_;
    if (best_.left == nullptr) return std::nullopt;
    return best_;
  }

 private:
  template <class T>
  static const T* named(const std::vector<T>& topics, std::string_view name) {
    const auto same = [&](std::string_view a) {
      return a == name || (a.starts_with('/') && a.substr(1) == name);
    };
    const auto found = std::find_if(topics.begin(), topics.end(), [&](const T& t) { return same(t.name); });
    return found == topics.end() ? nullptr : &*found;
  }
  template <class T>
  const T* find_given(const std::vector<T>& topics, const std::string& name, const char* what) const {
    if (name.empty()) return nullptr;
    if (const T* found = named(topics, name)) return found;
    std::string there;
    for (const T& topic : topics) there += (there.empty() ? "" : ", ") + printable(topic.name, 100);
    throw InputError(place_, fmt::format("the {} topic '{}'", what, printable(name, 100)),
                     there.empty() ? std::string("none of that kind") : printable(there, 600));
  }
  const ImageTopic* find_image(const std::string& name) const {
    return find_given(index_.images, name, "image");
  }
  const CameraTopic* find_camera(const std::string& name) const {
    return find_given(index_.cameras, name, "camera info");
  }

  const CameraTopic* camera_of(const ImageTopic& image) const {
    const auto found =
        std::find_if(index_.cameras.begin(), index_.cameras.end(), [&](const CameraTopic& camera) {
          return camera_namespace(camera.name) == camera_namespace(image.name);
        });
    return found == index_.cameras.end() ? nullptr : &*found;
  }

  void find_stereo() {
    if (left_ != nullptr && right_ != nullptr) {
      offer(stereo_of(*left_, *right_), 0);
      return;
    }
    for (const ImageTopic& left : index_.images) {
      for (const Sides& sides : kSides) {
        const std::string name = with_word(left.name, sides.left, sides.right);
        if (name.empty()) continue;
        for (const ImageTopic& right : index_.images) {
          const bool is_pair = lower_case(right.name) == name && !left.is_depth() && !right.is_depth();
          const bool is_asked =
              (left_ == nullptr || left_ == &left) && (right_ == nullptr || right_ == &right);
          if (is_pair && is_asked) offer(stereo_of(left, right), sides.is_infrared ? 100 : 300);
        }
      }
    }
  }

  ChosenTopics stereo_of(const ImageTopic& left, const ImageTopic& right) const {
    return {Sensor::stereo, &left, &right, left_camera_ != nullptr ? left_camera_ : camera_of(left),
            right_camera_ != nullptr ? right_camera_ : camera_of(right)};
  }

  void find_depth() {
    for (const ImageTopic& depth : index_.images) {
      if (depth_ == nullptr ? !depth.is_depth() : depth_ != &depth) continue;
      for (const ImageTopic& image : index_.images) {
        if (left_ == nullptr ? image.is_depth() : left_ != &image) continue;
        if (&image == &depth) continue;
        ChosenTopics found{Sensor::rgbd, &image, &depth,
                           left_camera_ != nullptr ? left_camera_ : camera_of(image),
                           right_camera_ != nullptr ? right_camera_ : camera_of(depth)};
        std::string why;
        found.is_registered = is_registered(found, why);
        if (found.is_registered || (left_ != nullptr && depth_ != nullptr)) {
          offer(found, 200 + static_cast<int>(common_beginning(image.name, depth.name)));
        } else if (reason_.empty()) {
          reason_ = std::move(why);
        }
      }
    }
  }

  static bool is_registered(const ChosenTopics& pair, std::string& why) {
    const ImageTopic &image = *pair.left, &depth = *pair.second;
    const bool sizes_differ = image.size.width > 0 && depth.size.width > 0 && !(image.size == depth.size);
    const bool has_cameras = pair.left_camera != nullptr && pair.second_camera != nullptr;
    if (sizes_differ || (has_cameras && !is_same_camera(pair.left_camera->info, pair.second_camera->info))) {
      why = fmt::format(
          "the depth of {} is not registered to {}: {} (record depth that is aligned to colour, or choose "
          "with --left-topic and --depth-topic)",
          printable(depth.name, 100), printable(image.name, 100),
          sizes_differ ? fmt::format("{} x {} beside {} x {} pixels", depth.size.width, depth.size.height,
                                     image.size.width, image.size.height)
                       : std::string("their cameras have other K"));
      return false;
    }
    if (has_cameras || has_word(depth.name, {"aligned", "registered"}) || depth.frame == image.frame)
      return true;
    why = fmt::format(
        "nothing says that the depth of {} is registered to {}: their frames are '{}' and '{}' (choose with "
        "--left-topic and --depth-topic)",
        printable(depth.name, 100), printable(image.name, 100), printable(depth.frame, 40),
        printable(image.frame, 40));
    return false;
  }

  static std::size_t common_beginning(std::string_view a, std::string_view b) {
    std::size_t words = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()) && a[i] == b[i]; ++i)
      words += a[i] == '/' ? 1 : 0;
    return std::min<std::size_t>(words, 9);
  }

  void offer(const ChosenTopics& found, int points) {
    const bool needs_both = found.sensor == Sensor::stereo;
    if (!options_.camera.empty() ||
        (found.left_camera != nullptr && (!needs_both || found.second_camera != nullptr)))
      points += 1000;
    if (says_rectified(found.left->name)) points += 40;
    if (!found.left->is_compressed) points += 20;
    const bool is_automatic = options_.cameras == DatasetCameras::automatic;
    const bool wants_colour = is_automatic ? !needs_both : options_.cameras == DatasetCameras::colour;
    if ((found.left->kind == PixelKind::colour) == wants_colour)
      points += is_automatic && needs_both ? 10 : 60;
    if (found.left->kind == PixelKind::unknown) points -= 50;
    if (best_.left != nullptr && points <= points_) return;
    best_ = found;
    points_ = points;
  }

  const BagIndex& index_;
  const DatasetOptions& options_;
  const std::string& place_;
  const ImageTopic *left_ = nullptr, *right_ = nullptr, *depth_ = nullptr;
  const CameraTopic *left_camera_ = nullptr, *right_camera_ = nullptr;
  ChosenTopics best_;
  int points_ = 0;
  std::string reason_;
};

}  // namespace

std::string ChosenTopics::text() const {
  const auto named = [](const CameraTopic* camera) {
    return camera == nullptr ? std::string("none") : printable(camera->name, 100);
  };
  return fmt::format("{} {} ({}) and {} {} ({}); cameras {}{}", sensor == Sensor::stereo ? "left" : "image",
                     printable(left->name, 100), printable(left->format, 40),
                     sensor == Sensor::stereo ? "right" : "depth", printable(second->name, 100),
                     printable(second->format, 40), named(left_camera),
                     sensor == Sensor::stereo ? fmt::format(" and {}", named(second_camera)) : std::string());
}

std::optional<ChosenTopics> choose_topics(const BagIndex& index, const DatasetOptions& options,
                                          const std::string& place, std::string& reason) {
  if (!options.topics.right.empty() && !options.topics.depth.empty())
    throw UsageError("--right-topic and --depth-topic: expected one of them");
  return Chooser(index, options, place).choose(reason);
}

}  // namespace penumbra::slam
