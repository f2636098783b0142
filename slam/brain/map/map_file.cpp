#include "slam/brain/map/map_file.h"

#include <algorithm>
#include <cmath>

#include "nn/base/checksummed_file.h"
#include "slam/geometry/stored_camera.h"

namespace penumbra::slam::brain {

namespace {

static_assert(sizeof(PlacePoint) == 48 && sizeof(Landmark) == 156 && sizeof(IntensityProfile) == 2400);
constexpr std::size_t kNodeBytes = 4 + 5 * 8 + 3 * 4, kLinkBytes = 2 * 4 + 5 * 8 + 1;  // at least

void put_pose(ByteWriter& out, const PlanePose& pose) {
  for (const double value : {pose.x, pose.y, pose.heading}) out.put(value);
}

template <typename T>
void put_list(ByteWriter& out, const std::vector<T>& values) {
  out.put(static_cast<std::uint32_t>(values.size()));
  out.put_array(std::span<const T>(values));
}

PlanePose get_pose(ByteReader& in) {
  PlanePose pose;
  for (double* value : {&pose.x, &pose.y, &pose.heading}) *value = in.get_finite("pose");
  return pose;
}

template <typename T>
std::vector<T> get_list(ByteReader& in, std::string_view what) {
  const std::uint32_t count = in.get_count(sizeof(T), what);
  return in.get_array<T>(count, what);
}

void require_finite(const ByteReader& in, std::span<const float> values, std::string_view what) {
  if (!std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); }))
    in.refuse(fmt::format("finite {}", what), "one that is not");
}

Template get_view(ByteReader& in, TemplateKind kind) {
  Template view;
  if (kind == TemplateKind::intensity) {
    view.profile = in.get<IntensityProfile>("profile");
    require_finite(in, view.profile, "profile");
    return view;
  }
  view.landmarks = get_list<Landmark>(in, "landmarks");
  for (const Landmark& landmark : view.landmarks) {
    const float numbers[] = {landmark.x0, landmark.y0,    landmark.x1,
                             landmark.y1, landmark.score, landmark.interest};
    require_finite(in, numbers, "landmark");
    require_finite(in, landmark.descriptor, "descriptor of a landmark");
    if (!stands(landmark.landmark_class))
      in.refuse("a class of what stands", fmt::format("class {}", landmark.landmark_class));
  }
  return view;
}

Node get_node(ByteReader& in) {
  Node node;
  node.frame = in.get<std::int32_t>("frame");
  node.timestamp = in.get_finite("time");
  node.pose = get_pose(in);
  node.strength = in.get_finite("strength");
  node.activity = get_list<float>(in, "activity");
  require_finite(in, node.activity, "activity");
  node.points = get_list<PlacePoint>(in, "points");
  for (const PlacePoint& point : node.points) require_finite(in, point.position, "point");
  return node;
}

Link get_link(ByteReader& in, int nodes) {
  Link link;
  link.from = in.get<std::int32_t>("node");
  link.to = in.get<std::int32_t>("node");
  link.motion = get_pose(in);
  link.metres = in.get_finite("deviation");
  link.radians = in.get_finite("deviation");
  link.recalled = in.get<char>("kind of link") != 0;
  const auto is_node = [&](int i) { return i >= 0 && i < nodes; };
  if (!is_node(link.from) || !is_node(link.to) || link.from == link.to || !(link.metres > 0.0) ||
      !(link.radians > 0.0)) {
    in.refuse(fmt::format("a link between two of {} nodes, with deviations above 0", nodes),
              fmt::format("{} to {}, {} m, {} rad", link.from, link.to, link.metres, link.radians));
  }
  return link;
}

}  // namespace

void write_cognitive_map(const std::filesystem::path& path, const StoredMap& stored) {
  ByteWriter body;
  put_camera(body, stored.camera);
  for (const double value : {stored.camera_yaw, stored.camera_pitch}) body.put(value);
  body.put(static_cast<std::uint32_t>(stored.templates));
  body.put(stored.scene_distance);
  body.put(static_cast<std::uint32_t>(stored.map.size()));
  for (int i = 0; i < stored.map.size(); ++i) {
    const Node& node = stored.map.node(i);
    body.put<std::int32_t>(node.frame);
    body.put(node.timestamp);
    put_pose(body, node.pose);
    body.put(node.strength);
    put_list(body, node.activity);
    put_list(body, node.points);
    const Template& view = stored.views[static_cast<std::size_t>(i)];
    if (stored.templates == TemplateKind::intensity) {
      body.put(view.profile);
    } else {
      put_list(body, view.landmarks);
    }
  }
  body.put(static_cast<std::uint32_t>(stored.map.links().size()));
  for (const Link& link : stored.map.links()) {
    body.put<std::int32_t>(link.from);
    body.put<std::int32_t>(link.to);
    put_pose(body, link.motion);
    body.put(link.metres);
    body.put(link.radians);
    body.put<char>(link.recalled);
  }
  nn::write_checksummed_file(path, kCognitiveMapMagic, kCognitiveMapVersion, body.bytes());
}

StoredMap read_cognitive_map(const std::filesystem::path& path) {
  const std::string body = nn::read_checksummed_file(path, kCognitiveMapMagic, kCognitiveMapVersion,
                                                     "a cognitive map that Penumbra saved");
  const std::string place = path.string();
  ByteReader in(body, place, nn::kChecksummedHeaderBytes);
  StoredMap stored;
  stored.camera = get_camera(in);
  stored.camera_yaw = in.get_finite("camera's yaw");
  stored.camera_pitch = in.get_finite("camera's pitch");
  const auto kind = in.get<std::uint32_t>("kind of templates");
  if (kind > 1) in.refuse("0 (landmarks) or 1 (intensity) as kind of templates", fmt::format("{}", kind));
  stored.templates = static_cast<TemplateKind>(kind);
  stored.scene_distance = in.get_finite("distance of the scene");
  const std::uint32_t nodes = in.get_count(kNodeBytes, "nodes");
  for (std::uint32_t i = 0; i < nodes; ++i) {
    stored.map.add(get_node(in));
    stored.views.push_back(get_view(in, stored.templates));
  }
  const std::uint32_t links = in.get_count(kLinkBytes, "links");
  for (std::uint32_t i = 0; i < links; ++i) stored.map.add(get_link(in, stored.map.size()));
  in.expect_end("the map");
  return stored;
}

}  // namespace penumbra::slam::brain
