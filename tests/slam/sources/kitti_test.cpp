#include "slam/sources/kitti.h"

#include <gtest/gtest.h>

#include <functional>
#include <opencv2/core.hpp>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/image/image_file.h"
#include "tests/support/cv_images.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

namespace fs = std::filesystem;
using test::expect_error;

constexpr const char* kGreyCalibration =
    "P0: 100 0 40 0 0 101 30 0 0 0 1 0\n"
    "P1: 100 0 40 -50 0 101 30 0 0 0 1 0\n";
constexpr const char* kColourCalibration =
    "P2: 100 0 40 10 0 101 30 0 0 0 1 0\n"
    "P3: 100 0 40 -30 0 101 30 0 0 0 1 0\n"
    "Tr: 1 2 3\n";

// A root with sequences 07 (grey) and, where asked for, others; every frame of its own brightness.
class Kitti : public testing::Test {
 protected:
  static constexpr int kFrames = 4;

  void SetUp() override { make_sequence("07"); }

  fs::path root() const { return folder_.path(); }
  fs::path sequence(const std::string& name = "07") const { return root() / "sequences" / name; }

  void make_sequence(const std::string& name) const {
    fs::create_directories(sequence(name));
    nn::write_file(sequence(name) / "calib.txt", std::string(kGreyCalibration) + kColourCalibration);
    nn::write_file(sequence(name) / "times.txt", "0\n0.1\n0.2\n0.3\n0.4\n");
    make_images(name, 0, CV_8UC1);
    fs::create_directories(root() / "poses");
    std::string poses;
    for (int i = 0; i < kFrames + 2; ++i) poses += fmt::format("1 0 0 0 0 1 0 0 0 0 1 {}\n", i);
    nn::write_file(root() / "poses" / (name + ".txt"), poses);
  }

  void make_images(const std::string& name, int first_camera, int type) const {
    for (int camera = first_camera; camera < first_camera + 2; ++camera) {
      fs::create_directories(sequence(name) / fmt::format("image_{}", camera));
      for (int i = 0; i < kFrames; ++i) {
        test::write_mat(image(camera, i, name), cv::Mat(60, 80, type, cv::Scalar::all(50 * camera + i)));
      }
    }
  }

  fs::path image(int camera, int frame, const std::string& name = "07") const {
    return sequence(name) / fmt::format("image_{}/{:06}.png", camera, frame);
  }

  void expect_refused(std::initializer_list<std::string> parts, const DatasetOptions& options = {}) const {
    expect_error<InputError>([&] { open_dataset(root(), options); }, parts);
  }

  test::TemporaryDirectory folder_;
};

TEST_F(Kitti, GreySequenceIsReadFromRootAndFromItsFolder) {
  for (const fs::path& path : {root(), sequence(), sequence() / "", sequence() / "../07/."}) {
    const std::unique_ptr<StereoDataset> dataset = open_dataset(path);
    EXPECT_EQ(dataset->name(), "KITTI odometry 07");
    EXPECT_EQ(dataset->size(), kFrames);
    const StereoCamera& camera = dataset->camera();
    EXPECT_EQ(camera.fx, 100.0);
    EXPECT_EQ(camera.fy, 101.0);
    EXPECT_EQ(camera.cx, 40.0);
    EXPECT_EQ(camera.cy, 30.0);
    EXPECT_DOUBLE_EQ(camera.baseline, 0.5);
    EXPECT_EQ(camera.width, 80);
    EXPECT_EQ(camera.height, 60);
    ASSERT_TRUE(dataset->ground_truth().has_value());
    ASSERT_EQ(dataset->ground_truth()->size(), 4U);
    EXPECT_EQ(dataset->ground_truth()->at(2).T_wc.translation.z(), 2.0);
    const StereoImages images = dataset->load(3);
    EXPECT_EQ(images.index, 3);
    EXPECT_EQ(images.timestamp, 0.3);
    EXPECT_EQ(images.left.channels(), 1);
    EXPECT_EQ(images.left.at(0, 0), 3);
    EXPECT_EQ(images.right.at(0, 0), 53);
  }
}

