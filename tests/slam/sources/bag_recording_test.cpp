// Recordings of robots as datasets: which topics are taken, which frames they make, and what is said.
#include "slam/sources/bag_recording.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "nn/base/error.h"
#include "tests/support/bag_files.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

using test::BagMessage;
using test::expect_error;
using test::pinhole;
using test::Wire;

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::uint32_t kWidth = 64, kHeight = 48;

BagMessage image(const std::string& topic, std::int64_t stamp, std::int64_t recorded, int level,
                 const std::string& encoding = "mono8", const std::string& frame = "camera") {
  test::ImageParts parts;
  parts.encoding = encoding;
  parts.frame = frame;
  parts.stamp = stamp;
  parts.width = kWidth;
  parts.height = kHeight;
  const std::uint32_t bytes = encoding == "mono8" ? 1 : encoding == "bgr8" ? 3 : encoding == "32FC1" ? 4 : 2;
  parts.step = kWidth * bytes;
  parts.data.assign(parts.step * kHeight, '\0');
  for (std::size_t i = 0; i < parts.data.size(); i += bytes) parts.data[i] = static_cast<char>(level);
  return {topic, "sensor_msgs/Image", recorded, test::image_message(Wire::ros1, parts)};
}
BagMessage camera(const std::string& topic, const test::CameraParts& parts) {
  return {topic, "sensor_msgs/CameraInfo", 1, test::camera_message(Wire::ros1, parts)};
}
BagMessage left_camera(const std::string& topic = "/left/camera_info") {
  return camera(topic, pinhole(kWidth, kHeight, 60));
}
BagMessage right_camera(const std::string& topic = "/right/camera_info") {
  return camera(topic, pinhole(kWidth, kHeight, 60, -6));
}

class BagRecording : public testing::Test {
 protected:
  std::unique_ptr<StereoDataset> open(const std::vector<BagMessage>& messages,
                                      const DatasetOptions& options = {}) const {
    test::write_file(folder_ / "run.bag", test::ros1_bag(messages));
    return open_dataset(folder_ / "run.bag", options);
  }
  void expect_refused(const std::vector<BagMessage>& messages, std::initializer_list<std::string> parts,
                      const DatasetOptions& options = {}) const {
    expect_error<InputError>([&] { open(messages, options); }, parts);
  }
  static bool says(const StereoDataset& dataset, const std::string& text) {
    for (const std::string& note : dataset.notes()) {
      if (note.find(text) != std::string::npos) return true;
    }
    return false;
  }
  // Five pairs 0.1 s apart.
  static std::vector<BagMessage> five_pairs(const std::string& left = "/left/image_rect",
                                            const std::string& right = "/right/image_rect") {
    std::vector<BagMessage> messages = {left_camera(), right_camera()};
    for (int i = 0; i < 5; ++i) {
      const std::int64_t time = 1000 * kSecond + i * kSecond / 10;
      messages.push_back(image(left, time, time + 7, 10 + i));
      messages.push_back(image(right, time, time + 9, 20 + i));
    }
    return messages;
  }
  test::TemporaryDirectory folder_;
};

// How a body whose x is ahead, y left and z up carries a camera whose z is ahead.
constexpr std::array kAhead = {-0.5, 0.5, -0.5, 0.5};  // x y z w

BagMessage frames(const std::vector<test::TransformParts>& all, const std::string& topic = "/tf_static") {
  return {topic, "tf2_msgs/TFMessage", 1, test::transforms_message(Wire::ros1, all)};
}

