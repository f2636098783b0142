#include "slam/map/map_file.h"

#include <fmt/core.h>

#include <cmath>

#include "nn/base/byte_stream.h"
#include "nn/io/crc32.h"
#include "nn/io/file.h"
#include "nn/io/image_container.h"

namespace penumbra::slam {

namespace {

constexpr std::string_view kMagic = "PENUMAP\n";
constexpr std::size_t kHeaderBytes = 8 + 4 + 4 + 8;
constexpr std::uint32_t kMostLevels = 64;

using Colour = std::array<std::uint8_t, 3>;
static_assert(sizeof(Keypoint) == 20 && sizeof(Descriptor) == 32 && sizeof(Colour) == 3);
constexpr std::size_t kFeatureBytes = 20 + 32 + 4 + 4 + 1 + 3;
constexpr std::size_t kKeyframeBytes = 4 + 8 + 12 * 8 + 4 + 4;  // without features
constexpr std::size_t kPointBytes = 24 + 8 + 3 + 4 + 4;         // without patch and observations
constexpr std::size_t kObservationBytes = 4 + 4 + 1;
constexpr int kMostSubmaps = 1 << 30;

void put_camera(ByteWriter& out, const StereoCamera& c) {
  for (const double value : {c.fx, c.fy, c.cx, c.cy, c.baseline}) out.put(value);
  for (const std::int32_t value : {c.width, c.height}) out.put(value);
}

void put_pose(ByteWriter& out, const SE3& T) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out.put(T.rotation(row, column));
  }
  for (int row = 0; row < 3; ++row) out.put(T.translation[row]);
}

void put_keyframe(ByteWriter& out, const KeyFrame& keyframe) {
  out.put<std::int32_t>(keyframe.frame_index);
  out.put(keyframe.timestamp);
  put_pose(out, keyframe.T_cw);
  out.put<std::int32_t>(keyframe.submap);
  const FrameFeatures& f = *keyframe.features;
  out.put(static_cast<std::uint32_t>(f.size()));
  out.put_array(std::span(f.left.keypoints));
  out.put_array(std::span(f.left.descriptors));
  out.put_array(std::span(f.u_right));
  out.put_array(std::span(f.depth));
  out.put_array(std::span<const char>(f.movable));
  out.put_array(std::span(f.colour));
}

void put_patch(ByteWriter& out, const MapPoint& point) {
  const bool is_usable = !point.patch.empty() && point.patch_depth > 0.0;
  out.put<std::int32_t>(is_usable ? point.patch.level : -1);
  if (!is_usable) return;
  out.put(point.patch_depth);
  for (int i = 0; i < 2; ++i) out.put(point.patch.offset[i]);
  out.put(point.patch.pixels);
}

void put_point(ByteWriter& out, const MapPoint& point, const std::vector<std::uint32_t>& place_of) {
  for (int i = 0; i < 3; ++i) out.put(point.position[i]);
  out.put<std::int32_t>(point.visible);
  out.put<std::int32_t>(point.found);
  out.put(point.colour);
  put_patch(out, point);
  out.put(static_cast<std::uint32_t>(point.observations.size()));
  for (const Observation& o : point.observations) {
    out.put(place_of[static_cast<std::size_t>(o.keyframe->id)]);
    out.put(static_cast<std::uint32_t>(o.feature));
    out.put(o.keyframe->aligned[static_cast<std::size_t>(o.feature)]);
  }
}

[[noreturn]] void throw_invalid(const ByteReader& in, std::string_view expected, std::string_view found) {
  throw InputError(fmt::format("before {}", in.here()), expected, found);
}

double get_finite(ByteReader& in, std::string_view what) {
  const double value = in.get<double>(what);
  if (!std::isfinite(value)) throw_invalid(in, fmt::format("a finite {}", what), fmt::format("{}", value));
  return value;
}

StereoCamera get_camera(ByteReader& in) {
  StereoCamera c;
  for (double* value : {&c.fx, &c.fy, &c.cx, &c.cy, &c.baseline}) *value = get_finite(in, "camera parameter");
  c.width = in.get<std::int32_t>("image width");
  c.height = in.get<std::int32_t>("image height");
  if (!(c.fx > 0.0 && c.fy > 0.0 && c.baseline > 0.0 && c.width > 0 && c.height > 0 &&
        static_cast<std::int64_t>(c.width) * c.height <= nn::kMaxImagePixels)) {
    throw_invalid(
        in, "focal lengths, baseline and image size above zero, and an image that can be",
        fmt::format("fx {} fy {} baseline {} size {}x{}", c.fx, c.fy, c.baseline, c.width, c.height));
  }
  return c;
}