TEST_F(Kitti, FrameRangeKeepsTheFileNumbersTimesAndPoses) {
  DatasetOptions options;
  options.frames = parse_frame_range("1:3");
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root(), options);
  EXPECT_EQ(dataset->size(), 2);
  EXPECT_EQ(dataset->load(1).index, 2);
  EXPECT_EQ(dataset->load(1).left.at(0, 0), 2);
  EXPECT_EQ(dataset->timestamp(0), 0.1);
  ASSERT_EQ(dataset->ground_truth()->size(), 2U);
  EXPECT_EQ(dataset->ground_truth()->front().T_wc.translation.z(), 1.0);
  EXPECT_EQ(dataset->ground_truth()->front().timestamp, 0.1);
}

TEST_F(Kitti, FrameRangePastTheEndIsRefused) {
  DatasetOptions options;
  for (const char* range : {"0:5", "4:", "9:"}) {
    options.frames = parse_frame_range(range);
    expect_refused({"sequences/07", "frames within 0:4", range}, options);
  }
}

TEST_F(Kitti, ColourImagesUseP2AndP3) {
  make_images("07", 2, CV_8UC3);
  DatasetOptions options;
  EXPECT_EQ(open_dataset(root(), options)->load(0).left.channels(), 1);  // grey where both are there
  options.cameras = DatasetCameras::colour;
  EXPECT_DOUBLE_EQ(open_dataset(root(), options)->camera().baseline, 0.4);
  EXPECT_EQ(open_dataset(root(), options)->load(0).left.channels(), 3);
  fs::remove_all(sequence() / "image_0");
  fs::remove_all(sequence() / "image_1");
  options.cameras = DatasetCameras::automatic;
  const StereoImages second = open_dataset(root(), options)->load(1);
  for (const int c : {0, 1, 2}) EXPECT_EQ(second.right.at(0, 0, c), 151);
}

TEST_F(Kitti, SeveralSequencesAreListed) {
  make_sequence("08");
  DatasetOptions options;
  expect_error<UsageError>([&] { open_dataset(root()); }, {"several sequences", "07, 08"});
  options.sequence = "09";
  expect_refused({"sequence 09", "only 07, 08"}, options);
  options.sequence = "../sequences/07";  // a name, not a path
  expect_refused({"only 07, 08"}, options);
  options.sequence = "08";
  EXPECT_EQ(open_dataset(root(), options)->name(), "KITTI odometry 08");
  EXPECT_EQ(open_dataset(sequence("08"), options)->name(), "KITTI odometry 08");
  expect_error<UsageError>([&] { open_dataset(sequence("07"), options); }, {"is itself a sequence", "08"});
}

TEST_F(Kitti, ARecordingMayHaveANameOfItsOwn) {
  const fs::path path = sequence() / "name.txt";
  for (const char* text : {"yard, Monday\n", "yard, Monday"}) {
    nn::write_file(path, text);
    EXPECT_EQ(open_dataset(root())->name(), "yard, Monday");
  }
  for (const std::string& text : {std::string(), std::string("\n"), std::string("two\nlines\n"),
                                  std::string("\x1b[2J"), std::string(101, 'x')}) {
    nn::write_file(path, text);
    expect_refused({"name.txt", "one line of text"});
  }
}

TEST_F(Kitti, WithoutPosesThereIsNoGroundTruth) {
  fs::remove_all(root() / "poses");
  EXPECT_FALSE(open_dataset(root())->ground_truth().has_value());
  nn::write_file(sequence() / "poses.txt",
                 "1 0 0 9 0 1 0 0 0 0 1 0\n1 0 0 9 0 1 0 0 0 0 1 0\n"
                 "1 0 0 9 0 1 0 0 0 0 1 0\n1 0 0 9 0 1 0 0 0 0 1 0\n");
  EXPECT_EQ(open_dataset(root())->ground_truth()->at(0).T_wc.translation.x(), 9.0);
}

