// penumbra slam - : a stream on standard input, and poses as they are found.
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "nn/base/file.h"
#include "nn/image/image_file.h"
#include "tests/bench/piped_program.h"
#include "tests/support/bytes.h"
#include "tests/support/test_data.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

// A street as YUV4MPEG2, its images side by side, and its camera.
class Stream : public testing::Test {
 protected:
  static constexpr int kFrames = 12;
  void SetUp() override {
    const std::string synth =
        fmt::format("synth --frames {} --size 320x96 --out '{}'", kFrames, path("street"));
    ASSERT_EQ(test::run_penumbra(synth).exit_code, 0);
    std::string bytes = "YUV4MPEG2 W640 H96 F10:1 Ip Cmono\n";
    for (int i = 0; i < kFrames; ++i) {
      bytes += "FRAME\n";
      const ByteImage left = image(0, i), right = image(1, i);
      for (int y = 0; y < left.height(); ++y) {
        bytes.append(reinterpret_cast<const char*>(left.row(y)), 320);
        bytes.append(reinterpret_cast<const char*>(right.row(y)), 320);
      }
    }
    nn::write_file(path("street.y4m"), bytes);
    const std::string calib = nn::read_text_file(path("street/sequences/00/calib.txt"), "calib");
    double fx = 0, cx = 0, fy = 0, cy = 0, bf = 0;
    ASSERT_EQ(std::sscanf(calib.c_str(), "P0: %lf %*f %lf %*f %*f %lf %lf", &fx, &cx, &fy, &cy), 4);
    ASSERT_EQ(std::sscanf(calib.substr(calib.find("P1: ")).c_str(), "P1: %*f %*f %*f %lf", &bf), 1);
    nn::write_file(path("rig.yaml"),
                   fmt::format("fx: {}\nfy: {}\ncx: {}\ncy: {}\nbaseline: {}\nwidth: 320\nheight: 96\n", fx,
                               fy, cx, cy, -bf / fx));
  }
  ByteImage image(int camera, int i) const {
    return nn::read_image(path(fmt::format("street/sequences/00/image_{}/{:06}.png", camera, i)),
                          nn::ImageColour::grey);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  nlohmann::json report() const {
    return nlohmann::json::parse(nn::read_text_file(path("out/run.json"), "run"));
  }
  test::TemporaryDirectory folder_;
};

TEST_F(Stream, OfEveryFrameGivesWhatTheRecordingGives) {
  const test::ProgramResult stream = test::run_penumbra(
      fmt::format("slam - --camera '{}' --every-frame --deterministic --poses - --out '{}'", path("rig.yaml"),
                  path("out")),
      path("street.y4m"));
  ASSERT_EQ(stream.exit_code, 0) << stream.err;
  EXPECT_EQ(std::count(stream.out.begin(), stream.out.end(), '\n'), kFrames) << stream.out;
  EXPECT_NE(stream.err.find("stream: 12 frames, 12 tracked"), std::string::npos) << stream.err;
  EXPECT_EQ(report().at("stream").at("dropped"), 0);
  const std::string of_stream = nn::read_text_file(path("out/trajectory_kitti.txt"), "poses");
  ASSERT_EQ(
      test::run_penumbra(fmt::format("slam '{}' --deterministic --out '{}'", path("street"), path("folder")))
          .exit_code,
      0);
  EXPECT_EQ(of_stream, nn::read_text_file(path("folder/trajectory_kitti.txt"), "poses"));
}

TEST_F(Stream, ThatEndsInItsFirstFrameSaysSo) {
  nn::write_file(path("torn.y4m"), nn::read_file(path("street.y4m"), "a stream").substr(0, 2000));
  const test::ProgramResult stream = test::run_penumbra(
      fmt::format("slam - --camera '{}' --every-frame --out '{}'", path("rig.yaml"), path("out")),
      path("torn.y4m"));
  EXPECT_EQ(stream.exit_code, 1);
  EXPECT_NE(stream.err.find("error: the recording ended before its first whole frame"), std::string::npos)
      << stream.err;
}

TEST_F(Stream, ThatComesTooFastLosesFramesAndSaysSo) {
  const test::ProgramResult stream = test::run_penumbra(
      fmt::format("slam - --camera '{}' --out '{}'", path("rig.yaml"), path("out")), path("street.y4m"));
  ASSERT_EQ(stream.exit_code, 0) << stream.err;
  const nlohmann::json counts = report().at("stream");
  EXPECT_EQ(counts.at("frames"), kFrames);
  EXPECT_EQ(counts.at("dropped").get<int>() + report().at("frames").get<int>(), kFrames);
  EXPECT_NE(stream.err.find("the stream had "), std::string::npos);
}

// The stream falls silent, and goes on with what was seen before.
TEST_F(Stream, ThatFallsSilentIsWaitedForAndLocatedAgain) {
  const std::string bytes = test::read_file(path("street.y4m"));
  const std::size_t header = bytes.find('\n') + 1, frame = (bytes.size() - header) / kFrames;
  ASSERT_EQ(::mkfifo(path("fifo").c_str(), 0600), 0);
  std::thread camera([&] {
    std::ofstream pipe(path("fifo"), std::ios::binary);
    pipe << bytes << std::flush;
    std::this_thread::sleep_for(std::chrono::milliseconds(2400));
    pipe << bytes.substr(header + 4 * frame, 6 * frame);
  });
  const test::ProgramResult stream = test::run_penumbra(
      fmt::format("slam - --camera '{}' --every-frame --poses - --out '{}'", path("rig.yaml"), path("out")),
      path("fifo"));
  camera.join();
  ASSERT_EQ(stream.exit_code, 0) << stream.err;
  EXPECT_NE(stream.err.find("stream: no frame for 2 s; waiting"), std::string::npos) << stream.err;
  EXPECT_NE(stream.err.find("stream: frames again after 2."), std::string::npos) << stream.err;
  EXPECT_EQ(std::count(stream.out.begin(), stream.out.end(), '\n'), kFrames + 6) << stream.err;
  EXPECT_GT(report().at("stream").at("longest_silence_s"), 2.3);
}

// Its end is when its user says so: no failure, all results.
TEST_F(Stream, IsEndedByItsUser) {
  PipedProgram program = start_piped({test::penumbra_program(), "slam", "-", "--camera", path("rig.yaml"),
                                      "--every-frame", "--poses", "-", "--out", path("out")});
  const std::string bytes = test::read_file(path("street.y4m"));
  ASSERT_EQ(::write(program.input, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  FILE* const poses = ::fdopen(program.output, "r");
  std::array<char, 512> line{};
  for (int i = 0; i < kFrames; ++i)
    ASSERT_NE(std::fgets(line.data(), static_cast<int>(line.size()), poses), nullptr);
  ASSERT_EQ(::kill(program.process, SIGINT), 0);
  int status = 0;
  ASSERT_EQ(::waitpid(program.process, &status, 0), program.process);
  std::fclose(poses);
  ::close(program.input);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_FALSE(report().contains("error"));
  EXPECT_EQ(report().at("stream").at("ended_by"), "SIGINT");
  EXPECT_EQ(report().at("tracked"), kFrames);
}

TEST_F(Stream, NeedsACameraAndAReader) {
  const auto refused = [&](const std::string& arguments, int code, const std::string& text) {
    const test::ProgramResult result =
        test::run_penumbra(fmt::format("slam - --out '{}' {}", path("out"), arguments), path("street.y4m"));
    EXPECT_EQ(result.exit_code, code);
    EXPECT_NE(result.err.find(text), std::string::npos) << result.err;
  };
  refused("", 2, "needs --camera");
  const test::ProgramResult no_camera = test::run_penumbra(
      fmt::format("slam /dev/video77 --camera '{}' --out '{}'", path("rig.yaml"), path("out")));
  EXPECT_EQ(no_camera.exit_code, 1);
  EXPECT_NE(no_camera.err.find("/dev/video77: cannot be opened"), std::string::npos) << no_camera.err;
  refused(fmt::format("--camera '{}' --layout top-bottom", path("rig.yaml")), 1, "640 x 48");
  refused(fmt::format("--camera '{}' --poses unix:/nowhere/at/all", path("rig.yaml")), 1,
          "nobody listens there");
  refused(fmt::format("--camera '{}' --poses somewhere", path("rig.yaml")), 2, "expected - or unix:PATH");
}

}  // namespace
}  // namespace penumbra
