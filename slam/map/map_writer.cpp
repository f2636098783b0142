#include <algorithm>
#include <shared_mutex>

#include "nn/base/checksummed_file.h"
#include "slam/geometry/stored_camera.h"
#include "slam/map/map_file.h"

namespace penumbra::slam {

namespace {

void put_pose(ByteWriter& out, const SE3& T) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out.put(T.rotation(row, column));
  }
  for (int row = 0; row < 3; ++row) out.put(T.translation[row]);
}

void put_object(ByteWriter& out, const SeenObject& object) {
  out.put<std::int32_t>(object.number);
  out.put(static_cast<std::uint32_t>(object.class_name.size()));
  out.put_array(std::span<const char>(object.class_name));
  for (int i = 0; i < 3; ++i) out.put(object.position[i]);
  const Rect& r = object.region;
  for (const std::int32_t value : {r.x, r.y, r.width, r.height}) out.put(value);
  out.put<char>(object.stands);
}

void put_keyframe(ByteWriter& out, const KeyFrame& keyframe) {
  out.put<std::int32_t>(keyframe.frame_index);
  out.put(keyframe.timestamp);
  put_pose(out, keyframe.T_cw);
  out.put<std::int32_t>(keyframe.submap);
  const FrameFeatures& f = *keyframe.features;
  const FeatureView view = keyframe.view();
  std::vector<Keypoint> keypoints;
  std::vector<float> u_right;
  for (int i = 0; i < view.size(); ++i) {
    keypoints.push_back(view.keypoint(i));
    u_right.push_back(view.u_right(i));
  }
  out.put(static_cast<std::uint32_t>(f.size()));
  out.put_array(std::span<const Keypoint>(keypoints));
  out.put_array(std::span(f.left.descriptors));
  out.put_array(std::span<const float>(u_right));
  out.put_array(std::span(f.depth));
  out.put_array(std::span<const char>(keyframe.movable));
  out.put_array(std::span(f.colour));
  // One whose place was never measured says nothing.
  const auto is_known = [](const SeenObject& object) { return object.position.allFinite(); };
  out.put(
      static_cast<std::uint32_t>(std::count_if(keyframe.objects.begin(), keyframe.objects.end(), is_known)));
  for (const SeenObject& object : keyframe.objects) {
    if (is_known(object)) put_object(out, object);
  }
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

ByteWriter body_of(const Map& map) {
  const std::shared_lock lock(map.mutex());
  ByteWriter body;
  put_camera(body, map.camera());
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
  return body;
}

}  // namespace

void write_map(const std::filesystem::path& path, const Map& map) {
  const ByteWriter body = body_of(map);
  nn::write_checksummed_file(path, kMapFileMagic, kMapFileVersion, body.bytes());
}

}  // namespace penumbra::slam