TEST_F(Kitti, MissingFolderFileAndEmptyFolderAreRefused) {
  const auto open = [](const fs::path& path) { return [path] { open_dataset(path); }; };
  expect_error<InputError>(open(root() / "nowhere"), {(root() / "nowhere").string(), "found nothing"});
  expect_error<InputError>(open(sequence() / "calib.txt"), {"calib.txt", "found a file"});
  fs::create_directories(root() / "empty/sequences");
  expect_error<InputError>(open(root() / "empty"), {"empty/sequences", "folders of sequences", "none"});
  fs::create_directories(root() / "bare");
  expect_error<InputError>(open(root() / "bare"), {"bare", "an empty folder"});
  expect_error<InputError>(open(root() / "poses"), {"poses", "sequences/", "calib.txt", "image_0/"});
  fs::create_directories(sequence("08"));
  expect_error<InputError>(
      [&] {
        DatasetOptions options;
        options.sequence = "08";
        open_dataset(root(), options);
      },
      {"sequences/08", "an empty folder"});
  expect_error<InputError>([&] { open_kitti(root() / "poses", {}); }, {"image_0/ and image_1/", "neither"});
  expect_error<UsageError>([] { parse_dataset_format("vicon"); },
                           {"vicon", "auto, kitti, euroc, published, tum, folder or bag"});
}

TEST_F(Kitti, MissingOrEmptyImageFolderIsRefused) {
  fs::remove_all(sequence() / "image_1");
  expect_refused({"image_1", "a folder of images", "nothing"});
  fs::create_directories(sequence() / "image_1");
  expect_refused({"image_1", "images (.png, .jpg", "none"});
}

TEST_F(Kitti, FrameWithoutPartnerIsNamed) {
  fs::remove(image(1, 2));
  expect_refused({"image_1", "frame 000002", "image_0", "4 left, 3 right"});
  make_images("07", 0, CV_8UC1);
  fs::remove(image(0, 3));
  expect_refused({"image_0", "frame 000003", "image_1", "3 left, 4 right"});
}

TEST_F(Kitti, GapInTheNumbersIsNamed) {
  fs::remove(image(0, 1));
  fs::remove(image(1, 1));
  expect_refused({"image_0", "frame 000001", "without gaps", "000002.png"});
}

TEST_F(Kitti, BrokenCalibrationIsRefusedWithItsLine) {
  const std::string P0 = "P0: 100 0 40 0 0 101 30 0 0 0 1 0\n";
  const struct {
    std::string text;
    std::vector<std::string> parts;
  } cases[] = {
      {"", {"calib.txt", "a line 'P0:'", "no such line"}},
      {P0, {"calib.txt", "a line 'P1:'", "no such line"}},
      {P0 + "P1: 100 0 40\n", {"calib.txt:2 (P1)", "12 numbers", "3 numbers"}},
      {P0 + "P1: 100 0 40 nan 0 101 30 0 0 0 1 0\n", {"calib.txt:2 (P1)", "a finite number", "'nan'"}},
      {P0 + "P1: 100 0 40 x 0 101 30 0 0 0 1 0\n", {"calib.txt:2 (P1)", "a number", "'x'"}},
      {P0 + P0, {"calib.txt:2", "every label once", "P0 again"}},
      {P0 + "p1: 100 0 40 -50 0 101 30 0 0 0 1 0\n", {"calib.txt:2", "(is 'P1' meant?)"}},
      {"P0: -100 0 40 0 0 101 30 0 0 0 1 0\nP1: 100 0 40 -50 0 101 30 0 0 0 1 0\n",
       {"calib.txt:1 (P0)", "focal lengths > 0", "-100 and 101"}},
      {"P0: 100 0 40 0 0 0 30 0 0 0 1 0\nP1: 100 0 40 -50 0 0 30 0 0 0 1 0\n",
       {"focal lengths > 0", "100 and 0"}},
      {P0 + "P1: 101 0 40 -50 0 101 30 0 0 0 1 0\n", {"calib.txt:2 (P1)", "fx = 100", "101"}},
      {P0 + "P1: 100 0 40 -50 0 101 31 0 0 0 1 0\n", {"calib.txt:2 (P1)", "cy = 30", "31"}},
      {P0 + "P1: 100 0 40 0 0 101 30 0 0 0 1 0\n", {"calib.txt:2 (P1)", "baseline > 0", "baseline of 0 m"}},
      {P0 + "P1: 100 0 40 50 0 101 30 0 0 0 1 0\n", {"baseline > 0", "baseline of -0.5 m"}},
  };
  for (const auto& [text, parts] : cases) {
    nn::write_file(sequence() / "calib.txt", text);
    for (const std::string& part : parts) expect_refused({part});
  }
  fs::remove(sequence() / "calib.txt");
  expect_refused({"calib.txt", "no such file"});
}

