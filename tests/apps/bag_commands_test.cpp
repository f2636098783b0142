// Recordings of robots on the command line: a street that the real writers recorded gives the trajectory of
// the folder, what `penumbra info` lists, and what `penumbra export` writes.
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "nn/image/image_file.h"
#include "slam/geometry/mounting.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/map/ply.h"
#include "slam/sources/bag/chunk_packing.h"
#include "slam/sources/bag/message_source.h"
#include "slam/sources/bag/messages.h"
#include "slam/sources/fixed_frames.h"
#include "slam/sources/open_dataset.h"
#include "tests/support/bag_files.h"
#include "tests/support/test_data.h"

namespace penumbra::test {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 12;

// A synthetic street in KITTI's layout, with PGM images beside for writers in Python, and the run of its
// folder.
class Street {
 public:
  Street() {
    const ProgramResult made = run_penumbra(
        fmt::format("synth --size 310x94 --frames {} --out {}", kFrames, (folder_ / "street").string()));
    EXPECT_EQ(made.exit_code, 0) << made.err;
    for (const char* side : {"image_0", "image_1"}) {
      const fs::path to = folder_ / "pgm" / side;
      fs::create_directories(to);
      for (const fs::directory_entry& entry : fs::directory_iterator(sequence() / side)) {
        const ByteImage image = nn::read_image(entry.path(), nn::ImageColour::grey);
        nn::write_image(to / (entry.path().stem().string() + ".pgm"), image);
      }
    }
    // A header with the time 0 is one without.
    std::string times;
    for (int i = 0; i < kFrames; ++i) times += fmt::format("{:.1f}\n", 1.0 + 0.1 * i);
    write_file(sequence() / "times.txt", times);
    for (const char* name : {"calib.txt", "times.txt"}) fs::copy(sequence() / name, folder_ / "pgm" / name);
    trajectory_ = run(sequence(), "folder");
  }

  fs::path sequence() const { return folder_ / "street" / "sequences" / "00"; }
  fs::path pgm() const { return folder_ / "pgm"; }
  fs::path operator/(const std::string& name) const { return folder_ / name; }
  const std::string& trajectory() const { return trajectory_; }

  // The poses of a run of `source`; empty where it fails.
  std::string run(const fs::path& source, const std::string& name) const {
    const fs::path out = folder_ / ("run_" + name);
    const ProgramResult result = run_penumbra(
        fmt::format("slam {} --deterministic --threads 1 --out {}", source.string(), out.string()));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.exit_code == 0 ? read_file(out / "trajectory_kitti.txt") : std::string();
  }