// Cameras that were calibrated each by itself: P[3] is 0.
TEST_F(BagRecording, WhereTheRightCameraStandsMayBeAFixedFrame) {
  std::vector<BagMessage> messages = five_pairs();
  test::CameraParts left = pinhole(kWidth, kHeight, 60), right = pinhole(kWidth, kHeight, 60);
  left.frame = "left_optical";
  right.frame = "/right_optical";
  messages[0] = camera("/left/camera_info", left);
  messages[1] = camera("/right/camera_info", right);
  expect_refused(messages, {"no baseline"});
  messages.push_back(frames({{"base", "head", {0.0, 0.0, 1.0}},
                             {"head", "left_optical", {0.2, 0.06, 0.0}, kAhead},
                             {"base", "right_optical", {0.2, -0.06, 1.0}, kAhead}}));
  const auto dataset = open(messages);
  EXPECT_NEAR(dataset->camera().baseline, 0.12, 1e-9);
  EXPECT_NEAR(dataset->camera().fx, 60.0, 1e-6);
  EXPECT_TRUE(says(*dataset, "fixed frames of tf do: 0.12 m"));
  const ByteImage image = dataset->load(2).left;  // before another recording takes the file's place
  // These images are rectified: what the lenses did is undone already.
  left.D = right.D = {-0.4, 0.1, 0.0, 0.0, 0.0};
  messages[0] = camera("/left/camera_info", left);
  messages[1] = camera("/right/camera_info", right);
  const auto rectified = open(messages);
  EXPECT_EQ(rectified->camera().fx, dataset->camera().fx);
  EXPECT_EQ(rectified->camera().cx, dataset->camera().cx);
  for (const auto& [x, y] : {std::pair{0, 0}, {kWidth - 1, 0}, {kWidth / 2, kHeight - 1}})
    EXPECT_EQ(rectified->load(2).left.at(x, y), image.at(x, y));
  left.R = right.R = {};  // as drivers leave it that turn nothing
  messages[0] = camera("/left/camera_info", left);
  messages[1] = camera("/right/camera_info", right);
  EXPECT_NEAR(open(messages)->camera().baseline, 0.12, 1e-9);
  left = right = pinhole(kWidth, kHeight, 60);
  left.frame = "left_optical";
  right.frame = "/right_optical";
  messages[0] = camera("/left/camera_info", left);
  messages[1] = camera("/right/camera_info", right);
  messages.back() = frames({{"base", "left_optical"}});  // nothing of the right one
  expect_refused(messages, {"no baseline"});
  messages.back() = frames({{"left_optical", "right_optical", {-0.1, 0.0, 0.0}}});  // it is the left one
  expect_refused(messages, {"are they swapped?"});
}

TEST_F(BagRecording, FramesInWhichTheCameraStandsStillAreKnown) {
  std::vector<BagMessage> messages = five_pairs();
  EXPECT_EQ(open(messages)->mountings().size(), 1U);  // its own
  const auto moving = [&](double x, double y) {
    messages.push_back(frames({{"odom", "base_link", {x, 0.0, 0.0}},    // drives
                               {"base_link", "mast", {0.0, y, 1.0}},    // stands, but for its digits
                               {"base_link", "lid", {0.0, 0.0, 2.0}}},  // /tf_static says where
                              "/tf"));
  };
  moving(0.0, 0.2);
  messages.push_back(
      frames({{"base_link", "lid", {0.0, 0.0, 0.5}}, {"/mast", "camera", {0.1, 0.0, 0.0}, kAhead}}));
  moving(1.0, 0.2000001);
  messages.push_back(frames({{"elsewhere", "tower"}}));
  const auto dataset = open(messages);
  std::string names;
  for (const Mounting& mounting : dataset->mountings()) names += mounting.frame + " ";
  EXPECT_EQ(names, "base_link camera lid mast ");
  const SE3& T_base_camera = mounting_of("/base_link", dataset->mountings(), "run").T_frame_camera;
  EXPECT_LT((T_base_camera * Eigen::Vector3d(0.0, 0.0, 2.0) - Eigen::Vector3d(2.1, 0.2, 1.0)).norm(), 1e-9);
  EXPECT_LT((T_base_camera * Eigen::Vector3d(1.0, 0.0, 0.0) - Eigen::Vector3d(0.1, -0.8, 1.0)).norm(), 1e-9);
  const SE3& T_lid_camera = mounting_of("lid", dataset->mountings(), "run").T_frame_camera;
  EXPECT_LT((T_lid_camera.translation - Eigen::Vector3d(0.1, 0.2, 0.5)).norm(), 1e-9);
  expect_error<InputError>([&] { mounting_of("odom", dataset->mountings(), "run"); },
                           {"run", "base_link, camera, lid, mast", "'odom'"});
  EXPECT_EQ(summarise_bag(folder_ / "run.bag").frames.size(), 4U);
}