std::vector<double> get_scales(ByteReader& in) {
  const std::uint32_t levels = in.get_count(sizeof(double), "pyramid levels");
  if (levels == 0 || levels > kMostLevels) {
    throw_invalid(in, fmt::format("1 to {} pyramid levels", kMostLevels), fmt::format("{}", levels));
  }
  std::vector<double> scales;
  for (std::uint32_t l = 0; l < levels; ++l) {
    scales.push_back(get_finite(in, "scale"));
    const double before = l == 0 ? 1.0 : scales[l - 1];
    if (l == 0 ? scales[0] != 1.0 : !(scales[l] > before)) {
      throw_invalid(in, "scales that begin with 1 and grow", fmt::format("{}", scales[l]));
    }
  }
  return scales;
}

SE3 get_pose(ByteReader& in) {
  SE3 T;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) T.rotation(row, column) = get_finite(in, "rotation");
  }
  for (int row = 0; row < 3; ++row) T.translation[row] = get_finite(in, "translation");
  const double skewness = (T.rotation * T.rotation.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!(skewness < 1e-6) || T.rotation.determinant() < 0.0) {
    throw_invalid(in, "a rotation matrix", fmt::format("one that is off by {}", skewness));
  }
  return T;
}

void check_features(const ByteReader& in, const FrameFeatures& f, const StereoCamera& camera, int levels) {
  for (int i = 0; i < f.size(); ++i) {
    const std::size_t at = static_cast<std::size_t>(i);
    const Keypoint& k = f.left.keypoints[at];
    const bool stereo = f.u_right[at] >= 0.0F;
    const bool good = k.u >= -1.0F && k.u <= static_cast<float>(camera.width) && k.v >= -1.0F &&
                      k.v <= static_cast<float>(camera.height) && k.level >= 0 && k.level < levels &&
                      std::isfinite(k.angle) && std::isfinite(k.response) && std::isfinite(f.u_right[at]) &&
                      std::isfinite(f.depth[at]) && stereo == (f.depth[at] > 0.0F) && f.movable[at] >= 0 &&
                      f.movable[at] <= 1;
    if (!good) {
      throw_invalid(
          in, "features inside the image and the pyramid",
          fmt::format("feature {} at ({}, {}), level {}, depth {}", i, k.u, k.v, k.level, f.depth[at]));
    }
  }
}

void get_keyframe(ByteReader& in, const StereoCamera& camera, Map& map) {
  const int frame_index = in.get<std::int32_t>("frame number");
  const double timestamp = get_finite(in, "timestamp");
  const SE3 T_cw = get_pose(in);
  const int submap = in.get<std::int32_t>("sub-map");
  if (submap < 0 || submap >= kMostSubmaps)
    throw_invalid(in, "the number of a sub-map", fmt::format("{}", submap));
  const std::uint32_t count = in.get_count(kFeatureBytes, "features");
  auto f = std::make_shared<FrameFeatures>();
  f->left.keypoints = in.get_array<Keypoint>(count, "keypoints");
  f->left.descriptors = in.get_array<Descriptor>(count, "descriptors");
  f->u_right = in.get_array<float>(count, "right columns");
  f->depth = in.get_array<float>(count, "depths");
  f->movable = in.get_array<char>(count, "movable marks");
  f->colour = in.get_array<Colour>(count, "colours");
  check_features(in, *f, camera, static_cast<int>(map.scales().size()));
  f->grid = FeatureGrid(f->left.keypoints, camera.width, camera.height);
  std::unique_ptr<KeyFrame> keyframe = map.new_keyframe(frame_index, timestamp, T_cw, std::move(f));
  keyframe->submap = submap;
  map.insert_keyframe(std::move(keyframe));
}

void get_patch(ByteReader& in, int levels, MapPoint& point) {
  const int level = in.get<std::int32_t>("patch level");
  if (level == -1) return;
  point.patch_depth = get_finite(in, "depth of a patch");
  for (int i = 0; i < 2; ++i) point.patch.offset[i] = in.get<float>("patch offset");
  point.patch.pixels = in.get<decltype(Patch::pixels)>("patch");
  point.patch.level = level;
  if (level < 0 || level >= levels || !(point.patch_depth > 0.0) || !(point.patch.offset.norm() < 1e3F)) {
    throw_invalid(in, "a patch of a point before the camera",
                  fmt::format("level {}, depth {}", level, point.patch_depth));
  }
}

