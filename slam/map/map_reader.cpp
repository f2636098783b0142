#include <fmt/core.h>

#include <cmath>
#include <cstdlib>

#include "nn/base/byte_stream.h"
#include "nn/base/checksummed_file.h"
#include "slam/geometry/stored_camera.h"
#include "slam/map/map_file.h"

namespace penumbra::slam {

namespace {

constexpr std::uint32_t kMostLevels = 64;

using Colour = std::array<std::uint8_t, 3>;
static_assert(sizeof(Keypoint) == 20 && sizeof(Descriptor) == 32 && sizeof(Colour) == 3);
constexpr std::size_t kFeatureBytes = 20 + 32 + 4 + 4 + 1 + 3;
constexpr std::size_t kKeyframeBytes = 4 + 8 + 12 * 8 + 4 + 4 + 4;  // without features and objects
constexpr std::size_t kObjectBytes = 4 + 4 + 24 + 16 + 1;           // without its class name
constexpr std::size_t kPointBytes = 24 + 8 + 3 + 4 + 4;             // without patch and observations
constexpr std::size_t kObservationBytes = 4 + 4 + 1;
constexpr int kMostSubmaps = 1 << 30, kMostObjects = 1 << 30;

bool is_mark(char c) { return c == 0 || c == 1; }

std::vector<double> get_scales(ByteReader& in) {
  const std::uint32_t levels = in.get_count(sizeof(double), "pyramid levels");
  if (levels == 0 || levels > kMostLevels) {
    in.refuse(fmt::format("1 to {} pyramid levels", kMostLevels), fmt::format("{}", levels));
  }
  std::vector<double> scales;
  for (std::uint32_t l = 0; l < levels; ++l) {
    scales.push_back(in.get_finite("scale"));
    const double before = l == 0 ? 1.0 : scales[l - 1];
    if (l == 0 ? scales[0] != 1.0 : !(scales[l] > before)) {
      in.refuse("scales that begin with 1 and grow", fmt::format("{}", scales[l]));
    }
  }
  return scales;
}

SE3 get_pose(ByteReader& in) {
  SE3 T;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) T.rotation(row, column) = in.get_finite("rotation");
  }
  for (int row = 0; row < 3; ++row) T.translation[row] = in.get_finite("translation");
  const double skewness = (T.rotation * T.rotation.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!(skewness < 1e-6) || T.rotation.determinant() < 0.0) {
    in.refuse("a rotation matrix", fmt::format("one that is off by {}", skewness));
  }
  return T;
}

void check_features(const ByteReader& in, const FrameFeatures& f, const std::vector<char>& movable,
                    const StereoCamera& camera, int levels) {
  for (int i = 0; i < f.size(); ++i) {
    const std::size_t at = static_cast<std::size_t>(i);
    const Keypoint& k = f.left.keypoints[at];
    const bool stereo = f.u_right[at] >= 0.0F;
    const bool good = k.u >= -1.0F && k.u <= static_cast<float>(camera.width) && k.v >= -1.0F &&
                      k.v <= static_cast<float>(camera.height) && k.level >= 0 && k.level < levels &&
                      std::isfinite(k.angle) && std::isfinite(k.response) && std::isfinite(f.u_right[at]) &&
                      std::isfinite(f.depth[at]) && stereo == (f.depth[at] > 0.0F) && is_mark(movable[at]);
    if (!good) {
      in.refuse("features inside the image and the pyramid",
                fmt::format("feature {} at ({}, {}), level {}, depth {}", i, k.u, k.v, k.level, f.depth[at]));
    }
  }
}

SeenObject get_object(ByteReader& in) {
  SeenObject object;
  object.number = in.get<std::int32_t>("number of an object");
  const std::vector<char> name = in.get_array<char>(in.get_count(1, "class name"), "class name");
  object.class_name.assign(name.begin(), name.end());
  for (int i = 0; i < 3; ++i) object.position[i] = in.get_finite("position of an object");
  Rect& r = object.region;
  for (int* value : {&r.x, &r.y, &r.width, &r.height}) *value = in.get<std::int32_t>("region of an object");
  const char stands = in.get<char>("mark of what stands");
  constexpr int kFarthest = 1 << 20;  // pixels: sums of them are numbers
  const bool is_region = std::abs(std::int64_t{r.x}) < kFarthest && std::abs(std::int64_t{r.y}) < kFarthest &&
                         r.width >= 0 && r.width < kFarthest && r.height >= 0 && r.height < kFarthest;
  if (object.number < 0 || object.number >= kMostObjects || !is_region || !is_mark(stands)) {
    in.refuse("an object with a number and a region of the image",
              fmt::format("number {}, region {}x{} at ({}, {}), mark {}", object.number, r.width, r.height,
                          r.x, r.y, static_cast<int>(stands)));
  }
  object.stands = stands != 0;
  return object;
}

