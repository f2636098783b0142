// penumbra merge: one map of those that several recordings have left.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/compute_options.h"
#include "apps/common/log.h"
#include "apps/common/progress_bar.h"
#include "apps/slam/slam_results.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "slam/backend/map_merger.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/map/map_file.h"
#include "slam/map/ply.h"

namespace penumbra::apps {

namespace {

namespace fs = std::filesystem;

struct MergeOptions {
  std::vector<std::string> maps;
  std::string output, out;
};

std::vector<std::unique_ptr<slam::Map>> read_maps(const std::vector<std::string>& files) {
  std::vector<std::unique_ptr<slam::Map>> maps;
  for (const std::string& file : files) {
    maps.push_back(slam::read_map(file));
    slam::require_same_camera(maps.back()->camera(), maps.front()->camera(), file);
    if (maps.back()->scales() != maps.front()->scales())
      throw InputError(file, fmt::format("a map with the pyramid of {}", files.front()), "another");
  }
  return maps;
}

void print_parts(const MergeOptions& options, const slam::MergedMaps& merged) {
  for (const slam::MergedPart& part : merged.parts) {
    const Eigen::Vector3d& t = part.T_merged_own.translation;
    fmt::print("{}: {}, piece {}, {} to other maps, its origin at ({:.2f}, {:.2f}, {:.2f})\n",
               options.maps[part.source], counted(part.keyframes, "keyframe"), part.piece,
               counted(part.ties, "tie"), t.x(), t.y(), t.z());
  }
  if (merged.pieces > 1) {
    log_warning("{} pieces share nothing that was recognised: each keeps its own origin and orientation",
                merged.pieces);
  }
}

bool hold_the_same(const std::string& a, const std::string& b) {
  std::ifstream first(a, std::ios::binary), second(b, std::ios::binary);
  using Bytes = std::istreambuf_iterator<char>;
  return first && second && std::equal(Bytes(first), Bytes(), Bytes(second), Bytes());
}

// A map beside itself is no second recording: each of its places would be proven by itself.
void require_different(const MergeOptions& options) {
  std::error_code none;
  for (std::size_t i = 0; i < options.maps.size(); ++i) {
    const std::string& file = options.maps[i];
    if (fs::equivalent(file, options.output, none))
      throw UsageError(fmt::format("merge: {} is one of the maps and would be overwritten", options.output));
    const auto bytes = fs::file_size(file, none);
    for (std::size_t j = 0; j < i && !none; ++j) {
      const std::string& before = options.maps[j];
      if (fs::equivalent(before, file, none))
        throw UsageError(fmt::format("merge: {} and {} are the same file", before, file));
      if (fs::file_size(before, none) == bytes && hold_the_same(before, file))
        throw UsageError(fmt::format("merge: {} and {} are the same map", before, file));
    }
  }
}

void merge(const MergeOptions& options) {
  if (options.maps.size() < 2) throw UsageError("merge: expected at least two maps");
  require_different(options);
  const std::vector<std::unique_ptr<slam::Map>> maps = read_maps(options.maps);
  prepare_places({options.out, options.output});
  slam::MapMergerSettings settings;
  settings.adjustment.threads = thread_count();
  int keyframes = 0;
  for (const auto& map : maps) keyframes += static_cast<int>(map->keyframes().size());
  ProgressBar progress("Merging", keyframes, "keyframes");
  const slam::MergedMaps merged =
      slam::merge_maps(maps, settings, [&](int done, int) { progress.update(done); });
  slam::write_map(options.output, *merged.map);
  if (!options.out.empty()) {
    slam::write_ply(fs::path(options.out) / "map.ply", slam::point_cloud_of(*merged.map));
    slam::Trajectory poses;
    for (const slam::KeyFrame* keyframe : merged.map->keyframes())
      poses.push_back({keyframe->timestamp, keyframe->T_cw.inverse()});
    slam::write_tum_trajectory(fs::path(options.out) / "keyframes_tum.txt", poses);
  }
  print_parts(options, merged);
  fmt::print("{}: {}, {}, {}\n", options.output, counted(merged.map->keyframes().size(), "keyframe"),
             counted(merged.map->points().size(), "point"), counted(merged.pieces, "piece"));
}

}  // namespace

void add_merge_command(CLI::App& app) {
  auto options = std::make_shared<MergeOptions>();
  CLI::App* command = app.add_subcommand("merge", "Make one map of those of several recordings");
  command->add_option("maps", options->maps, "maps of one camera, as `slam --save-map` writes them")
      ->required();
  command->add_option("-o,--output", options->output, "the map to write")->required();
  command->add_option("--out", options->out, "folder for map.ply and keyframes_tum.txt of the merged map");
  add_threads_option(command);
  command->footer(
      "Maps are tied where several keyframes of one are proven to show one place of another; what shares "
      "nothing\n"
      "stays a piece of its own. The order of the arguments does not change the result. "
      "docs/slam/map-file.md.\n\n"
      "Examples:\n"
      "  penumbra merge monday.map tuesday.map -o yard.map\n"
      "  penumbra merge night/*.map -o yard.map --out out/yard\n"
      "  penumbra slam wednesday --load-map yard.map --localise --out out/wednesday\n");
  command->callback([options] { merge(*options); });
}

}  // namespace penumbra::apps
