#include "slam/pipeline/recorder.h"

#include <gtest/gtest.h>

namespace penumbra::slam {
namespace {

const StereoCamera kRecordedCamera = {
    .fx = 160.0, .fy = 160.0, .cx = 79.5, .cy = 59.5, .baseline = 0.08, .width = 160, .height = 120};

FrameResult recorded_frame(int index, bool keyframe) {
  FrameResult result;
  result.index = index;
  result.keyframe = keyframe;
  return result;
}

// Somebody whose left half is masked, and one of a single column.
std::vector<Instance> two_people() {
  ByteImage mask = ByteImage::filled(20, 40, 0);
  for (int v = 0; v < 40; ++v) std::fill_n(mask.row(v), 10, std::uint8_t{255});
  return {{.class_name = "person", .region = {30, 20, 20, 40}, .mask = mask},
          {.class_name = "person", .region = {60, 20, 1, 9}, .mask = ByteImage::filled(1, 9, 255)},
          {.class_name = "chair", .region = {70, 20, 10, 10}, .mask = {}}};
}

// Of more frames than it has in memory.
TEST(Recorder, GivesBackFramesAndTheirHistograms) {
  constexpr int kFrames = 3000;
  Slam slam(kRecordedCamera, Sensor::rgbd, {});
  Recorder record(slam);
  for (int i = 0; i < kFrames; ++i) {
    FrameResult result = recorded_frame(2 * i, i % 7 == 0);
    result.timestamp = 0.1 * i;
    result.features = i % 900;
    result.tracking.state = i % 5 == 0 ? TrackingState::lost : TrackingState::tracking;
    result.tracking.map_inliers = i + 1;
    result.place.T_c_reference.translation = {1.0 * i, 0.0, -1.0};
    result.place.T_c_reference.rotation = so3_exp({0.0, 0.001 * i, 0.0});
    for (int b = 0; b < i % 4; ++b)
      result.tracking.filter.bins.push_back({0.5 + 2.0 * b, 2.5 + 2.0 * b, i + b, b});
    EXPECT_EQ(record.add(result).index, 2 * i);
  }
  ASSERT_EQ(record.frames().size(), static_cast<std::size_t>(kFrames));
  EXPECT_GT(record.frames().bytes_on_disk(), kFrames * sizeof(KeptFrame) / 2);
  EXPECT_EQ(record.lost(), kFrames / 5);
  int i = 0;
  for (const KeptFrame& frame : record.frames()) {
    ASSERT_EQ(frame.index, 2 * i);
    ASSERT_EQ(frame.timestamp, 0.1 * i);
    ASSERT_EQ(frame.features, i % 900);
    ASSERT_EQ(frame.keyframe, i % 7 == 0);
    ASSERT_EQ(frame.is_located(), i % 5 != 0);
    ASSERT_EQ(frame.map_inliers, i + 1);
    ASSERT_EQ(frame.place().T_c_reference.translation.x(), 1.0 * i);
    ASSERT_EQ(frame.place().T_c_reference.rotation, so3_exp({0.0, 0.001 * i, 0.0}));
    const std::vector<FilterBar> bars = record.bars(frame);
    ASSERT_EQ(bars.size(), static_cast<std::size_t>(i % 4));
    for (int b = 0; b < i % 4; ++b) {
      ASSERT_EQ(bars[static_cast<std::size_t>(b)].kept, i + b);
      ASSERT_EQ(bars[static_cast<std::size_t>(b)].removed, b);
    }
    if (!bars.empty()) {
      ASSERT_EQ(frame.bar_from, 0.5);
      ASSERT_EQ(frame.bar_width, 2.0);
    }
    ++i;
  }
  EXPECT_EQ(i, kFrames);
}

TEST(Recorder, KeepsMasksAtHalfTheSize) {
  Slam slam(kRecordedCamera, Sensor::rgbd, {});
  Recorder record(slam);
  record.keep_masks_of(0);
  record.keep_masks_of(2);
  record.add(recorded_frame(0, true));
  record.add(recorded_frame(1, false));
  FrameResult later =
      recorded_frame(2, true);  // the segmenter was late with two frames, and saw nothing in the third
  later.findings.segmented = {{0, two_people()}, {1, two_people()}, {2, {}}};
  record.add(std::move(later));
  ASSERT_EQ(record.masks().size(), 2U);
  ASSERT_TRUE(record.masks().contains(0));
  EXPECT_TRUE(record.masks().at(2).empty());
  const std::vector<Instance>& kept = record.masks().at(0);
  ASSERT_EQ(kept.size(), 3U);
  EXPECT_EQ(kept[0].class_name, "person");
  EXPECT_EQ(kept[0].region, (Rect{30, 20, 20, 40}));  // of the image, as it was
  ASSERT_EQ(kept[0].mask.size(), (Size{10, 20}));
  for (int v = 0; v < 20; ++v) {
    for (int u = 0; u < 10; ++u) EXPECT_EQ(kept[0].mask.at(u, v), u < 5 ? 255 : 0);
  }
  EXPECT_EQ(kept[1].mask.size(), (Size{1, 4}));
  EXPECT_TRUE(kept[2].mask.empty());
}

TEST(Recorder, KnowsHowLateMasksCame) {
  Slam slam(kRecordedCamera, Sensor::rgbd, {});
  Recorder record(slam);
  for (int frame = 0; frame < 4; ++frame) {
    FrameResult result = recorded_frame(10 + frame, false);
    result.timestamp = 100.0 + 0.5 * frame;
    if (frame == 1) result.findings.segmented = {{10, {}}};
    if (frame == 3) result.findings.segmented = {{11, {}}, {7, {}}};  // 7: not a frame of this run
    record.add(std::move(result));
  }
  EXPECT_EQ(record.mask_delays().values(), (std::vector<double>{0.5, 1.0}));
}

TEST(Recorder, KeepsNoMasksUnlessAsked) {
  Slam slam(kRecordedCamera, Sensor::rgbd, {});
  Recorder record(slam);
  FrameResult result = recorded_frame(0, true);
  result.findings.segmented = {{0, two_people()}};
  EXPECT_TRUE(record.add(std::move(result)).findings.segmented.empty());
  EXPECT_TRUE(record.masks().empty());
}

}  // namespace
}  // namespace penumbra::slam
