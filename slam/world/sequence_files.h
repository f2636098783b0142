// What the writers of both layouts share: making the output folder ready and writing images.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "nn/image/image.h"
#include "slam/world/instance_masks.h"
#include "slam/world/world.h"

namespace penumbra::slam::synthetic {

using AnyImage = std::variant<ByteImage, WordImage>;

// One kind of image that a layout has of each frame.
struct FrameOutput {
  std::string name;  // of its folder
  bool wanted;
  std::function<AnyImage()> image;  // of the frame that was rendered last
  bool needs_next_frame = false;    // the last frame has none
};

// Makes `folder` ready: it must be missing or empty, unless `overwrite`; then `written` (paths inside it,
// what an earlier run wrote) is removed. Throws UsageError otherwise.
void prepare_folder(const std::filesystem::path& folder, bool overwrite,
                    const std::vector<std::filesystem::path>& written);
// Throws Error where it cannot be made.
void make_folder(const std::filesystem::path& folder);
// One for each kind of image that is wanted.
void make_folders(const std::filesystem::path& folder, std::span<const FrameOutput> outputs);
// {"17": {"class": "car", "moving": false}, ...}
void write_instance_list(const std::filesystem::path& path, const World& world);

// Encodes and writes PNG files on threads of its own while the caller renders the next frame.
class ImageWriter {
 public:
  explicit ImageWriter(int threads);
  ~ImageWriter();  // drops what has not been written
  ImageWriter(const ImageWriter&) = delete;
  ImageWriter& operator=(const ImageWriter&) = delete;

  // Takes a copy of `image`. Waits while many images are pending; throws the Error of an earlier failure.
  void write(std::filesystem::path path, const AnyImage& image);
  // The wanted images of a frame, as folder / NAME / file.
  void write(const std::filesystem::path& folder, std::span<const FrameOutput> outputs,
             const std::string& file, bool is_last_frame);
  // Waits until all is written; throws the first failure.
  void finish();

 private:
  struct Job {
    std::filesystem::path path;
    AnyImage image;
  };
  void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  int busy_ = 0;
  bool stop_ = false;
  std::exception_ptr failure_;
  std::vector<std::thread> threads_;
};

// folder/IIIII.png for every instance I: 8 bits, 255 on the whole of it. Makes the folder.
void write_whole_masks(ImageWriter& images, const std::filesystem::path& folder,
                       const std::vector<InstanceMasks>& instances, const Size& size);

}  // namespace penumbra::slam::synthetic
