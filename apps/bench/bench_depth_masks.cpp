// penumbra bench depth-masks: what --dynamics depth-clusters and static-points take a frame to make masks of
// boxes, step by step.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "apps/bench/benchmark.h"
#include "nn/base/counter_random.h"
#include "slam/dynamics/instance.h"
#include "slam/dynamics/rgbd/dbscan_masks.h"
#include "slam/dynamics/rgbd/depth_repair.h"
#include "slam/dynamics/rgbd/moving_consistency.h"
#include "slam/dynamics/rgbd/object_in_box.h"
#include "slam/frontend/features/frame_features.h"

namespace penumbra::apps {

namespace {

constexpr int kSceneWidth = 640, kSceneHeight = 480;
constexpr double kFocalLength = 525.0;
const std::vector<Rect> kBoxes = {{10, 40, 200, 400}, {220, 40, 200, 400}, {430, 40, 200, 400}};

struct Frame {
  ByteImage image{kSceneWidth, kSceneHeight};
  FloatImage depth{kSceneWidth, kSceneHeight};
};

// Three people before a wall, textured; a quarter of the boxes' pixels lack depth, in spots. `shift`: pixels
// by which the camera has moved on.
Frame make_frame(double shift) {
  constexpr std::uint64_t kTexture = 1, kNoise = 2, kHoles = 3;
  Frame frame;
  for (int y = 0; y < kSceneHeight; ++y) {
    for (int x = 0; x < kSceneWidth; ++x) {
      const auto n = static_cast<std::uint64_t>(y * kSceneWidth + x);
      const double from_middle = std::abs((x - 10) % 210 - 100), noise = counter_uniform(kNoise, n) - 0.5;
      const bool is_person = from_middle < 45.0 + 20.0 * std::sin(y / 40.0) && y > 50;
      const int u = static_cast<int>((x + shift * (is_person ? 2.0 : 1.0)) / 9.0), v = y / 9;
      const double texture = counter_uniform(kTexture, static_cast<std::uint64_t>(v * 1000 + u));
      const bool is_hole = counter_uniform(kHoles, static_cast<std::uint64_t>(y / 20 * 100 + x / 16)) < 0.25;
      frame.image.at(x, y) = static_cast<std::uint8_t>((is_person ? 60 : 120) + 40.0 * texture + 4.0 * noise);
      frame.depth.at(x, y) = is_hole ? 0.0F : static_cast<float>((is_person ? 2.0 : 3.5) + 0.03 * noise);
    }
  }
  return frame;
}

std::vector<slam::Instance> people_in_boxes(const slam::ImageToSegment&) {
  std::vector<slam::Instance> people;
  for (const Rect& box : kBoxes) {
    slam::Instance person;
    person.class_name = "person";
    person.score = 1.0F;
    person.region = box;
    person.mask = ByteImage::filled(box.width, box.height, 255);
    people.push_back(person);
  }
  return people;
}

// Places and depths of as many features as a frame usually has; nothing else of them.
std::shared_ptr<const slam::FrameFeatures> some_features(const Frame& frame) {
  constexpr int kFeatures = 1500;
  constexpr std::uint64_t kPlaces = 4;
  auto features = std::make_shared<slam::FrameFeatures>();
  for (std::uint64_t n = 0; n < kFeatures; ++n) {
    const int x = static_cast<int>(kSceneWidth * counter_uniform(kPlaces, 2 * n));
    const int y = static_cast<int>(kSceneHeight * counter_uniform(kPlaces, 2 * n + 1));
    features->left.keypoints.push_back({static_cast<float>(x), static_cast<float>(y), 0, 0.0F, 1.0F});
    features->depth.push_back(frame.depth.at(x, y));
  }
  features->left.descriptors.resize(kFeatures);
  return features;
}

struct Step {
  const char* name;
  std::function<void()> run;
};

std::vector<Step> steps(const Frame& frame, const Frame& next) {
  std::vector<Step> all;
  for (const auto& [name, mode] : {std::pair("repair, paper", slam::RepairMode::paper),
                                   std::pair("repair, border", slam::RepairMode::border),
                                   std::pair("repair, median", slam::RepairMode::median),
                                   std::pair("repair, modes", slam::RepairMode::modes)}) {
    slam::DepthRepairSettings settings;
    settings.mode = mode;
    const auto repair = std::make_shared<slam::DepthRepair>(settings);
    const auto depth = std::make_shared<FloatImage>(frame.depth.clone());
    all.push_back({name, [repair, depth, &frame] {
                     std::copy_n(frame.depth.data(), frame.depth.elements(), depth->data());
                     for (const Rect& box : kBoxes) repair->apply(frame.image, box, *depth);
                   }});
  }
  const auto repaired = std::make_shared<FloatImage>(frame.depth.clone());
  slam::DepthRepair repair;
  for (const Rect& box : kBoxes) repair.apply(frame.image, box, *repaired);
  for (const auto& [name, mode, k] : {std::tuple("clusters, paper", slam::ClusterMode::paper, 3),
                                      std::tuple("clusters, grown", slam::ClusterMode::grown, 8)}) {
    slam::ObjectInBoxSettings settings;
    settings.mode = mode;
    settings.clusters = k;
    const auto finder = std::make_shared<slam::ObjectInBox>(kFocalLength, settings);
    const auto mask = std::make_shared<slam::ObjectMask>();
    all.push_back({name, [finder, mask, repaired, &frame] {
                     for (const Rect& box : kBoxes) finder->find(frame.image, *repaired, box, {}, *mask);
                   }});
  }
  // Beside the detector, whose boxes are known here.
  slam::ImageToSegment to_segment{0, frame.image, frame.depth, some_features(frame)};
  for (const auto& [name, mode] : {std::pair("DBSCAN, paper", slam::ForegroundMode::paper),
                                   std::pair("DBSCAN, adaptive", slam::ForegroundMode::adaptive)}) {
    slam::ForegroundSettings settings;
    settings.mode = mode;
    const slam::Segmenter masks = slam::masks_by_dbscan(people_in_boxes, 0.5, settings);
    all.push_back({name, [masks, to_segment] { masks(to_segment); }});
  }
  const auto consistency = std::make_shared<slam::MovingConsistency>(slam::ConsistencySettings{});
  const std::vector<slam::Instance> people = people_in_boxes({});
  const auto number = std::make_shared<int>(0);
  all.push_back({"moving consistency", [consistency, people, number, &frame, &next] {
                   consistency->check(*number, *number % 2 == 0 ? frame.image : next.image, people);
                   ++*number;
                 }});
  return all;
}

void bench_depth_masks(const BenchmarkOptions& options) {
  const Frame frame = make_frame(0.0), next = make_frame(3.0);
  nlohmann::ordered_json result{
      {"width", kSceneWidth}, {"height", kSceneHeight}, {"steps", nlohmann::ordered_json::array()}};
  if (!options.json) {
    fmt::print("{} x {} pixels, three boxes of 200 x 400, a quarter of them without depth; one thread\n",
               kSceneWidth, kSceneHeight);
    fmt::print("{:<24} {:>8} {:>7}\n", "step", "ms", "spread");
  }
  for (const Step& step : steps(frame, next)) {
    const Timing timing = time_repeats(options, step.run);
    result["steps"].push_back({{"name", step.name}, {"seconds", timing.median}, {"spread", timing.spread()}});
    if (options.json) continue;
    fmt::print("{:<24} {:>8.3f} {:>6.0f}%\n", step.name, timing.median * 1e3, timing.spread() * 100);
  }
  if (options.json) fmt::print("{}\n", result.dump(1));
}

}  // namespace

void add_depth_masks_benchmark(CLI::App& bench) {
  auto options = std::make_shared<BenchmarkOptions>();
  options->repeats = 41;
  CLI::App* command = bench.add_subcommand(
      "depth-masks",
      "Masks from boxes and depth: repair, clusters, DBSCAN, moving consistency, on one thread");
  add_benchmark_options(command, *options);
  command->footer(
      "Examples:\n"
      "  penumbra bench depth-masks\n"
      "  penumbra bench depth-masks --repeats 5 --json");
  command->callback([options] { bench_depth_masks(*options); });
}

}  // namespace penumbra::apps