void get_keyframe(ByteReader& in, Map& map) {
  const int frame_index = in.get<std::int32_t>("frame number");
  const double timestamp = in.get_finite("timestamp");
  const SE3 T_cw = get_pose(in);
  const int submap = in.get<std::int32_t>("sub-map");
  if (submap < 0 || submap >= kMostSubmaps) in.refuse("the number of a sub-map", fmt::format("{}", submap));
  const std::uint32_t count = in.get_count(kFeatureBytes, "features");
  auto f = std::make_shared<FrameFeatures>();
  f->left.keypoints = in.get_array<Keypoint>(count, "keypoints");
  f->left.descriptors = in.get_array<Descriptor>(count, "descriptors");
  f->u_right = in.get_array<float>(count, "right columns");
  f->depth = in.get_array<float>(count, "depths");
  std::vector<char> movable = in.get_array<char>(count, "movable marks");
  f->colour = in.get_array<Colour>(count, "colours");
  check_features(in, *f, movable, map.camera(), static_cast<int>(map.scales().size()));
  f->grid = FeatureGrid(f->left.keypoints, map.camera().width, map.camera().height);
  std::unique_ptr<KeyFrame> keyframe = map.new_keyframe(frame_index, timestamp, T_cw, std::move(f));
  keyframe->movable = std::move(movable);
  keyframe->submap = submap;
  const std::uint32_t objects = in.get_count(kObjectBytes, "objects");
  for (std::uint32_t i = 0; i < objects; ++i) keyframe->objects.push_back(get_object(in));
  map.insert_keyframe(std::move(keyframe));
}

void get_patch(ByteReader& in, int levels, MapPoint& point) {
  const int level = in.get<std::int32_t>("patch level");
  if (level == -1) return;
  point.patch_depth = in.get_finite("depth of a patch");
  for (int i = 0; i < 2; ++i) point.patch.offset[i] = in.get<float>("patch offset");
  point.patch.pixels = in.get<decltype(Patch::pixels)>("patch");
  point.patch.level = level;
  if (level < 0 || level >= levels || !(point.patch_depth > 0.0) || !(point.patch.offset.norm() < 1e3F)) {
    in.refuse("a patch of a point before the camera",
              fmt::format("level {}, depth {}", level, point.patch_depth));
  }
}

void get_point(ByteReader& in, Map& map) {
  Eigen::Vector3d position;
  for (int i = 0; i < 3; ++i) position[i] = in.get_finite("position");
  const int visible = in.get<std::int32_t>("count"), found = in.get<std::int32_t>("count");
  const Colour colour = in.get<Colour>("colour");
  if (visible < 1 || found < 0) {
    in.refuse("counts of frames that saw a point", fmt::format("{} and {}", visible, found));
  }
  MapPoint head;
  get_patch(in, static_cast<int>(map.scales().size()), head);
  const std::uint32_t count = in.get_count(kObservationBytes, "observations");
  if (count == 0) in.refuse("a point that a keyframe sees", "none");
  MapPoint* point = nullptr;
  std::int64_t last = -1;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto k = in.get<std::uint32_t>("observation"), feature = in.get<std::uint32_t>("observation");
    const char aligned = in.get<char>("observation");
    const auto& keyframes = map.keyframes();
    if (k >= keyframes.size() || k <= last || feature >= keyframes[k]->points.size() ||
        keyframes[k]->points[feature] != nullptr || !is_mark(aligned)) {
      in.refuse("the free feature of a later keyframe", fmt::format("feature {} of keyframe {}", feature, k));
    }
    last = k;
    if (point == nullptr) {
      point = map.add_point(position, keyframes[k], static_cast<int>(feature));
    } else {
      map.add_observation(point, keyframes[k], static_cast<int>(feature));
    }
    keyframes[k]->aligned[feature] = aligned;
  }
  point->patch = head.patch;
  point->patch_depth = head.patch_depth;
  point->visible = visible;
  point->found = found;
  point->colour = colour;
  map.update_point(point);
}

}  // namespace

void require_same_camera(const StereoCamera& of_map, const StereoCamera& now, const std::string& place) {
  constexpr double kTolerance = 1e-4;
  const double pixels = kTolerance * now.fx;
  const bool same = of_map.width == now.width && of_map.height == now.height &&
                    std::abs(of_map.fx - now.fx) <= pixels && std::abs(of_map.fy - now.fy) <= pixels &&
                    std::abs(of_map.cx - now.cx) <= pixels && std::abs(of_map.cy - now.cy) <= pixels &&
                    std::abs(of_map.baseline - now.baseline) <= kTolerance * now.baseline;
  if (same) return;
  const auto text = [](const StereoCamera& c) {
    return fmt::format("fx {:.6g} fy {:.6g} cx {:.6g} cy {:.6g} baseline {:.6g} size {}x{}", c.fx, c.fy, c.cx,
                       c.cy, c.baseline, c.width, c.height);
  };
  throw InputError(place, "a map of the dataset's camera, " + text(now), text(of_map));
}

std::unique_ptr<Map> read_map(const std::filesystem::path& path) {
  const std::string body =
      nn::read_checksummed_file(path, kMapFileMagic, kMapFileVersion, "a map that Penumbra saved");
  const std::string place = path.string();
  ByteReader in(body, place, nn::kChecksummedHeaderBytes);
  const StereoCamera camera = get_camera(in);
  auto map = std::make_unique<Map>(camera, get_scales(in));
  const std::uint32_t keyframes = in.get_count(kKeyframeBytes, "keyframes");
  for (std::uint32_t k = 0; k < keyframes; ++k) get_keyframe(in, *map);
  const std::uint32_t points = in.get_count(kPointBytes, "points");
  for (std::uint32_t p = 0; p < points; ++p) get_point(in, *map);
  in.expect_end("the map");
  for (KeyFrame* keyframe : map->keyframes()) map->update_covisibility(keyframe);
  return map;
}

}  // namespace penumbra::slam
