// One loaded network serves several threads, each with its own arena. Also run under ThreadSanitizer: see
// CONTRIBUTING.md.
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "nn/base/parallel.h"
#include "nn/models/mask_rcnn.h"
#include "tests/support/random_network.h"
#include "tests/support/repeatability.h"

namespace penumbra::nn {
namespace {

TEST(SharedNetwork, ThreadsWithTheirOwnArenasGetTheSameBitsAsOneAlone) {
  MaskRcnnConfig config;
  config.transform.min_size = 64;
  config.transform.max_size = 96;
  config.rpn.proposals = 60;  // the sanitizer is slow
  config.box_head.max_detections = 6;
  const MaskRcnn network(test::random_mask_rcnn(true), config);
  constexpr int kThreads = 2, kImages = 3;  // the third image has the shape of the first
  const auto image = [](int thread, int i) {
    return test::random_image(static_cast<std::uint32_t>(10 * thread + i), 60 + 9 * thread, 50 + 7 * (i % 2));
  };

  std::vector<std::vector<std::vector<Detection>>> found(kThreads);
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      set_thread_count(2 + t);  // of this thread's loops
      Arena arena;
      for (int i = 0; i < kImages; ++i)
        found[static_cast<std::size_t>(t)].push_back(network.detect(image(t, i), arena));
    });
  }
  for (std::thread& thread : threads) thread.join();

  Arena arena;
  for (int t = 0; t < kThreads; ++t) {
    for (int i = 0; i < kImages; ++i) {
      test::expect_same_bits(found[static_cast<std::size_t>(t)][static_cast<std::size_t>(i)],
                             network.detect(image(t, i), arena));
    }
  }
}

}  // namespace
}  // namespace penumbra::nn
