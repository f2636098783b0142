// Writes a street sequence as KITTI odometry lays its own out.
#include <cmath>
#include <exception>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "nn/base/error.h"
#include "nn/io/file.h"
#include "slam/datasets/synthetic/coco_annotations.h"
#include "slam/datasets/synthetic/street_sequence.h"

namespace penumbra::slam::synthetic {

namespace {

namespace fs = std::filesystem;

void write_png(const fs::path& path, const cv::Mat& image) {
  // Noise hardly compresses: the fastest level costs 5 % of size and saves most of the time.
  static const std::vector<int> kFast{cv::IMWRITE_PNG_COMPRESSION, 1};
  bool written = false;
  try {
    written = cv::imwrite(path.string(), image, kFast);
  } catch (const cv::Exception&) {
  }
  if (!written) throw Error(fmt::format("{}: cannot write the image", path.string()));
}

std::string row_of(const SE3& pose) {
  std::string row;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) row += fmt::format("{:.9e} ", pose.rotation(r, c));
    row += fmt::format("{:.9e}{}", pose.translation[r], r < 2 ? " " : "\n");
  }
  return row;
}

void write_calibration(const fs::path& path, const StereoCamera& camera) {
  std::string text;
  for (int number = 0; number < 4; ++number) {
    // The colour cameras stand where the grey ones do.
    const double offset = number % 2 == 0 ? 0.0 : -camera.fx * camera.baseline;
    text += fmt::format("P{}: {:.12e} 0 {:.12e} {:.12e} 0 {:.12e} {:.12e} 0 0 0 1 0\n", number, camera.fx,
                        camera.cx, offset, camera.fy, camera.cy);
  }
  nn::write_file(path, text);
}

void write_trajectory(const fs::path& poses_path, const fs::path& times_path, const Trajectory& poses) {
  std::string rows, times;
  const SE3 first_from_world = poses.front().T_wc.inverse();
  for (const TimedPose& pose : poses) {
    rows += row_of(first_from_world * pose.T_wc);
    times += fmt::format("{:.6e}\n", pose.timestamp);
  }
  nn::write_file(poses_path, rows);
  nn::write_file(times_path, times);
}

void write_instances(const fs::path& path, const World& world) {
  nlohmann::ordered_json instances = nlohmann::ordered_json::object();
  for (const Object& object : world.objects) {
    if (object.instance == 0) continue;
    instances[std::to_string(object.instance)] = {{"class", name_of(object.object_class)},
                                                  {"moving", object.motion.moves}};
  }
  nn::write_file(path, instances.dump(1) + "\n");
}

cv::Mat1w encode_depth(const cv::Mat1f& depth) {
  cv::Mat1w encoded(depth.size());
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      const float value = std::round(256.0F * depth(row, column));
      encoded(row, column) = value < 65535.5F ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
    }
  }
  return encoded;
}

// Makes `folder` ready: empty, or cleared of what an earlier run wrote.
void prepare_folder(const fs::path& folder, bool overwrite) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    throw UsageError(fmt::format("{}: expected a folder, found a file", folder.string()));
  }
  if (fs::exists(folder, error) && !fs::is_empty(folder, error)) {
    if (!overwrite) {
      throw UsageError(
          fmt::format("{}: expected a new or empty folder, found one with files; "
                      "--overwrite replaces the sequence in it",
                      folder.string()));
    }
    const fs::path sequence = folder / "sequences/00";
    for (const char* name : {"image_0", "image_1", "image_2", "image_3", "instances", "depth"}) {
      fs::remove_all(sequence / name, error);
    }
    fs::remove(folder / "annotations/instances.json", error);
  }
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(fmt::format("{}: cannot make the folder: {}", folder.string(), error.message()));
}

}  // namespace

void write_kitti_layout(StreetSequence& sequence, const fs::path& folder, bool overwrite,
                        const std::function<void(int)>& progress) {
  prepare_folder(folder, overwrite);
  const fs::path root = folder / "sequences/00";
  StreetFrame frame;
  struct Output {
    fs::path folder;
    const cv::Mat* image;
  };
  std::vector<Output> outputs{{root / "image_0", &frame.left_grey},
                              {root / "image_1", &frame.right_grey},
                              {root / "instances", &frame.left.instance}};
  if (sequence.settings().colour) {
    outputs.push_back({root / "image_2", &frame.left_bgr});
    outputs.push_back({root / "image_3", &frame.right_bgr});
  }
  cv::Mat depth;
  if (sequence.settings().depth) outputs.push_back({root / "depth", &depth});
  for (const Output& output : outputs) make_folder(output.folder);
  make_folder(folder / "poses");
  if (sequence.settings().annotations) make_folder(folder / "annotations");
  write_calibration(root / "calib.txt", sequence.camera());
  write_trajectory(folder / "poses/00.txt", root / "times.txt", sequence.poses());
  write_instances(root / "instances.json", sequence.world());

  CocoWriter annotations(sequence.settings().size);
  for (int i = 0; i < sequence.size(); ++i) {
    sequence.render(i, frame);
    if (sequence.settings().depth) depth = encode_depth(frame.left.depth);
    const std::string name = fmt::format("{:06d}.png", i);
    if (sequence.settings().annotations) {
      const char* images = sequence.settings().colour ? "image_2" : "image_0";
      annotations.add(fmt::format("sequences/00/{}/{}", images, name), frame.instances);
    }
    std::exception_ptr failure;
    const int count = static_cast<int>(outputs.size());
#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < count; ++k) {
      const Output& output = outputs[static_cast<std::size_t>(k)];
      try {
        write_png(output.folder / name, *output.image);
      } catch (...) {
#pragma omp critical
        failure = std::current_exception();
      }
    }
    if (failure) std::rethrow_exception(failure);
    if (progress) progress(i + 1);
  }
  if (sequence.settings().annotations) {
    nn::write_file(folder / "annotations/instances.json", annotations.finish());
  }
}

}  // namespace penumbra::slam::synthetic