TEST_F(Kitti, MissingTimesAreAnErrorUnlessARateIsGiven) {
  fs::remove(sequence() / "times.txt");
  expect_refused({"times.txt", "no such file"});
  DatasetOptions options;
  options.frame_rate = 20.0;
  EXPECT_DOUBLE_EQ(open_dataset(root(), options)->timestamp(3), 0.15);
  options.frame_rate = 0.0;
  expect_error<UsageError>([&] { open_dataset(root(), options); }, {"more than 0 Hz"});
}

TEST_F(Kitti, BrokenTimesAreRefused) {
  nn::write_file(sequence() / "times.txt", "0\n0.1\n0.2\n");
  expect_refused({"times.txt", "times of 4 frames", "found 3"});
  nn::write_file(sequence() / "times.txt", "0\n0.1\n0.05\n0.3\n");
  expect_refused({"times.txt:3", "a time after 0.100000 s", "0.050000 s"});
  nn::write_file(sequence() / "times.txt", "0\n0.1\n0.1\n0.3\n");
  EXPECT_EQ(open_dataset(root())->size(), 3);  // two images of one time: the first
  nn::write_file(sequence() / "times.txt", "0\nnan\n0.2\n0.3\n");
  expect_refused({"times.txt:2", "finite", "nan"});
}

TEST_F(Kitti, APieceKeepsItsNumbers) {
  for (int camera = 0; camera < 2; ++camera) fs::remove(image(camera, 0));
  {
    const std::unique_ptr<StereoDataset> dataset = open_dataset(root());  // line i belongs to image i
    ASSERT_EQ(dataset->size(), 3);
    EXPECT_DOUBLE_EQ(dataset->timestamp(0), 0.1);
    EXPECT_EQ(dataset->load(0).index, 1);
  }
  nn::write_file(sequence() / "times.txt", "5\n6\n7\n");  // or a line for each
  const std::string pose = "1 0 0 0 0 1 0 0 0 0 1 ";
  nn::write_file(root() / "poses/07.txt", pose + "1\n" + pose + "2\n" + pose + "3\n");
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  EXPECT_EQ(dataset->timestamp(0), 5.0);
  EXPECT_EQ(dataset->ground_truth()->front().T_wc.translation.z(), 1.0);
  EXPECT_EQ(dataset->notes().size(), 2U);
  nn::write_file(sequence() / "times.txt", "5\n6\n");
  expect_refused({"times.txt", "times of 3 frames, or of frames 0 to 3", "found 2"});
  fs::remove(sequence() / "times.txt");
  expect_refused({"times.txt", "--rate HZ", "no such file"});
}

