#include "slam/sources/live/live_frames.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "nn/base/error.h"
#include "tests/support/expect_error.h"

namespace penumbra::slam {
namespace {

using namespace std::chrono_literals;

// Gives frames one at a time, as the test lets it.
class ToldStream final : public FrameStream {
 public:
  std::string name() const override { return "stream"; }
  void stop() override { closed_ = true; }
  bool has_times() const override { return has_times_; }
  Sensor sensor() const override { return Sensor::stereo; }
  Size size() const override { return {80, 60}; }
  bool read(StreamFrame& frame) override {
    while (given_ >= allowed_ && !closed_) std::this_thread::sleep_for(1ms);
    if (fails_) throw InputError("stream", "FRAME", "noise");
    if (given_ >= allowed_) return false;
    frame.index = given_++;
    frame.timestamp = 0.1 * frame.index;
    return true;
  }
  void images(const StreamFrame& frame, bool, ByteImage& left, ByteImage& right, WordImage&) const override {
    left = right = ByteImage::filled(80, 60, static_cast<std::uint8_t>(frame.index));
  }
  void open_anew(bool has_times) {
    has_times_ = has_times;
    closed_ = false;
  }
  void give(int frames) { allowed_ += frames; }
  void close() { closed_ = true; }
  void fail() { fails_ = closed_ = true; }
  int given() const { return given_; }

 private:
  std::atomic<int> given_{0}, allowed_{0};
  std::atomic<bool> closed_{false}, fails_{false}, has_times_{true};
};

class Live : public testing::Test {
 protected:
  Live() {
    camera_.left = {70, 70, 40, 30, LensModel::radial_tangential, {}, 80, 60};
    camera_.baseline = 0.1;
  }
  ~Live() override { stream_.close(); }
  LiveFrames frames(bool drops) { return LiveFrames(stream_, camera_, {drops, false}); }
  static FrameSource::Next patiently(LiveFrames& frames) {
    FrameSource::Next next = FrameSource::Next::later;
    for (int i = 0; i < 500 && next == FrameSource::Next::later; ++i) next = frames.wait(0.01);
    return next;
  }
  // Until the thread has read so many.
  static void wait_for(const LiveFrames& frames, int read) {
    for (int i = 0; i < 5000 && frames.counts().read < read; ++i) std::this_thread::sleep_for(1ms);
    ASSERT_EQ(frames.counts().read, read);
  }
  ToldStream stream_;
  CameraFile camera_;
};

TEST_F(Live, TheNewestFrameWinsAndTheOthersAreCounted) {
  LiveFrames live = frames(true);
  EXPECT_EQ(live.wait(0.001), FrameSource::Next::later);
  stream_.give(5);
  wait_for(live, 5);
  ASSERT_EQ(patiently(live), FrameSource::Next::frame);
  const StereoImages images = live.next();
  EXPECT_EQ(images.index, 4);
  EXPECT_EQ(images.left.at(0, 0), 4);
  EXPECT_DOUBLE_EQ(live.newest().timestamp, 0.4);
  EXPECT_EQ(live.counts().dropped, 4);
  stream_.give(1);
  ASSERT_EQ(patiently(live), FrameSource::Next::frame);
  EXPECT_EQ(live.next().index, 5);
  stream_.close();
  EXPECT_EQ(patiently(live), FrameSource::Next::end);
  EXPECT_EQ(live.counts().dropped, 4);
  EXPECT_GT(live.counts().longest_delay, 0.0);
}

TEST_F(Live, OrTheStreamWaitsForEveryFrame) {
  LiveFrames live = frames(false);
  stream_.give(20);
  stream_.close();
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(patiently(live), FrameSource::Next::frame);
    EXPECT_EQ(live.next().index, i);
    EXPECT_LE(stream_.given(), i + 3);  // one is taken, one waits, one is being read
  }
  EXPECT_EQ(patiently(live), FrameSource::Next::end);
  EXPECT_EQ(live.counts().dropped, 0);
}

TEST_F(Live, ABrokenStreamGivesWhatCameBefore) {
  LiveFrames live = frames(true);
  stream_.give(1);
  wait_for(live, 1);
  stream_.fail();
  ASSERT_EQ(patiently(live), FrameSource::Next::frame);
  EXPECT_EQ(live.next().index, 0);
  test::expect_error<InputError>([&] { patiently(live); }, {"expected FRAME, found noise"});
  EXPECT_EQ(live.wait(0.01), FrameSource::Next::end);
}

TEST_F(Live, AnEndBeforeTheStreamsIsQuick) {
  LiveFrames live = frames(false);
  stream_.give(3);
  wait_for(live, 2);
  stream_.close();  // the destructor does not wait for anybody to take them
}

TEST_F(Live, SilenceIsTimeThatPasses) {
  for (const bool has_times : {false, true}) {
    stream_.open_anew(has_times);
    LiveFrames live = frames(true);
    stream_.give(1);
    ASSERT_EQ(patiently(live), FrameSource::Next::frame);
    const double before = live.next().timestamp;
    std::this_thread::sleep_for(1100ms);
    stream_.give(1);
    ASSERT_EQ(patiently(live), FrameSource::Next::frame);
    const double passed = live.next().timestamp - before;
    if (has_times) {
      EXPECT_NEAR(passed, 0.1, 1e-9);
    } else {
      EXPECT_NEAR(passed, live.counts().longest_silence, 0.05);
    }
    EXPECT_GT(live.counts().longest_silence, 1.0);
  }
}

TEST_F(Live, CamerasThatDoNotFitAreRefused) {
  camera_.left.width = 160;
  test::expect_error<InputError>([&] { frames(true); }, {"160 x 60", "80 x 60", "--layout"});
  camera_.sensor = Sensor::rgbd;
  test::expect_error<InputError>([&] { frames(true); }, {"a camera with depth", "two cameras"});
}

}  // namespace
}  // namespace penumbra::slam
