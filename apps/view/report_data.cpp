#include "apps/view/report_data.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <map>

#include "apps/common/run_json.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "slam/evaluation/alignment.h"
#include "slam/evaluation/ape.h"
#include "slam/geometry/association.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/map/dense/cloud_files.h"

namespace penumbra::apps {

namespace {

using nlohmann::json;

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text.push_back(i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63U] : '=');
    }
  }
  return text;
}

json positions(const slam::Trajectory& trajectory) {
  json list = json::array();
  for (const slam::TimedPose& pose : trajectory) {
    const Eigen::Vector3f p = pose.T_wc.translation.cast<float>();
    list.push_back({p.x(), p.y(), p.z()});
  }
  return list;
}

json gallery(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    if (entry.path().extension() == ".jpg") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  json list = json::array();
  for (const auto& file : files) {
    list.push_back({{"name", file.stem().string()}, {"image", base64(nn::read_file(file, "a picture"))}});
  }
  return list;
}

// Frame numbers to places in the trajectory; frames that are not part of the run are left out.
class Rows {
 public:
  Rows(const json& frames, std::size_t poses, const std::string& place) {
    for (const char* key : {"index", "timestamp", "ms", "filter"}) {
      if (!frames.contains(key) || !frames[key].is_array() || frames[key].size() != poses) {
        throw InputError(place,
                         fmt::format("{} of \"{}\", one a pose", counted(poses, "entry", "entries"), key),
                         "something else");
      }
    }
    for (std::size_t i = 0; i < poses; ++i) {
      if (frames["index"][i].is_number_integer()) row_of_[frames["index"][i].get<int>()] = i;
    }
  }
  json of(const json& frame) const {
    if (!frame.is_number_integer()) return nullptr;
    const auto at = row_of_.find(frame.get<int>());
    return at == row_of_.end() ? json(nullptr) : json(at->second);
  }

 private:
  std::map<int, std::size_t> row_of_;
};

json lost_rows(const json& run, const Rows& rows) {
  json list = json::array();
  for (const json& frame : run.value("lost_frames", json::array())) {
    if (const json row = rows.of(frame); !row.is_null()) list.push_back(row);
  }
  return list;
}

json loop_rows(const json& run, const Rows& rows) {
  json list = json::array();
  for (const json& pair : run.value("loops", json::array())) {
    if (!pair.is_array() || pair.size() < 2) continue;
    const json a = rows.of(pair[0]), b = rows.of(pair[1]);
    if (!a.is_null() && !b.is_null()) list.push_back({a, b});
  }
  return list;
}

std::vector<double> times_of(const json& frames) {
  std::vector<double> times;
  for (const json& time : frames["timestamp"])
    times.push_back(time.is_number() ? time.get<double>() : std::numeric_limits<double>::quiet_NaN());
  return times;
}

// Frame by frame how far the estimate, laid over the ground truth, is from it, metres; null where the truth
// is not known or the frame was not located.
json position_errors(const slam::Trajectory& truth, const slam::Trajectory& estimate,
                     const std::vector<double>& times) {
  constexpr double kRounding = 1e-5;  // seconds, of the times in the files
  std::vector<double> truth_times;
  for (const slam::TimedPose& pose : truth) truth_times.push_back(pose.timestamp);
  slam::TrajectoryPair pair;
  std::vector<std::size_t> rows;
  for (const auto& [row, at] : slam::associate_times(times, truth_times, kRounding)) {
    rows.push_back(row);
    pair.reference.push_back(truth[at]);
    pair.estimate.push_back(estimate[row]);
  }
  std::vector<json> errors(estimate.size());
  if (rows.empty()) return errors;
  const slam::Similarity moved = slam::find_alignment(pair.reference, pair.estimate, slam::Alignment::se3);
  const auto distances = slam::absolute_pose_errors(pair.reference, slam::transformed(pair.estimate, moved));
  for (std::size_t i = 0; i < rows.size(); ++i) errors[rows[i]] = distances[i];
  return errors;
}