TEST_F(Kitti, BrokenPosesAreRefused) {
  const fs::path poses = root() / "poses/07.txt";
  const std::string pose = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  nn::write_file(poses, pose + pose);
  expect_refused({"poses/07.txt", "poses of 4 frames", "found 2"});
  nn::write_file(poses, pose + "1 0 0 nan 0 1 0 0 0 0 1 0\n" + pose + pose);
  expect_refused({"poses/07.txt:2", "finite", "nan"});
  nn::write_file(poses, pose + pose + pose + "2 0 0 0 0 1 0 0 0 0 1 0\n");
  expect_refused({"poses/07.txt:4", "a rotation matrix"});
}

TEST_F(Kitti, ImagesOfDifferentSizesAreRefused) {
  test::write_mat(image(1, 0), cv::Mat(60, 81, CV_8UC1, cv::Scalar(0)));
  expect_refused({"image_1/000000.png", "80 x 60", "81 x 60"});
  make_images("07", 0, CV_8UC1);
  test::write_mat(image(0, 2), cv::Mat(61, 80, CV_8UC1, cv::Scalar(0)));
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  dataset->load(1);
  expect_error<InputError>([&] { dataset->load(2); }, {"image_0/000002.png", "80 x 60", "80 x 61"});
}

TEST_F(Kitti, TornImageIsRefusedWhenItsFrameIsLoaded) {
  const std::string bytes = nn::read_file(image(1, 3), "an image");
  nn::write_file(image(1, 3), bytes.substr(0, bytes.size() / 2));
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  expect_error<InputError>([&] { dataset->load(3); }, {"image_1/000003.png", "complete PNG"});
}

TEST(FrameRange, IsReadLikeAPythonSlice) {
  EXPECT_EQ(parse_frame_range("10:20").size(100, ""), 10);
  EXPECT_EQ(parse_frame_range("10:").size(100, ""), 90);
  EXPECT_EQ(parse_frame_range(":20").size(100, ""), 20);
  EXPECT_EQ(parse_frame_range(":").size(100, ""), 100);
  for (const char* text : {"", "5", "a:b", "-1:5", "1:2:3", "5:5", "6:5", "1.5:3", "1:99999999999", " 1:2"}) {
    expect_error<UsageError>([&] { parse_frame_range(text); }, {std::string("'") + text + "'"});
  }
}

TEST(KittiRealData, Sequence00IsReadFromTheRoot) {
  PENUMBRA_REAL_DATA(root, "kitti");
  DatasetOptions options;
  options.sequence = "00";
  options.frames = parse_frame_range("10:40");
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root, options);
  EXPECT_EQ(dataset->name(), "KITTI odometry 00");
  EXPECT_EQ(dataset->size(), 30);
  EXPECT_EQ(dataset->camera().width, 1241);
  EXPECT_EQ(dataset->camera().height, 376);
  EXPECT_DOUBLE_EQ(dataset->camera().fx, 718.856);
  EXPECT_NEAR(dataset->camera().baseline, 0.53716, 1e-5);
  ASSERT_TRUE(dataset->ground_truth().has_value());
  EXPECT_EQ(dataset->ground_truth()->size(), 30U);
  const StereoImages images = dataset->load(5);
  EXPECT_EQ(images.index, 15);
  EXPECT_EQ(images.timestamp, dataset->timestamp(5));
  EXPECT_EQ(images.right.width(), 1241);
}

TEST(KittiRealData, Sequence06IsReadFromItsOwnFolder) {
  PENUMBRA_REAL_DATA(folder, "kitti/sequences/06/");
  const std::unique_ptr<StereoDataset> dataset = open_dataset(folder);
  EXPECT_EQ(dataset->name(), "KITTI odometry 06");
  EXPECT_EQ(dataset->size(), 51);
  EXPECT_TRUE(dataset->ground_truth().has_value());
}

}  // namespace
}  // namespace penumbra::slam
