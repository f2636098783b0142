// The landmarks that the weights that come along find on rendered streets.
#include "apps/brain/landmark_finder.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/base/stopwatch.h"
#include "nn/io/safetensors.h"
#include "slam/world/landmark_images.h"
#include "slam/world/street_sequence.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/expect_error.h"
#include "tests/support/random_models.h"
#include "tests/support/test_data.h"

namespace penumbra::test {
namespace {

namespace brain = slam::brain;
namespace synthetic = slam::synthetic;

std::filesystem::path weights() { return source_path("weights_tools/models/penumbra-interest.safetensors"); }

// A street of a seed that the weights were not trained on.
class Street {
 public:
  explicit Street(std::uint32_t seed, const synthetic::StreetSettings& settings = {})
      : sequence_({.street = settings, .path = "block", .seed = seed, .colour = true, .landmarks = true}),
        things_(sequence_.world()),
        list_(nlohmann::json::parse(things_.list())) {}

  void render(int frame) {
    sequence_.render(frame, frame_);
    numbers_ = synthetic::landmark_image(things_, frame_.left);
  }
  const ByteImage& image() const { return frame_.left_bgr; }
  // Share of the pixels in the box that show persons or vehicles.
  double movers_in(const brain::Landmark& landmark) const {
    int movers = 0, all = 0;
    for (int y = static_cast<int>(landmark.y0); y < static_cast<int>(landmark.y1); ++y) {
      for (int x = static_cast<int>(landmark.x0); x < static_cast<int>(landmark.x1); ++x, ++all) {
        const int number = numbers_.at(x, y);
        if (number == 0) continue;
        const std::string name = list_.at(std::to_string(number)).at("class");
        movers += name == "person" || name == "vehicle" ? 1 : 0;
      }
    }
    return static_cast<double>(movers) / std::max(all, 1);
  }

 private:
  synthetic::StreetSequence sequence_;
  synthetic::ThingNumbers things_;
  nlohmann::json list_;
  synthetic::SequenceFrame frame_;
  WordImage numbers_;
};

TEST(LandmarkFinder, FindsThingsThatStandAndFewThatMove) {
  Street street(900, synthetic::street_preset("crowded"));
  apps::ImageLandmarks find(weights());
  brain::Landmarks found;
  int all = 0, on_movers = 0;
  for (const int frame : {0, 10, 20, 30, 40, 50}) {
    street.render(frame);
    find(street.image(), found);
    EXPECT_GE(found.size(), 5U) << frame;
    for (const brain::Landmark& landmark : found) {
      EXPECT_TRUE(brain::stands(landmark.landmark_class));
      EXPECT_GT(landmark.interest, 0.0F);
      EXPECT_LE(landmark.interest, landmark.score);
      EXPECT_LE(landmark.score, 1.0F);
      ++all;
      on_movers += street.movers_in(landmark) > 0.5 ? 1 : 0;
    }
    for (std::size_t i = 1; i < found.size(); ++i)
      EXPECT_GE(found[i - 1].interest, found[i].interest) << "the most interesting one comes first";
  }
  RecordProperty("on_movers", fmt::format("{} of {}", on_movers, all));
  EXPECT_LE(on_movers, all / 20);
}

TEST(LandmarkFinder, AllocatesNothingFromTheSecondImageOn) {
  Street street(901);
  apps::ImageLandmarks find(weights());
  brain::Landmarks found;
  find(ByteImage::filled(620, 188, 90, 3), found);
  street.render(5);
  const std::size_t before = allocation_count();
  find(street.image(), found);
  EXPECT_EQ(allocation_count(), before);
  EXPECT_FALSE(found.empty());
}

TEST(LandmarkFinder, RepeatsBitForBitOnAnyNumberOfThreadsAndInTime) {
  Street street(902);
  street.render(7);
  apps::ImageLandmarks find(weights());
  const int threads = thread_count();
  brain::Landmarks first, again;
  find(street.image(), first);
  for (const int count : {1, 2}) {
    set_thread_count(count);
    find(street.image(), again);
    ASSERT_EQ(again.size(), first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
      EXPECT_EQ(again[i].interest, first[i].interest);
      EXPECT_EQ(again[i].descriptor, first[i].descriptor);
    }
  }
  std::vector<double> times;
  for (int run = 0; run < 21; ++run) {
    const Stopwatch watch;
    find(street.image(), again);
    times.push_back(watch.milliseconds());
  }
  set_thread_count(threads);
  std::nth_element(times.begin(), times.begin() + 10, times.end());
  RecordProperty("ms", fmt::format("{:.2f}", times[10]));
  EXPECT_LE(std::filesystem::file_size(weights()), 4'000'000U);
}

TEST(LandmarkFinder, IsWhatTheBrainAsksFor) {
  Street street(903);
  street.render(3);
  slam::StereoImages images;
  images.left = street.image().clone();
  brain::Landmarks from_frame, from_image;
  apps::make_landmark_finder(weights())(images, from_frame);
  apps::ImageLandmarks{weights()}(images.left, from_image);
  ASSERT_EQ(from_frame.size(), from_image.size());
  ASSERT_FALSE(from_frame.empty());
  EXPECT_EQ(from_frame[0].descriptor, from_image[0].descriptor);
}

TEST(LandmarkFinder, RefusesOtherNetworks) {
  const TemporaryDirectory folder;
  EXPECT_THROW(apps::ImageLandmarks(folder / "none.safetensors"), Error);
  EXPECT_THROW(apps::ImageLandmarks(source_path("weights_tools/models/penumbra-tiny.safetensors")),
               InputError);
  nn::write_safetensors(folder / "small.safetensors", random_interest({.classes = 9}));
  expect_error<InputError>([&] { const apps::ImageLandmarks find(folder / "small.safetensors"); },
                           {"11 classes", "found 9"});
}

}  // namespace
}  // namespace penumbra::test