 private:
  TemporaryDirectory folder_;
  std::string trajectory_;
};

const Street& street() {
  static const Street made;
  return made;
}

struct Case {
  const char *writer, *kind, *file;
};

class RecordedStreet : public testing::TestWithParam<Case> {};

TEST_P(RecordedStreet, GivesTheTrajectoryOfItsFolder) {
  const auto& [writer, kind, file] = GetParam();
  for (const slam::BagLibrary& library : slam::bag_libraries()) {
    if (!library.is_there && std::string(kind) == library.name) GTEST_SKIP() << "built without " << kind;
  }
  const std::string name = fmt::format("{}_{}", writer, kind),
                    script = source_path("tests/slam/sources/bag/record_street.py").string();
  const fs::path out = street() / (name + file);
  int code = 77;
  // Debian's modules and PyPI's may belong to different Pythons.
  for (const char* python : {"python3", "/usr/bin/python3"}) {
    if (code != 77) break;
    const int status = std::system(
        fmt::format("{} {} {} {} {} {}", python, script, writer, kind, street().pgm().string(), out.string())
            .c_str());
    code = WIFEXITED(status) ? WEXITSTATUS(status) : 1;
  }
  if (code == 77 || code == 127) GTEST_SKIP() << "the writer " << writer << " is not installed";
  ASSERT_EQ(code, 0);
  const std::string trajectory = street().run(out, name);
  EXPECT_FALSE(trajectory.empty());
  EXPECT_EQ(trajectory, street().trajectory());
  const nlohmann::json info = nlohmann::json::parse(run_penumbra("info --json " + out.string()).out);
  EXPECT_EQ(info["messages"], 4 * kFrames);
  EXPECT_NE(info["taken"].get<std::string>().find("/right/image_raw"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Writers, RecordedStreet,
                         testing::Values(Case{"rosbag", "none", ".bag"}, Case{"rosbag", "lz4", ".bag"},
                                         Case{"rosbag", "bz2", ".bag"}, Case{"mcap", "none", ".mcap"},
                                         Case{"mcap", "lz4", ".mcap"}, Case{"mcap", "zstd", ".mcap"},
                                         Case{"mcap", "unchunked", ".mcap"}, Case{"rosbags", "sqlite3", ""},
                                         Case{"rosbags", "mcap", ""}, Case{"rosbags", "ros1", ".bag"}),
                         [](const auto& info) {
                           return fmt::format("{}_{}", info.param.writer, info.param.kind);
                         });

// Poses and path of a run with --body are the body's in its own world, and the camera hangs on it.
void expect_body_in_export(const fs::path& run, const fs::path& mcap, const slam::Mounting& body) {
  const ProgramResult result = run_penumbra(fmt::format("export {} --mcap {}", run.string(), mcap.string()));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto source = slam::open_bag(mcap);
  std::vector<slam::TransformMessage> fixed, moving;
  source->read_all([&](const slam::Message& message) {
    const std::string& topic = source->topics()[message.topic].name;
    if (topic != "/tf" && topic != "/tf_static") return;
    auto& all = topic == "/tf" ? moving : fixed;
    for (const slam::TransformMessage& t :
         slam::read_transforms(message.bytes, slam::MessageEncoding::cdr, topic))
      all.push_back(t);
  });
  ASSERT_EQ(fixed.size(), 2U);
  EXPECT_EQ(fixed[0].parent + " " + fixed[0].child, "world map");
  EXPECT_EQ(fixed[1].parent + " " + fixed[1].child, body.frame + " camera");
  const slam::Trajectory poses = slam::read_tum_trajectory(run / "trajectory_tum.txt");
  ASSERT_EQ(moving.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    std::vector<slam::TransformMessage> all = fixed;
    all.push_back(moving[i]);
    const auto T_map_camera = slam::fixed_transform(all, "map", "camera");
    ASSERT_TRUE(T_map_camera);
    EXPECT_LT((T_map_camera->inverse() * poses[i].T_wc).log().norm(), 1e-6);
  }
}

// An office seen by a depth camera: colour and metres as messages of ROS 2.
TEST(BagCommands, ARecordingWithDepthGivesTheTrajectoryOfItsFolder) {
  const TemporaryDirectory folder;
  const fs::path office = folder / "office", mcap = folder / "office.mcap";
  ASSERT_EQ(run_penumbra(fmt::format("synth --scene office --preset desk --size 320x240 --frames 8 --out {}",
                                     office.string()))
                .exit_code,
            0);
  // A header with the time 0, the first frame's, would be one without: a second later.
  for (const char* name : {"rgb.txt", "depth.txt", "groundtruth.txt"}) {
    std::istringstream lines(read_file(office / name));
    std::string later;
    for (std::string line; std::getline(lines, line);) {
      const std::size_t space = line.find(' ');
      later +=
          line[0] == '#' ? line + "\n" : fmt::format("{:.6f}{}\n", std::stod(line) + 1.0, line.substr(space));
    }
    write_file(office / name, later);
  }
  const auto dataset = slam::open_dataset(office);
  const slam::StereoCamera& camera = dataset->camera();
  const auto width = static_cast<std::uint32_t>(camera.width),
             height = static_cast<std::uint32_t>(camera.height);
  CameraParts said = pinhole(width, height, camera.fx);
  said.K = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
  // It stands on a robot, 20 cm ahead of its base and 1 m above it, and looks ahead; which both say.
  const slam::Mounting robot{
      "base_link", {(Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished(), {0.2, 0.0, 1.0}}};
  const TransformParts on_the_robot{"base_link", "camera", {0.2, 0.0, 1.0}, {-0.5, 0.5, -0.5, 0.5}};
  write_file(office / "calibration.yaml",
             read_file(office / "calibration.yaml") +
                 "body: base_link\nT_body_left: [0, 0, 1, 0.2, -1, 0, 0, 0, 0, -1, 0, 1]\n");
  std::vector<BagMessage> messages = {
      {"/camera/rgb/camera_info", "sensor_msgs/CameraInfo", 0, camera_message(Wire::cdr, said)},
      {"/tf_static", "tf2_msgs/TFMessage", 0, transforms_message(Wire::cdr, {on_the_robot})}};
  for (int i = 0; i < dataset->size(); ++i) {
    const slam::StereoImages images = dataset->load(i);
    ImageParts colour, depth;
    colour.stamp = depth.stamp = std::llround(images.timestamp * 1e9);
    colour.width = depth.width = width;
    colour.height = depth.height = height;
    colour.encoding = "bgr8";
    colour.step = 3 * width;
    colour.data.assign(reinterpret_cast<const char*>(images.left.data()), images.left.elements());
    depth.encoding = "32FC1";
    depth.step = 4 * width;
    depth.data.assign(reinterpret_cast<const char*>(images.depth.data()), 4 * images.depth.elements());
    messages.push_back({"/camera/depth/image", "sensor_msgs/Image", 5, image_message(Wire::cdr, depth)});
    messages.push_back({"/camera/rgb/image_color", "sensor_msgs/Image", 5, image_message(Wire::cdr, colour)});
  }
  write_file(mcap, mcap_file(messages, "cdr"));
  std::string trajectories[2], of_the_body[2];
  for (const fs::path& source : {office, mcap}) {
    const fs::path out = folder / ("run_" + source.filename().string());
    const ProgramResult run =
        run_penumbra(fmt::format("slam {} --deterministic --threads 1 --body base_link --poses - --out {}",
                                 source.string(), out.string()));
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_NE(run.err.find("poses of base_link"), std::string::npos) << run.err;
    trajectories[source == mcap ? 1 : 0] = read_file(out / "trajectory_tum.txt");
    of_the_body[source == mcap ? 1 : 0] = read_file(out / "body_tum.txt");
    EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), dataset->size());
  }
  EXPECT_EQ(trajectories[0], trajectories[1]);
  EXPECT_EQ(of_the_body[0], of_the_body[1]);
  const slam::Trajectory camera_path =
                             slam::read_tum_trajectory(folder / "run_office" / "trajectory_tum.txt"),
                         body_path = slam::read_tum_trajectory(folder / "run_office" / "body_tum.txt");
  ASSERT_EQ(body_path.size(), camera_path.size());
  EXPECT_LT(body_path.front().T_wc.log().norm(), 1e-9);
  for (std::size_t i = 0; i < body_path.size(); ++i) {
    // Where the camera is by both, seen from where the body began.
    const Eigen::Vector3d by_body = body_path[i].T_wc * robot.T_frame_camera.translation,
                          by_camera = robot.T_frame_camera * camera_path[i].T_wc.translation;
    EXPECT_LT((by_body - by_camera).norm(), 1e-6);
  }
  // Against truth that is of the body, too.
  slam::Trajectory truth = *dataset->ground_truth();
  for (slam::TimedPose& pose : truth) pose.T_wc = pose.T_wc * robot.T_frame_camera.inverse();
  slam::write_tum_trajectory(folder / "truth.txt", truth);
  const nlohmann::json evaluated = nlohmann::json::parse(
      run_penumbra(fmt::format("eval --groundtruth {} --estimate {} --json", (folder / "truth.txt").string(),
                               (folder / "run_office" / "body_tum.txt").string()))
          .out);
  const nlohmann::json report = nlohmann::json::parse(read_file(folder / "run_office" / "run.json"));
  EXPECT_NEAR(report["ground_truth"]["ape_rmse_m"].get<double>(), evaluated["ape_m"]["rmse"].get<double>(),
              1e-6);
  EXPECT_EQ(report["body"]["frame"], "base_link");
  const ProgramResult unknown =
      run_penumbra(fmt::format("slam {} --body imu --out {}", mcap.string(), (folder / "none").string()));
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_NE(unknown.err.find("base_link, camera"), std::string::npos) << unknown.err;
  // As of a variable that is not set: who asks for a body's poses must not get the camera's.
  const ProgramResult nameless =
      run_penumbra(fmt::format("slam {} --body '' --out {}", mcap.string(), (folder / "none").string()));
  EXPECT_EQ(nameless.exit_code, 1);
  EXPECT_NE(nameless.err.find("found ''"), std::string::npos) << nameless.err;
  expect_body_in_export(folder / "run_office", folder / "run.mcap", robot);
}

TEST(BagCommands, InfoListsTopicsWithCountsAndRates) {
  const TemporaryDirectory folder;
  std::vector<BagMessage> messages;
  for (int i = 0; i < 5; ++i)
    messages.push_back({"/chatter", "std_msgs/String", i * std::int64_t{250'000'000}, "text"});
  write_file(folder / "run.bag", ros1_bag(messages));
  const ProgramResult table = run_penumbra("info " + (folder / "run.bag").string());
  EXPECT_EQ(table.exit_code, 0);
  EXPECT_NE(table.out.find("/chatter"), std::string::npos);
  EXPECT_NE(table.out.find("4.00"), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("ROS 1 bag, 1 topic, 5 messages"), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("no two topics"), std::string::npos);
  const ProgramResult refused =
      run_penumbra(fmt::format("slam {} --out {}", (folder / "run.bag").string(), (folder / "out").string()));
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.err.find("no topic with images"), std::string::npos);
  EXPECT_NE(run_penumbra("info --cpu").out.find("lz4"), std::string::npos);
}

TEST(BagCommands, ExportWritesWhatTheRunFound) {
  const fs::path run = street() / "run_folder", mcap = street() / "run.mcap", pcd = street() / "run.pcd";
  const ProgramResult result =
      run_penumbra(fmt::format("export {} --mcap {} --pcd {}", run.string(), mcap.string(), pcd.string()));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto source = slam::open_bag(mcap);
  source->read_all([](const slam::Message&) {});
  EXPECT_TRUE(source->notes().empty()) << source->notes().front();
  std::map<std::string, std::uint64_t> counts;
  for (const slam::Topic& topic : source->topics()) counts[topic.name + " " + topic.type] = topic.messages;
  const fs::directory_iterator gallery(run / "gallery");
  const auto pictures = static_cast<std::uint64_t>(std::count_if(
      begin(gallery), end(gallery), [](const auto& entry) { return entry.path().extension() == ".jpg"; }));
  EXPECT_GT(pictures, 0U);
  const std::map<std::string, std::uint64_t> expected = {
      {"/map sensor_msgs/PointCloud2", 1}, {"/overlay sensor_msgs/CompressedImage", pictures},
      {"/path nav_msgs/Path", 1},          {"/pose geometry_msgs/PoseStamped", kFrames},
      {"/tf tf2_msgs/TFMessage", kFrames}, {"/tf_static tf2_msgs/TFMessage", 1}};
  EXPECT_EQ(counts, expected);
  const std::size_t points = slam::read_ply(run / "map.ply").size();
  const std::string cloud = read_file(pcd);
  EXPECT_NE(cloud.find(fmt::format("POINTS {}\n", points)), std::string::npos);
  EXPECT_EQ(cloud.size() - cloud.find("DATA binary\n") - 12, 16 * points);
  EXPECT_NE(cloud.find("FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\n"), std::string::npos);
  EXPECT_EQ(run_penumbra("export " + run.string()).exit_code, 2);
}

// PyPI's mcap finds the messages by the index, checks every sum, and decodes them by the definitions in the
// file.
TEST(BagCommands, RealReadersOpenWhatIsExported) {
  const fs::path mcap = street() / "read.mcap";
  ASSERT_EQ(
      run_penumbra(fmt::format("export {} --mcap {}", (street() / "run_folder").string(), mcap.string()))
          .exit_code,
      0);
  const std::string script = source_path("tests/slam/sources/bag/read_export.py").string();
  const int status = std::system(fmt::format("python3 {} {} {}", script, mcap.string(),
                                             (street() / "run_folder" / "trajectory_tum.txt").string())
                                     .c_str());
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 1;
  if (code == 77 || code == 127) GTEST_SKIP() << "the reader mcap is not installed";
  EXPECT_EQ(code, 0);
}

}  // namespace
}  // namespace penumbra::test
