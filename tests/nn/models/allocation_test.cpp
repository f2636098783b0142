// From the second image of a shape on, a network allocates nothing: operator new is counted.
#include <gtest/gtest.h>

#include "nn/models/classifier.h"
#include "nn/models/interest_network.h"
#include "nn/models/mask_rcnn.h"
#include "nn/models/yolov5.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/random_models.h"
#include "tests/support/random_network.h"
#include "tests/support/repeatability.h"

namespace penumbra::nn {
namespace {

TEST(Allocations, AreCounted) {
  const std::size_t before = test::allocation_count();
  { const std::vector<int> vector(3); }
  Arena arena;
  { const ArenaBuffer buffer = arena.allocate(3); }
  EXPECT_EQ(test::allocation_count(), before + 2);
}

// Masks as large as the image, so that the results need no more memory whatever is found.
std::vector<Detection> room_for_results(const InstanceSegmenter& network, const ByteImage& image) {
  std::vector<Detection> detections(network.has_masks() ? 100 : 0);
  for (Detection& detection : detections)
    detection.mask.bits.resize(image.size().width * image.size().height);
  return detections;
}

void expect_no_allocations(const InstanceSegmenter& network) {
  const ByteImage first = test::random_image(4, 90, 70), second = test::random_image(5, 90, 70);
  Arena arena;
  std::vector<Detection> found = room_for_results(network, first);
  network.detect(first, arena, found);
  const std::vector<Detection> expected = found;
  ASSERT_FALSE(expected.empty());
  const std::size_t bytes = arena.bytes();

  // The same image into the same results: not one allocation.
  std::size_t before = test::allocation_count();
  network.detect(first, arena, found);
  EXPECT_EQ(test::allocation_count(), before);
  test::expect_same_bits(found, expected);

  // Another picture with other detections: none but the results'.
  std::vector<Detection> others = room_for_results(network, second);
  before = test::allocation_count();
  network.detect(second, arena, others);
  EXPECT_EQ(test::allocation_count(), before);
  // A blank one, in which little or nothing is found.
  const ByteImage blank = ByteImage::filled(first.width(), first.height(), 0, 3);
  before = test::allocation_count();
  network.detect(blank, arena, others);
  EXPECT_EQ(test::allocation_count(), before);

  EXPECT_EQ(arena.recordings(), 1U);
  EXPECT_EQ(arena.bytes(), bytes);
  EXPECT_EQ(arena.peak_bytes(), bytes);
}

MaskRcnnConfig small_images() {
  MaskRcnnConfig config;
  config.transform.min_size = 64;
  config.transform.max_size = 128;
  return config;
}

TEST(Allocations, MaskRcnnMakesNoneFromTheSecondImageOn) {
  expect_no_allocations(MaskRcnn(test::random_mask_rcnn(false), small_images()));
}

TEST(Allocations, MaskRcnnWithMixedAttentionMakesNoneFromTheSecondImageOn) {
  expect_no_allocations(MaskRcnn(test::random_mask_rcnn(true), small_images()));
}

TEST(Allocations, Yolov5AndAfnetWithMasksMakeNoneFromTheSecondImageOn) {
  Yolov5Config config;
  config.letterbox.size = 192;
  expect_no_allocations(Yolov5(test::random_yolov5({0.125, 1.0 / 3.0, 4, true, false}), config));
  expect_no_allocations(Yolov5(test::random_yolov5({0.125, 1.0 / 3.0, 4, true, false, true, true}), config));
  config.max_candidates = 50;  // fewer than pass the threshold
  expect_no_allocations(Yolov5(test::random_yolov5({0.125, 1.0 / 3.0, 4, true, false}), config));
}

TEST(Allocations, ClassifierMakesNoneFromTheSecondImageOn) {
  const Classifier network(test::random_resnet(50, 8));
  Arena arena;
  std::vector<float> logits;
  const ByteImage image = test::random_image(4, 90, 70);
  const ByteImage blank = ByteImage::filled(image.width(), image.height(), 0, 3);
  network(image, arena, logits);
  const std::vector<float> expected = logits;
  const std::size_t before = test::allocation_count();
  network(image, arena, logits);
  network(blank, arena, logits);
  network(image, arena, logits);
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_EQ(logits, expected);
}

TEST(Allocations, InterestNetworkMakesNoneFromTheSecondImageOn) {
  const InterestNetwork network(test::random_interest());
  Arena arena;
  InterestMap map;
  const ByteImage image = test::random_image(4, 90, 70), other = test::random_image(5, 90, 70);
  network(image, arena, map);
  const std::vector<float> expected = map.embeddings;
  const std::size_t before = test::allocation_count();
  network(other, arena, map);
  network(image, arena, map);
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_EQ(map.embeddings, expected);
}

}  // namespace
}  // namespace penumbra::nn
