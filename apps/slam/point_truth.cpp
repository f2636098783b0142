#include "apps/slam/point_truth.h"

#include <algorithm>
#include <cmath>

#include "apps/slam/segmenter.h"
#include "nn/base/error.h"
#include "nn/image/image_file.h"
#include "slam/sources/folder_listing.h"

namespace penumbra::apps {

namespace {

constexpr double kMoves = 0.25, kStands = 0.05;  // pixels a frame

WordImage read_flow(const std::filesystem::path& path, const Size& size) {
  WordImage flow = nn::read_stored_image(path, nn::ImageColour::stored).words;
  if (flow.channels() == 3 && flow.size() == size) return flow;
  throw InputError(path.string(), fmt::format("{}x{} pixels of 16-bit flow", size.width, size.height),
                   fmt::format("{}x{} of {} channels", flow.width(), flow.height(), flow.channels()));
}

}  // namespace

double JudgedPoints::moving_recall() const {
  return moving > 0 ? static_cast<double>(moving_left_out) / static_cast<double>(moving) : 1.0;
}

double JudgedPoints::standing_share() const {
  return standing > 0 ? static_cast<double>(standing_kept) / static_cast<double>(standing) : 1.0;
}

std::optional<PointTruth> PointTruth::open(const std::filesystem::path& recording,
                                           const slam::StereoCamera& camera, const slam::Trajectory& truth) {
  for (const char* part : {"flow", "depth_clean", "instances"}) {
    if (!std::filesystem::exists(recording / part)) return std::nullopt;
  }
  return PointTruth(recording, camera, truth);
}

PointTruth::PointTruth(const std::filesystem::path& recording, const slam::StereoCamera& camera,
                       const slam::Trajectory& truth)
    : camera_(camera),
      truth_(truth),
      instances_(make_mask_reader(recording / "instances")),
      depths_(recording, recording / "depth_clean") {
  for (const auto& entry : std::filesystem::directory_iterator(recording / "flow"))
    flow_.push_back(entry.path());
  std::sort(flow_.begin(), flow_.end());
}

void PointTruth::judge(int frame, const slam::FrameView& view, JudgedPoints& count) const {
  const auto at = static_cast<std::size_t>(frame);
  if (at >= flow_.size() || at + 1 >= truth_.size() || !depths_.has(frame)) return;
  const Size size{camera_.width, camera_.height};
  slam::ImageToSegment from;
  from.frame = frame;
  from.image = ByteImage::filled(size.width, size.height, 0);
  std::vector<Rect> people;
  for (const slam::Instance& instance : instances_(from)) {
    if (instance.class_name == "person") people.push_back(instance.region);
  }
  if (people.empty()) return;
  const WordImage flow = read_flow(flow_[at], size);
  const FloatImage depth = depths_.load(frame, size);
  const slam::SE3 T_next_now = truth_[at + 1].T_wc.inverse() * truth_[at].T_wc;
  for (const slam::FrameView::Feature& feature : view.features) {
    const int x = static_cast<int>(std::lround(feature.u)), y = static_cast<int>(std::lround(feature.v));
    if (std::none_of(people.begin(), people.end(), [&](const Rect& box) { return box.contains(x, y); }))
      continue;
    const std::uint16_t* code = &flow.at(x, y);  // valid, v, u
    const float z = depth.at(x, y);
    if (code[0] == 0 || !(z > 0.0F)) continue;
    const auto pixels = [](std::uint16_t c) { return (static_cast<double>(c) - 32768.0) / 64.0; };
    const Eigen::Vector3d still = T_next_now * camera_.back_project(x, y, static_cast<double>(z));
    if (!(still.z() > 0.0)) continue;
    const double off =
        (Eigen::Vector2d(x + pixels(code[2]), y + pixels(code[1])) - camera_.project(still)).norm();
    if (off >= kMoves) {
      ++count.moving;
      count.moving_left_out += feature.movable;
    } else if (off < kStands) {
      ++count.standing;
      count.standing_kept += !feature.movable;
    }
  }
}

}  // namespace penumbra::apps
