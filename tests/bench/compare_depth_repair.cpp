// Our repair of depth beside filters of OpenCV, as the paper compares its own, in people's boxes of an office
// whose true depth is known:
//
//   compare_depth_repair OFFICE... [STEP]
//
// OFFICE is a folder of `penumbra synth --scene office`; every STEP-th frame is taken (10). A filter fills a
// hole with what it makes of it. The median takes no account of holes around, the bilateral filter leaves
// them out by dividing by the same filter's result of where depth is known. Not part of the tests:
// `ninja compare_depth_repair` builds it.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "apps/common/made_truth.h"
#include "apps/slam/segmenter.h"
#include "nn/image/grey.h"
#include "slam/dynamics/rgbd/depth_repair.h"
#include "slam/evaluation/depth_mask_evaluation.h"
#include "slam/sources/open_dataset.h"
#include "tests/support/cv_images.h"

namespace penumbra {
namespace {

constexpr float kLeastDepth = 0.1F;  // metres: less is what a filter leaves of a hole

// Holes that became a depth; the others keep theirs.
FloatImage filled_by(const FloatImage& depth, const cv::Mat& filtered) {
  FloatImage result = depth.clone();
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      const float z = filtered.at<float>(y, x);
      if (!(depth.at(x, y) > 0.0F) && z > kLeastDepth) result.at(x, y) = z;
    }
  }
  return result;
}

FloatImage by_median(const FloatImage& depth, int repeats) {
  cv::Mat filtered = test::to_mat(depth);
  for (int i = 0; i < repeats; ++i) {
    cv::Mat next;
    cv::medianBlur(filtered, next, 5);
    next.copyTo(filtered, filtered <= 0.0F);
  }
  return filled_by(depth, filtered);
}

FloatImage by_bilateral(const FloatImage& depth) {
  constexpr int kDiameter = 15;
  constexpr double kMetres = 10.0, kPixels = 5.0;  // so wide a range that a hole takes part in any depth
  const cv::Mat metres = test::to_mat(depth);
  cv::Mat known, sum, weight;
  cv::Mat(metres > 0.0F).convertTo(known, CV_32F, 1.0 / 255.0);
  cv::bilateralFilter(metres, sum, kDiameter, kMetres, kPixels);
  cv::bilateralFilter(known, weight, kDiameter, kMetres, kPixels);
  cv::Mat filtered = sum / cv::max(weight, 0.05);
  filtered.setTo(0.0F, weight < 0.05);
  return filled_by(depth, filtered);
}

struct Way {
  std::string name;
  std::function<FloatImage(const ByteImage&, const FloatImage&, const Rect&)> repair;
  slam::RepairCount count;
};

std::vector<Way> ways() {
  std::vector<Way> all;
  const auto ours = [&](std::string name, slam::RepairMode mode, int farthest) {
    all.push_back({std::move(name),
                   [mode, farthest](const ByteImage& grey, const FloatImage& raw, const Rect& box) {
                     slam::DepthRepairSettings settings;
                     settings.mode = mode;
                     settings.farthest = farthest;
                     FloatImage depth = raw.clone();
                     slam::DepthRepair(settings).apply(grey, box, depth);
                     return depth;
                   },
                   {}});
  };
  constexpr int kEverywhere = 10000;  // pixels
  ours("paper", slam::RepairMode::paper, kEverywhere);
  ours("border", slam::RepairMode::border, kEverywhere);
  ours("median by cells", slam::RepairMode::median, slam::DepthRepairSettings{}.farthest);
  ours("modes, however far", slam::RepairMode::modes, kEverywhere);
  ours("modes", slam::RepairMode::modes, slam::DepthRepairSettings{}.farthest);
  for (const int repeats : {1, 8}) {
    all.push_back(
        {fmt::format("cv::medianBlur 5 x 5, {} times", repeats),
         [repeats](const ByteImage&, const FloatImage& raw, const Rect&) { return by_median(raw, repeats); },
         {}});
  }
  all.push_back({"cv::bilateralFilter, 15 pixels",
                 [](const ByteImage&, const FloatImage& raw, const Rect&) { return by_bilateral(raw); },
                 {}});
  return all;
}

void count_frames(const std::filesystem::path& folder, int step, std::vector<Way>& all) {
  slam::DatasetOptions from;
  from.step = step;
  const auto dataset = slam::open_dataset(folder, from);
  const slam::Segmenter truths = apps::make_mask_reader(folder / "instances");
  const apps::TrueDepths clean(folder, folder / "depth_clean");
  for (int i = 0; i < dataset->size(); ++i) {
    const slam::StereoImages images = dataset->load(i);
    const ByteImage grey = to_grey(images.left);
    const FloatImage truth = clean.load(images.index, images.left.size());
    for (const slam::Instance& person : truths({images.index, images.left, images.depth})) {
      if (person.class_name != "person" || person.region.area() < 300) continue;
      for (Way& way : all)
        slam::count_repair(person, images.depth, way.repair(grey, images.depth, person.region), truth,
                           way.count);
    }
  }
}

int run(const std::vector<std::string>& arguments) {
  int step = 10;
  std::vector<Way> all = ways();
  for (const std::string& argument : arguments) {
    if (const int number = std::atoi(argument.c_str()); number > 0) step = number;
  }
  for (const std::string& argument : arguments) {
    if (std::filesystem::is_directory(argument)) count_frames(argument, step, all);
  }
  fmt::print(
      "| repair | holes on people filled % | RMSE of those m | holes of the background filled wrongly % |\n"
      "|---|---|---|---|\n");
  for (const Way& way : all) {
    fmt::print("| {} | {:.1f} | {:.3f} | {:.1f} |\n", way.name, 100.0 * way.count.filled_share(),
               way.count.rmse(), 100.0 * way.count.wrong_share());
  }
  return 0;
}

}  // namespace
}  // namespace penumbra

int main(int count, char** values) { return penumbra::run({values + 1, values + count}); }
