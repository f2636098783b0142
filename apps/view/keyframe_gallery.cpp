#include "apps/view/keyframe_gallery.h"

#include <fmt/core.h>

#include <charconv>
#include <map>
#include <string>
#include <system_error>

#include "apps/view/frame_picture.h"
#include "nn/base/error.h"
#include "nn/image/image_file.h"

namespace penumbra::apps {

std::map<int, std::filesystem::path> gallery_pictures(const std::filesystem::path& folder) {
  std::map<int, std::filesystem::path> pictures;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    const std::string name = entry.path().stem().string();
    int frame = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), frame);
    const bool is_number = error == std::errc() && end == name.data() + name.size() && name[0] != '-';
    if (name.size() >= 6 && is_number && entry.path().extension() == ".jpg") pictures[frame] = entry.path();
  }
  return pictures;
}

void clear_keyframe_gallery(const std::filesystem::path& folder) {
  for (const auto& [frame, picture] : gallery_pictures(folder)) std::filesystem::remove(picture);
}

void write_keyframe_gallery(const std::filesystem::path& folder, const slam::StereoDataset& dataset,
                            const slam::Recorder& record, int most) {
  clear_keyframe_gallery(folder);
  std::filesystem::create_directories(folder);
  std::map<int, int> row_of;  // frame number -> place in the dataset
  int row_number = 0;
  for (const slam::KeptFrame& frame : record.frames()) row_of[frame.index] = row_number++;
  const auto& keyframes = record.slam().map().keyframes();
  const int count = static_cast<int>(keyframes.size()), shown = std::min(count, most);
  for (int n = 0; n < shown; ++n) {
    const slam::KeyFrame& keyframe =
        *keyframes[static_cast<std::size_t>(n) * static_cast<std::size_t>(count) /
                   static_cast<std::size_t>(shown)];
    const auto row = row_of.find(keyframe.frame_index);
    if (row == row_of.end() || record.slam().is_loaded(keyframe)) continue;
    const auto seen = record.sightings().find(keyframe.frame_index);
    const auto sightings =
        seen != record.sightings().end() ? seen->second : std::vector<slam::InstanceSighting>{};
    try {
      nn::write_image(folder / fmt::format("{:06d}.jpg", keyframe.frame_index),
                      draw_frame(dataset.load(row->second).left,
                                 slam::frame_view(keyframe.view(), keyframe.points, sightings)));
    } catch (const InputError&) {
      continue;
    }
  }
}

}  // namespace penumbra::apps