void get_point(ByteReader& in, Map& map) {
  Eigen::Vector3d position;
  for (int i = 0; i < 3; ++i) position[i] = get_finite(in, "position");
  const int visible = in.get<std::int32_t>("count"), found = in.get<std::int32_t>("count");
  const Colour colour = in.get<Colour>("colour");
  if (visible < 1 || found < 0) {
    throw_invalid(in, "counts of frames that saw a point", fmt::format("{} and {}", visible, found));
  }
  MapPoint head;
  get_patch(in, static_cast<int>(map.scales().size()), head);
  const std::uint32_t count = in.get_count(kObservationBytes, "observations");
  if (count == 0) throw_invalid(in, "a point that a keyframe sees", "none");
  MapPoint* point = nullptr;
  std::int64_t last = -1;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto k = in.get<std::uint32_t>("observation"), feature = in.get<std::uint32_t>("observation");
    const char aligned = in.get<char>("observation");
    const auto& keyframes = map.keyframes();
    if (k >= keyframes.size() || k <= last || feature >= keyframes[k]->points.size() ||
        keyframes[k]->points[feature] != nullptr || aligned < 0 || aligned > 1) {
      throw_invalid(in, "the free feature of a later keyframe",
                    fmt::format("feature {} of keyframe {}", feature, k));
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

void write_map(const std::filesystem::path& path, const StereoCamera& camera, const Map& map) {
  ByteWriter body;
  put_camera(body, camera);
  body.put(static_cast<std::uint32_t>(map.scales().size()));
  body.put_array(std::span(map.scales()));

  const std::vector<KeyFrame*>& keyframes = map.keyframes();
  std::vector<std::uint32_t> place_of;  // by id
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    place_of.resize(static_cast<std::size_t>(keyframes[k]->id) + 1);
    place_of.back() = static_cast<std::uint32_t>(k);
  }
  body.put(static_cast<std::uint32_t>(keyframes.size()));
  for (const KeyFrame* keyframe : keyframes) put_keyframe(body, *keyframe);

  const auto is_part = [](const auto& p) { return !p->erased && !p->observations.empty(); };
  body.put(static_cast<std::uint32_t>(std::count_if(map.points().begin(), map.points().end(), is_part)));
  for (const auto& point : map.points()) {
    if (is_part(point)) put_point(body, *point, place_of);
  }

  ByteWriter file;
  file.put_array(std::span(kMagic));
  file.put(kMapFileVersion);
  file.put(nn::crc32(body.bytes()));
  file.put(static_cast<std::uint64_t>(body.bytes().size()));
  file.put_array(std::span(body.bytes()));
  nn::write_file(path, file.bytes());
}

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

SavedMap read_map(const std::filesystem::path& path) {
  const std::string bytes = nn::read_file(path, "a map that Penumbra saved");
  const std::string place = path.string();
  if (bytes.substr(0, kMagic.size()) != kMagic) {
    throw InputError(place, "a map that Penumbra saved", "a file that begins differently");
  }
  ByteReader header(std::string_view(bytes).substr(kMagic.size()), place, kMagic.size());
  const auto version = header.get<std::uint32_t>("version");
  if (version != kMapFileVersion) {
    throw InputError(place, fmt::format("a map file of version {}", kMapFileVersion),
                     fmt::format("version {}", version));
  }
  const auto crc = header.get<std::uint32_t>("checksum");
  const auto size = header.get<std::uint64_t>("size");
  if (size != header.remaining()) {
    throw InputError(place, fmt::format("{} bytes after the header", size),
                     fmt::format("{}: the file is torn", header.remaining()));
  }
  const std::string_view body = std::string_view(bytes).substr(kHeaderBytes);
  if (nn::crc32(body) != crc) throw InputError(place, "the checksum that the header names", "damaged bytes");

  ByteReader in(body, place, kHeaderBytes);
  SavedMap saved;
  saved.camera = get_camera(in);
  saved.map = std::make_unique<Map>(get_scales(in));
  const std::uint32_t keyframes = in.get_count(kKeyframeBytes, "keyframes");
  for (std::uint32_t k = 0; k < keyframes; ++k) get_keyframe(in, saved.camera, *saved.map);
  const std::uint32_t points = in.get_count(kPointBytes, "points");
  for (std::uint32_t p = 0; p < points; ++p) get_point(in, *saved.map);
  if (in.remaining() > 0) {
    throw InputError(in.here(), "the end of the map", fmt::format("{} more bytes", in.remaining()));
  }
  for (KeyFrame* keyframe : saved.map->keyframes()) saved.map->update_covisibility(keyframe);
  return saved;
}

}  // namespace penumbra::slam
