#include "slam/sources/recorded_sequence.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/text.h"
#include "nn/image/exif.h"
#include "slam/geometry/association.h"
#include "slam/sources/camera_check.h"
#include "slam/sources/image_levels.h"
#include "slam/sources/row_check.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

constexpr int kPairsLookedAt = 3;  // for their rows
constexpr double kLongGap = 1.8;   // times the usual step between two frames

// The left half of an image, 0, or its right half, 1.
ByteImage half_of(const ByteImage& image, int side) {
  const int width = image.width() / 2, step = image.channels();
  ByteImage half(width, image.height(), step);
  for (int y = 0; y < half.height(); ++y)
    std::copy_n(image.row(y) + side * width * step, width * step, half.row(y));
  return half;
}

class RecordedSequence final : public StereoDataset {
 public:
  RecordedSequence(Recording recording, const DatasetOptions& options) : r_(std::move(recording)) {
    if (r_.frames.empty()) throw InputError(r_.place, "frames", "none");
    const int count = options.frames.size(static_cast<int>(r_.frames.size()), r_.place);
    std::vector<RecordedFrame> chosen;
    for (int i = 0; i < count; i += options.step) {
      chosen.push_back(r_.frames[static_cast<std::size_t>(options.frames.begin + i)]);
    }
    r_.frames = std::move(chosen);
    leave_out_repeated_times();
    check_times();
    choose_ground_truth();
    const int readable = first_readable();
    look_at_images(readable, options);
    size_is_given_ = r_.camera.width > 0;
    if (!size_is_given_) {
      const ByteImage image = read(frame(readable).left);
      const Size size = r_.side_by_side ? half_of(image, 0).size() : image.size();
      r_.camera.width = size.width;
      r_.camera.height = size.height;
    }
    for (std::string& text : check_camera(r_.camera, !r_.left.is_identity()))
      r_.notes.push_back(std::move(text));
    check_rows(readable);
  }

  std::string name() const override { return r_.name; }
  const StereoCamera& camera() const override { return r_.camera; }
  Sensor sensor() const override { return r_.sensor; }
  int size() const override { return static_cast<int>(r_.frames.size()); }
  int frame_number(int i) const override { return frame(i).index; }
  double timestamp(int i) const override { return frame(i).timestamp; }
  const std::optional<Trajectory>& ground_truth() const override { return ground_truth_; }
  const std::vector<Mounting>& mountings() const override { return r_.mountings; }
  const std::vector<std::string>& notes() const override { return r_.notes; }

  StereoImages load(int i) const override {
    const RecordedFrame& f = frame(i);
    StereoImages images;
    images.index = f.index;
    images.timestamp = f.timestamp;
    ByteImage first = read(f.left);
    if (r_.side_by_side) {
      images.left = r_.left.linear(checked(half_of(first, 0), f.left));
      images.right = r_.right.linear(checked(half_of(first, 1), f.left));
      return images;
    }
    images.left = r_.left.linear(checked(std::move(first), f.left));
    if (r_.sensor == Sensor::stereo) {
      images.right = r_.right.linear(checked(read(f.second), f.second));
    } else {
      images.depth_delay = f.depth_delay;
      images.depth = r_.left.nearest(checked(r_.images->depth(f.second), f.second));
    }
    return images;
  }

 private:
  const RecordedFrame& frame(int i) const { return r_.frames[static_cast<std::size_t>(i)]; }

  ByteImage read(const ImageKey& key) const { return levels_.read(*r_.images, key, r_.colour); }

  template <class T>
  Image<T> checked(Image<T> image, const ImageKey& key) const {
    if (image.width() != r_.camera.width || image.height() != r_.camera.height) {
      throw InputError(r_.images->name(key),
                       fmt::format("{} x {} pixels as in {}", r_.camera.width, r_.camera.height,
                                   size_is_given_ ? "the calibration" : "the first left image"),
                       fmt::format("{} x {}", image.width(), image.height()));
    }
    return image;
  }

  // Of frames with one time the first stays: no motion fits two places at once.
  void leave_out_repeated_times() {
    const auto is_repeated = [](const RecordedFrame& a, const RecordedFrame& b) {
      return a.timestamp == b.timestamp;
    };
    const auto first = std::adjacent_find(r_.frames.begin(), r_.frames.end(), is_repeated);
    if (first == r_.frames.end()) return;
    const std::string name = fs::path(r_.images->name(std::next(first)->left)).filename().string();
    const std::size_t count = r_.frames.size();
    r_.frames.erase(std::unique(r_.frames.begin(), r_.frames.end(), is_repeated), r_.frames.end());
    r_.notes.push_back(fmt::format("left out: {} with the time of the frame before, first {}",
                                   counted(count - r_.frames.size(), "frame"), printable(name, 60)));
  }

  // The first frame whose images can be read, which shows what all are like: torn ones before it cost only
  // themselves. Throws what the first frame's images say where none of the first few can be.
  int first_readable() const {
    constexpr int kTried = 10;
    std::exception_ptr reason;
    for (int i = 0; i < std::min(kTried, size()); ++i) {
      try {
        r_.images->read(frame(i).left, r_.colour, nn::ImageBits::stored);
        if (r_.sensor == Sensor::stereo) r_.images->read(frame(i).second, r_.colour, nn::ImageBits::stored);
        return i;
      } catch (const InputError&) {
        if (!reason) reason = std::current_exception();
      }
    }
    std::rethrow_exception(reason);
  }