// By R of its CameraInfo the images' camera is turned against its frame.
TEST_F(BagRecording, RectifiedImagesAreTurnedAgainstTheirFrame) {
  std::vector<BagMessage> messages = five_pairs();
  test::CameraParts left = pinhole(kWidth, kHeight, 60);
  const double c = std::cos(0.1), s = std::sin(0.1);
  left.R = {c, -s, 0, s, c, 0, 0, 0, 1};
  messages[0] = camera("/left/camera_info", left);
  const auto dataset = open(messages);
  const Eigen::Vector3d of_rectified =
      mounting_of("camera", dataset->mountings(), "run").T_frame_camera * Eigen::Vector3d(c, s, 0.0);
  EXPECT_LT((of_rectified - Eigen::Vector3d::UnitX()).norm(), 1e-9);
}

// A chain as long as robots' never are.
TEST_F(BagRecording, ALongChainOfFramesIsFollowedInNoTime) {
  std::vector<BagMessage> messages = five_pairs();
  std::vector<test::TransformParts> chain = {{"camera", "link_0"}};
  for (int i = 1; i < 5000; ++i)
    chain.push_back({fmt::format("link_{}", i - 1), fmt::format("link_{}", i), {0.001, 0.0, 0.0}});
  messages.push_back(frames(chain));
  const auto dataset = open(messages);
  const SE3& T = mounting_of("link_4999", dataset->mountings(), "run").T_frame_camera;
  EXPECT_NEAR(T.translation.x(), -4.999, 1e-9);
}

TEST_F(BagRecording, AStereoPairIsFoundByItsNames) {
  const auto dataset = open(five_pairs());
  EXPECT_EQ(dataset->name(), "ROS 1 bag run.bag");
  EXPECT_EQ(dataset->sensor(), Sensor::stereo);
  ASSERT_EQ(dataset->size(), 5);
  EXPECT_EQ(dataset->camera().fx, 60.0);
  EXPECT_DOUBLE_EQ(dataset->camera().baseline, 0.1);
  EXPECT_DOUBLE_EQ(dataset->timestamp(2), 1000.2);
  const StereoImages images = dataset->load(3);
  EXPECT_EQ(images.left.at(5, 5), 13);
  EXPECT_EQ(images.right.at(5, 5), 23);
  EXPECT_TRUE(says(*dataset, "left /left/image_rect (mono8) and right /right/image_rect (mono8)"));
  DatasetOptions options;
  options.step = 2;
  options.frames = parse_frame_range("1:");
  EXPECT_EQ(open(five_pairs(), options)->size(), 2);
}

// Two recordings appended, a clock that was set: every frame is there, in the order of the headers' times.
TEST_F(BagRecording, TimesThatGoBackLoseNothing) {
  std::vector<BagMessage> messages = five_pairs();
  for (int i = 0; i < 4; ++i) {
    const std::int64_t time = 990 * kSecond + i * kSecond / 10;
    messages.push_back(image("/left/image_rect", time, 5 - i, 40 + i));
    messages.push_back(image("/right/image_rect", time, 5 - i, 50 + i));
  }
  const auto dataset = open(messages);
  ASSERT_EQ(dataset->size(), 9);
  EXPECT_EQ(dataset->load(0).left.at(0, 0), 40);
  EXPECT_EQ(dataset->load(8).right.at(0, 0), 24);
  EXPECT_TRUE(says(*dataset, "/left/image_rect: times go back in 1 place of the file"));
}

