#include "slam/dynamics/segmentation_worker.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>

#include "nn/base/error.h"
#include "nn/base/parallel.h"

namespace penumbra::slam {
namespace {

std::vector<Instance> one_instance(const ImageToSegment& image) {
  Instance instance;
  instance.class_id = image.frame;
  return {instance};
}

TEST(SegmentationWorker, InLineHandsOverAtTheNextTake) {
  SegmentationWorker worker(one_instance, /*threaded=*/false);
  worker.submit({4, {}, {}});
  worker.submit({5, {}, {}});
  const std::vector<SegmentedFrame> found = worker.take();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].frame, 4);
  EXPECT_EQ(found[1].instances[0].class_id, 5);
  EXPECT_TRUE(worker.take().empty());
}

TEST(SegmentationWorker, TheNewestImageWins) {
  std::promise<void> release;
  std::shared_future<void> released = release.get_future().share();
  std::atomic<bool> started = false;
  SegmentationWorker worker(
      [&](const ImageToSegment& image) {
        started = true;
        released.wait();
        return one_instance(image);
      },
      /*threaded=*/true);
  worker.submit({1, {}, {}});
  while (!started) std::this_thread::yield();
  for (int frame = 2; frame < 6; ++frame) worker.submit({frame, {}, {}});
  EXPECT_TRUE(worker.take().empty());  // nobody waited
  release.set_value();
  worker.drain();
  const std::vector<SegmentedFrame> found = worker.take();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].frame, 1);
  EXPECT_EQ(found[1].frame, 5);
  EXPECT_EQ(worker.dropped(), 3);
}

TEST(SegmentationWorker, ARecordingThatIsPlayedWaitsForTheImageUnderWay) {
  SegmentationWorker worker(one_instance, /*threaded=*/true);
  worker.keep_pace(1e9);  // nothing was submitted
  worker.submit({1, {}, {}});
  worker.keep_pace(1e9);  // long before that has passed the image is done
  EXPECT_EQ(worker.take().size(), 1U);
}

TEST(SegmentationWorker, ARecordingThatIsPlayedWaitsNoLongerThanALiveCamera) {
  std::promise<void> release;
  SegmentationWorker worker(
      [&](const ImageToSegment& image) {
        release.get_future().wait();
        return one_instance(image);
      },
      /*threaded=*/true);
  worker.submit({1, {}, {}});
  worker.keep_pace(0.001);  // the network is not ready, the next frame goes on without it
  worker.keep_pace(-1.0);   // as where times go back
  EXPECT_TRUE(worker.take().empty());
  release.set_value();
  worker.drain();
  EXPECT_EQ(worker.take().size(), 1U);
}

TEST(SegmentationWorker, ItsNetworkHasTheThreadsThatItIsGiven) {
  const int before = thread_count();
  int seen = 0;
  SegmentationWorker worker(
      [&](const ImageToSegment&) {
        seen = thread_count();
        return std::vector<Instance>{};
      },
      /*threaded=*/true, before + 2);
  worker.submit({0, {}, {}});
  worker.drain();
  EXPECT_EQ(seen, before + 2);
  EXPECT_EQ(thread_count(), before);  // of the caller's loops
}

TEST(SegmentationWorker, PassesErrorsOn) {
  const auto fails = [](const ImageToSegment&) -> std::vector<Instance> { throw Error("no masks today"); };
  SegmentationWorker in_line(fails, false);
  EXPECT_THROW(in_line.submit({0, {}, {}}), Error);
  SegmentationWorker threaded(fails, true);
  threaded.submit({0, {}, {}});
  EXPECT_THROW(threaded.drain(), Error);
}

TEST(SegmentationWorker, WithoutASegmenterFindsNothing) {
  SegmentationWorker worker({}, true);
  EXPECT_FALSE(worker.enabled());
  worker.submit({0, {}, {}});
  worker.drain();
  EXPECT_TRUE(worker.take().empty());
}

}  // namespace
}  // namespace penumbra::slam