  // What is to be known about the files before their pixels are read, from the frame `begin` on.
  void look_at_images(int begin, const DatasetOptions& options) {
    std::vector<ImageKey> images;
    for (int i = begin; i < size(); ++i) {
      images.push_back(frame(i).left);
      if (r_.sensor == Sensor::stereo) images.push_back(frame(i).second);
    }
    levels_ = ImageLevels(*r_.images, images, options.image_bits, r_.notes);
    const int orientation = r_.images->info(images.front()).orientation;
    if (orientation != nn::kUpright) {
      r_.notes.push_back(
          fmt::format("{}: EXIF says that the camera was turned (orientation {}); images are taken as "
                      "the sensor has them, as the calibration is",
                      r_.images->name(images.front()), orientation));
    }
  }

  void check_times() {
    std::vector<double> steps;
    for (std::size_t i = 1; i < r_.frames.size(); ++i) {
      const double before = r_.frames[i - 1].timestamp, now = r_.frames[i].timestamp;
      if (!(now > before)) {
        throw InputError(r_.images->name(r_.frames[i].left), fmt::format("a time after {:.6f} s", before),
                         fmt::format("{:.6f} s", now));
      }
      steps.push_back(now - before);
    }
    if (steps.size() < 2) return;
    std::vector<double> ordered = steps;
    const std::size_t middle = (ordered.size() - 1) / 2;
    std::nth_element(ordered.begin(), ordered.begin() + static_cast<std::ptrdiff_t>(middle), ordered.end());
    const double usual = ordered[middle];
    const auto is_long = [&](double step) { return step > kLongGap * usual; };
    const auto gaps = std::count_if(steps.begin(), steps.end(), is_long);
    if (gaps == 0) return;
    const auto longest = std::max_element(steps.begin(), steps.end());
    r_.notes.push_back(fmt::format(
        "frames are missing in {}: the longest gap, of {:.3g} s, is after frame {}; "
        "frames are usually {:.3g} s apart",
        counted(gaps, "place"), *longest, frame(static_cast<int>(longest - steps.begin())).index, usual));
  }

  // One pair tells, if it shows enough; the second and third are looked at where it does not.
  // The first must be of the camera's size (InputError).
  void check_rows(int begin) {
    const StereoImages first = load(begin);
    if (r_.sensor != Sensor::stereo) return;
    RowOffsets rows;
    rows.add(first.left, first.right);
    for (int i = begin + 1; i < std::min(begin + kPairsLookedAt, size()) && !rows.is_enough(); ++i) {
      try {
        const StereoImages images = load(i);
        rows.add(images.left, images.right);
      } catch (const InputError&) {
        continue;  // for the run to report
      }
    }
    if (const std::optional<RowOffsets::Disagreement> found = rows.disagreement()) {
      r_.notes.push_back(
          fmt::format("the rows of left and right images disagree: of {} features that look alike the median "
                      "is {:.1f} pixels "
                      "apart vertically (with its sign {:+.1f}, downwards in the right image). Are the "
                      "images not rectified, is "
                      "the rotation of T_right_left transposed, or the calibration another camera's?",
                      rows.offsets.size(), found->median_length, found->median));
    }
  }

  void choose_ground_truth() {
    if (r_.ground_truth.empty()) return;
    std::vector<double> frame_times, pose_times;
    for (const RecordedFrame& f : r_.frames) frame_times.push_back(f.timestamp);
    for (const TimedPose& pose : r_.ground_truth) pose_times.push_back(pose.timestamp);
    const std::vector<TimePair> pairs = associate_times(frame_times, pose_times, kMaxTimeDifference);
    if (pairs.empty()) {
      r_.notes.push_back(
          fmt::format("no ground truth: its times ({:.3f}..{:.3f} s) are not those of the frames "
                      "({:.3f}..{:.3f} s)",
                      pose_times.front(), pose_times.back(), frame_times.front(), frame_times.back()));
      return;
    }
    ground_truth_.emplace();
    for (const TimePair& pair : pairs) {
      ground_truth_->push_back({frame_times[pair.first], r_.ground_truth[pair.second].T_wc});
    }
    r_.ground_truth.clear();
  }

  Recording r_;
  ImageLevels levels_;
  bool size_is_given_ = false;
  std::optional<Trajectory> ground_truth_;
};

}  // namespace

std::unique_ptr<StereoDataset> open_recording(Recording recording, const DatasetOptions& options) {
  return std::make_unique<RecordedSequence>(std::move(recording), options);
}

void note_unused_rate(std::optional<double> rate, const fs::path& source, std::vector<std::string>& notes) {
  if (rate)
    notes.push_back(
        fmt::format("{}: has times, which are used, and not --rate {:g}", source.string(), *rate));
}

nn::ImageColour colour_of(DatasetCameras cameras, nn::ImageColour otherwise) {
  switch (cameras) {
    case DatasetCameras::grey:
      return nn::ImageColour::grey;
    case DatasetCameras::colour:
      return nn::ImageColour::bgr;
    case DatasetCameras::automatic:
      break;
  }
  return otherwise;
}

}  // namespace penumbra::slam
