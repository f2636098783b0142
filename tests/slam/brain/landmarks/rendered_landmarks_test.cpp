// Landmarks of rendered streets as a network without errors would find them: its cells come from the numbers
// of the things that each pixel shows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "nn/base/counter_random.h"
#include "slam/brain/landmarks/salient_regions.h"
#include "slam/world/landmark_images.h"
#include "slam/world/street_sequence.h"

namespace penumbra::slam::brain {
namespace {

constexpr int kCellSize = 8;

class PerfectCells {
 public:
  explicit PerfectCells(const std::string& list) : things_(nlohmann::json::parse(list)) {}

  const ImageCells& operator()(const WordImage& numbers) {
    cells_.width = numbers.width() / kCellSize;
    cells_.height = numbers.height() / kCellSize;
    cells_.size = kCellSize;
    cells_.image_width = numbers.width();
    cells_.image_height = numbers.height();
    probabilities_.clear();
    embeddings_.clear();
    for (int y = 0; y < cells_.height; ++y) {
      for (int x = 0; x < cells_.width; ++x) add(shown_at(numbers, x, y));
    }
    cells_.probabilities = probabilities_;
    cells_.embeddings = embeddings_;
    return cells_;
  }
  int class_of(int number) const {
    if (number == 0) return kNothing;
    const std::string name = things_.at(std::to_string(number)).at("class");
    for (int c = 0; c < kLandmarkClasses; ++c) {
      if (name == name_of(static_cast<LandmarkClass>(c))) return c;
    }
    return kNothing;
  }

 private:
  // Lamps and signs are thin: they take a cell of which they fill a quarter.
  int shown_at(const WordImage& numbers, int x, int y) const {
    std::map<int, int> votes;
    for (int v = 0; v < kCellSize; ++v) {
      for (int u = 0; u < kCellSize; ++u) {
        const int number = numbers.at(kCellSize * x + u, kCellSize * y + v), c = class_of(number);
        votes[number] += c == kLamp || c == kSign ? 3 : 1;
      }
    }
    return std::max_element(votes.begin(), votes.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
  }
  void add(int number) {
    for (int c = 0; c < kLandmarkClasses; ++c) probabilities_.push_back(c == class_of(number) ? 0.9F : 0.01F);
    float squares = 0.0F;
    for (std::size_t k = 0; k < kDescriptorSize; ++k) {
      embeddings_.push_back(static_cast<float>(counter_uniform(static_cast<std::uint64_t>(number), k)) -
                            0.5F);
      squares += embeddings_.back() * embeddings_.back();
    }
    for (auto e = embeddings_.end() - kDescriptorSize; e != embeddings_.end(); ++e) *e /= std::sqrt(squares);
  }

  nlohmann::json things_;
  ImageCells cells_;
  std::vector<float> probabilities_, embeddings_;
};

struct ByClass {
  int regions = 0;
  float interest = 0.0F;  // the largest
};

std::map<int, ByClass> by_class(const Landmarks& landmarks) {
  std::map<int, ByClass> found;
  for (const Landmark& landmark : landmarks) {
    ByClass& one = found[landmark.landmark_class];
    ++one.regions;
    one.interest = std::max(one.interest, landmark.interest);
  }
  return found;
}

TEST(RenderedLandmarks, ALampOfARowCountsLittleAndARareSignMuch) {
  synthetic::StreetSettings settings;
  settings.lamps_per_100m = 25.0F;
  synthetic::StreetSequence street(
      {.street = settings, .path = "straight", .frames = 60, .seed = 900, .landmarks = true});
  const synthetic::ThingNumbers things(street.world());
  PerfectCells cells(things.list());
  synthetic::SequenceFrame frame;
  Landmarks found;
  int with_both = 0;
  for (int i = 0; i < street.size(); i += 6) {
    street.render(i, frame);
    SalientRegions{}(cells(synthetic::landmark_image(things, frame.left)), found);
    for (const Landmark& landmark : found) EXPECT_TRUE(stands(landmark.landmark_class));
    std::map<int, ByClass> classes = by_class(found);
    const ByClass lamp = classes[kLamp], sign = classes[kSign];
    if (sign.regions != 1 || lamp.regions < 3) continue;
    ++with_both;
    EXPECT_NEAR(sign.interest, 0.9F, 1e-5F);
    EXPECT_LE(lamp.interest, 0.9F / std::sqrt(3.0F) + 1e-5F);
  }
  EXPECT_GE(with_both, 1);
}

// Cars fill a third of these images; no landmark is one of them.
TEST(RenderedLandmarks, CarsAndPersonsAreNone) {
  synthetic::StreetSequence street({.street = synthetic::street_preset("crowded"),
                                    .path = "straight",
                                    .frames = 30,
                                    .seed = 900,
                                    .landmarks = true});
  const synthetic::ThingNumbers things(street.world());
  PerfectCells cells(things.list());
  synthetic::SequenceFrame frame;
  Landmarks found;
  for (int i = 0; i < street.size(); i += 10) {
    street.render(i, frame);
    const WordImage numbers = synthetic::landmark_image(things, frame.left);
    SalientRegions regions;
    regions(cells(numbers), found);
    EXPECT_GE(found.size(), 3U);
    int movers = 0;
    for (int y = 0; y < numbers.height(); ++y) {
      for (int x = 0; x < numbers.width(); ++x) {
        const int c = cells.class_of(numbers.at(x, y));
        movers += c == kPerson || c == kVehicle ? 1 : 0;
      }
    }
    EXPECT_GT(movers, 1000);
    for (const Landmark& landmark : found) EXPECT_TRUE(stands(landmark.landmark_class));
  }
}

}  // namespace
}  // namespace penumbra::slam::brain