TEST_F(BagRecording, WithoutTimesInHeadersThoseOfRecordingCount) {
  std::vector<BagMessage> messages = {left_camera(), right_camera()};
  for (int i = 0; i < 4; ++i) {
    messages.push_back(image("/left/image_rect", 0, i * kSecond / 10, i));
    messages.push_back(image("/right/image_rect", 0, i * kSecond / 10 + 500'000, i));
  }
  const auto dataset = open(messages);
  ASSERT_EQ(dataset->size(), 4);
  EXPECT_DOUBLE_EQ(dataset->timestamp(3), 0.3);
  EXPECT_TRUE(says(*dataset, "/left/image_rect: 4 of 4 headers without a time"));
}

TEST_F(BagRecording, ImagesWithoutPartnersAreLeftOutAndCounted) {
  std::vector<BagMessage> messages = five_pairs();
  messages.pop_back();
  const auto dataset = open(messages);
  EXPECT_EQ(dataset->size(), 4);
  EXPECT_TRUE(says(*dataset, "4 pairs of 5 left and 4 right images; left out: 1 image without a partner"));
  for (BagMessage& message : messages) {
    if (message.topic == "/right/image_rect")
      message = image(message.topic, 1000 * kSecond + 5'000'000, 3, 3);
  }
  expect_refused(messages, {"within 0.001 s", "0.005 s apart", "--pair-within"});
  DatasetOptions options;
  options.pair_within = 0.02;
  EXPECT_EQ(open(messages, options)->size(), 1);
}

TEST_F(BagRecording, DamagedImagesCostThemselvesAlone) {
  std::vector<BagMessage> messages = five_pairs();
  messages[4].bytes.resize(100);
  const auto dataset = open(messages);
  EXPECT_EQ(dataset->size(), 4);
  EXPECT_TRUE(says(*dataset, "/left/image_rect: left out: 1 message without a whole image"));
}

std::vector<BagMessage> depth_frames(const std::string& depth_encoding,
                                     const std::string& colour = "/colour/image_raw",
                                     const std::string& depth = "/aligned_depth_to_color/image_raw") {
  std::vector<BagMessage> messages = {left_camera("/colour/camera_info")};
  for (int i = 0; i < 4; ++i) {
    const std::int64_t time = 10 * kSecond + i * kSecond / 30;
    messages.push_back(image(colour, time, time, 10 + i, "bgr8"));
    messages.push_back(image(depth, time + 8'000'000, time, 100, depth_encoding));
  }
  return messages;
}

TEST_F(BagRecording, AnImageAndItsDepthAreFound) {
  const auto dataset = open(depth_frames("16UC1"));
  EXPECT_EQ(dataset->sensor(), Sensor::rgbd);
  ASSERT_EQ(dataset->size(), 4);
  const StereoImages images = dataset->load(2);
  EXPECT_EQ(images.left.channels(), 3);
  EXPECT_EQ(images.left.at(3, 3, 0), 12);
  EXPECT_FLOAT_EQ(images.depth.at(3, 3), 0.1F);
  EXPECT_NEAR(images.depth_delay, 0.008, 1e-6);
  // As librealsense's own bags have it: mono16, P all zeros.
  std::vector<BagMessage> awkward = depth_frames("mono16", "/device_0/sensor_1/Color_0/image/data",
                                                 "/device_0/sensor_0/Depth_0/image/data");
  test::CameraParts parts = pinhole(kWidth, kHeight, 60);
  parts.P = {};
  awkward[0] = camera("/device_0/sensor_1/Color_0/info/camera_info", parts);
  EXPECT_EQ(open(awkward)->camera().fx, 60.0);
  // There the depth is not registered to colour: its camera says so.
  parts.K[0] = parts.K[4] = 50;
  awkward.push_back(camera("/device_0/sensor_0/Depth_0/info/camera_info", parts));
  expect_refused(awkward, {"not registered", "other K", "--depth-topic", "Color_0"});
  DatasetOptions options;
  options.topics.left = "/device_0/sensor_1/Color_0/image/data";
  options.topics.depth = "device_0/sensor_0/Depth_0/image/data";
  EXPECT_TRUE(says(*open(awkward, options), "does not look as if it were registered"));
}

TEST_F(BagRecording, OfSeveralTheBestIsTakenUnlessOptionsDecide) {
  // Infrared pair and depth: the pair sees the projector's dots.
  std::vector<BagMessage> messages = depth_frames("16UC1");
  for (const BagMessage& message : five_pairs("/infra1/image_rect_raw", "/infra2/image_rect_raw"))
    messages.push_back(message);
  messages.push_back(left_camera("/infra1/camera_info"));
  messages.push_back(right_camera("/infra2/camera_info"));
  EXPECT_EQ(open(messages)->sensor(), Sensor::rgbd);
  DatasetOptions options;
  options.topics.right = "/infra2/image_rect_raw";
  EXPECT_EQ(open(messages, options)->sensor(), Sensor::stereo);
  options.topics.right = "/no_such_topic";
  expect_refused(messages, {"image topic '/no_such_topic'", "/infra1/image_rect_raw"}, options);
  options.topics.right = "/infra2/image_rect_raw";
  options.topics.depth = "/aligned_depth_to_color/image_raw";
  expect_error<UsageError>([&] { open(messages, options); }, {"--right-topic and --depth-topic"});
  // Two cameras that names tell apart as left and right come before depth.
  messages = depth_frames("16UC1");
  for (const BagMessage& message : five_pairs()) messages.push_back(message);
  EXPECT_EQ(open(messages)->sensor(), Sensor::stereo);
  // Rectified before raw.
  for (const BagMessage& message : five_pairs("/left/image_raw", "/right/image_raw"))
    messages.push_back(message);
  EXPECT_TRUE(says(*open(messages), "left /left/image_rect (mono8)"));
}

TEST_F(BagRecording, ACameraFileStandsInForCameraInfos) {
  std::vector<BagMessage> messages = five_pairs("/cam0/image_raw", "/cam1/image_raw");
  messages.erase(messages.begin(), messages.begin() + 2);
  expect_refused(messages, {"sensor_msgs/CameraInfo beside /cam0/image_raw", "--camera"});
  test::write_file(folder_ / "rig.yaml", "fx: 70\nfy: 70\ncx: 32\ncy: 24\nbaseline: 0.2\n");
  DatasetOptions options;
  options.camera = folder_ / "rig.yaml";
  EXPECT_EQ(open(messages, options)->camera().fx, 70.0);
  options.camera = folder_ / "rgbd.yaml";
  test::write_file(options.camera, "sensor: rgbd\nfx: 70\nfy: 70\ncx: 32\ncy: 24\ndepth_factor: 1000\n");
  expect_refused(messages, {"rgbd.yaml", "a stereo camera"}, options);
  // A camera info of another name.
  messages.push_back(left_camera("/calibration/a"));
  messages.push_back(right_camera("/calibration/b"));
  options.camera.clear();
  options.topics.left_info = "/calibration/a";
  options.topics.right_info = "/calibration/b";
  EXPECT_EQ(open(messages, options)->camera().fx, 60.0);
}

TEST_F(BagRecording, WithoutTwoTopicsThatBelongTogetherTheyAreListed) {
  std::vector<BagMessage> messages = five_pairs("/front/image", "/back/image");
  expect_refused(
      messages, {"run.bag", "--left-topic", "/back/image (mono8, 5 images), /front/image (mono8, 5 images)"});
  expect_refused({{"/chatter", "std_msgs/String", 1, "xxxx"}}, {"no topic with images"});
  test::write_file(folder_ / "run.bag", test::ros1_bag(five_pairs(), 3).substr(0, 5000));
  expect_error<InputError>([&] { open_dataset(folder_ / "run.bag"); },
                           {"no topic with images", "cut off or damaged at byte"});
}

TEST_F(BagRecording, ADatasetFolderKnowsNoTopics) {
  DatasetOptions options;
  options.topics.left = "/left";
  test::write_file(folder_ / "calibration.yaml", "fx: 1\n");
  expect_error<UsageError>([&] { open_dataset(folder_.path(), options); }, {"topics and --camera"});
}

TEST_F(BagRecording, ASummaryListsTheTopicsAndWhatWouldBeTaken) {
  test::write_file(folder_ / "run.mcap", test::mcap_file(five_pairs(), "ros1"));
  const BagSummary summary = summarise_bag(folder_ / "run.mcap");
  EXPECT_EQ(summary.kind, "MCAP");
  ASSERT_EQ(summary.topics.size(), 4U);
  EXPECT_EQ(summary.topics[0].name, "/left/camera_info");
  EXPECT_EQ(summary.topics[1].messages, 5U);
  EXPECT_NE(summary.taken.find("/right/image_rect"), std::string::npos);
}

}  // namespace
}  // namespace penumbra::slam