// As points_json, with the numbers of the classes, a byte each, and their names.
json dense_json(const slam::DenseCloud& cloud, std::size_t most) {
  std::string position, colour, label;
  const std::size_t step = cloud.places.size() / most + 1;
  for (std::size_t i = 0; i < cloud.places.size(); i += step) {
    position.append(reinterpret_cast<const char*>(cloud.places[i].data()), 3 * sizeof(float));
    colour.append(reinterpret_cast<const char*>(cloud.colours[i].data()), 3);
    label.push_back(static_cast<char>(cloud.labels[i]));
  }
  return {{"position", base64(position)},
          {"colour", base64(colour)},
          {"label", base64(label)},
          {"classes", cloud.classes}};
}

// The nodes' places and the links of `penumbra brain`, and the picture of its place cells.
json cognitive_json(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "cognitive_map.json", places = folder / "places.png";
  const json map = read_run_json(path);
  const auto refuse = [&] {
    throw InputError(path.string(), "nodes with x and y, and links with from, to and recalled", "others");
  };
  json nodes = json::array(), links = json::array();
  for (const json& node : map.value("nodes", json::array())) {
    if (!node.is_object() || !node.contains("x") || !node.contains("y")) refuse();
    nodes.push_back({node["x"], node["y"]});
  }
  for (const json& link : map.value("links", json::array())) {
    if (!link.is_object() || !link.contains("from") || !link.contains("to") || !link.contains("recalled"))
      refuse();
    links.push_back({link["from"], link["to"], link["recalled"]});
  }
  json data = {{"nodes", nodes}, {"links", links}};
  if (std::filesystem::exists(places)) data["places"] = base64(nn::read_file(places, "a picture"));
  return data;
}

}  // namespace

nlohmann::json points_json(const std::vector<slam::PlyVertex>& vertices, std::size_t most) {
  std::string position, colour;
  const std::size_t step = vertices.size() / std::max<std::size_t>(1, most) + 1;
  for (std::size_t i = 0; i < vertices.size(); i += step) {
    position.append(reinterpret_cast<const char*>(vertices[i].position.data()), 3 * sizeof(float));
    colour.append(reinterpret_cast<const char*>(vertices[i].colour.data()), 3);
  }
  return {{"position", base64(position)}, {"colour", base64(colour)}};
}

nlohmann::json report_data(const std::filesystem::path& folder, std::size_t most_points) {
  json data;
  data["run"] = read_run_json(folder / "run.json");
  data["frames"] = read_run_json(folder / "frames.json");
  const slam::Trajectory estimate = slam::read_kitti_trajectory(folder / "trajectory_kitti.txt");
  const Rows rows(data["frames"], estimate.size(), (folder / "frames.json").string());
  data["estimate"] = positions(estimate);
  data["truth"] = json::array();
  data["error"] = json::array();
  if (const auto path = folder / "ground_truth_tum.txt"; std::filesystem::exists(path)) {
    const slam::Trajectory truth = slam::read_tum_trajectory(path);
    data["truth"] = positions(truth);
    data["error"] = position_errors(truth, estimate, times_of(data["frames"]));
  }
  data["lost"] = lost_rows(data["run"], rows);
  data["loops"] = loop_rows(data["run"], rows);
  // What lies there of another run of the other program is not of this one.
  const bool is_brain = data["run"].value("system", json()) == "brain";
  const std::filesystem::path map = is_brain ? std::filesystem::path() : folder / "map.ply";
  data["points"] = points_json(
      std::filesystem::exists(map) ? slam::read_ply(map) : std::vector<slam::PlyVertex>{}, most_points);
  if (const auto dense = folder / "dense.ply"; !is_brain && std::filesystem::exists(dense))
    data["dense"] = dense_json(slam::read_dense_ply(dense), kMostDensePoints);
  if (is_brain) data["cognitive"] = cognitive_json(folder);
  data["gallery"] = is_brain ? json::array() : gallery(folder / "gallery");
  return data;
}

}  // namespace penumbra::apps
