// Whether a network's results depend on anything but its image.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "nn/base/parallel.h"
#include "nn/models/instance_segmenter.h"

namespace penumbra::test {

inline void expect_same_bits(const std::vector<nn::Detection>& found,
                             const std::vector<nn::Detection>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(found[i].score, expected[i].score);
    EXPECT_EQ(found[i].label, expected[i].label);
    EXPECT_EQ(found[i].box.x1, expected[i].box.x1);
    EXPECT_EQ(found[i].box.y2, expected[i].box.y2);
    EXPECT_EQ(found[i].mask.bits, expected[i].mask.bits);
  }
}

inline void expect_repeats_on_any_number_of_threads(nn::InstanceSegmenter& network, const ByteImage& image) {
  const int threads = thread_count();
  const std::vector<nn::Detection> first = network(image);
  for (const int count : {1, 2, 3}) {
    set_thread_count(count);
    expect_same_bits(network(image), first);
    expect_same_bits(network(image), first);  // now by a plan made for this number of threads
  }
  set_thread_count(threads);
}

}  // namespace penumbra::test
