#include "slam/world/sequence_files.h"

#include <nlohmann/json.hpp>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/image/image_file.h"
#include "slam/world/ground_truth_images.h"

namespace penumbra::slam::synthetic {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPendingImages = 24;

}  // namespace

void prepare_folder(const fs::path& folder, bool overwrite, const std::vector<fs::path>& written) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    throw UsageError(fmt::format("{}: expected a folder, found a file", folder.string()));
  }
  if (!fs::exists(folder, error) || fs::is_empty(folder, error)) return;
  if (!overwrite) {
    throw UsageError(
        fmt::format("{}: expected a new or empty folder, found one with files; "
                    "--overwrite replaces the sequence in it",
                    folder.string()));
  }
  for (const fs::path& path : written) fs::remove_all(folder / path, error);
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(fmt::format("{}: cannot make the folder: {}", folder.string(), error.message()));
}

void make_folders(const fs::path& folder, std::span<const FrameOutput> outputs) {
  for (const FrameOutput& output : outputs) {
    if (output.wanted) make_folder(folder / output.name);
  }
}

void write_instance_list(const fs::path& path, const World& world) {
  nlohmann::ordered_json instances = nlohmann::ordered_json::object();
  for (const Object& object : world.objects) {
    if (object.instance == 0) continue;
    instances[std::to_string(object.instance)] = {{"class", name_of(object.object_class)},
                                                  {"moving", object.motion.moves}};
  }
  nn::write_file(path, instances.dump(1) + "\n");
}

ImageWriter::ImageWriter(int threads) {
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
}

ImageWriter::~ImageWriter() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    jobs_.clear();
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ImageWriter::write(fs::path path, const AnyImage& image) {
  Job job{std::move(path), std::visit([](const auto& own) { return AnyImage(own.clone()); }, image)};
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return jobs_.size() < kPendingImages || failure_; });
  if (failure_) std::rethrow_exception(failure_);
  jobs_.push_back(std::move(job));
  changed_.notify_all();
}

void ImageWriter::write(const fs::path& folder, std::span<const FrameOutput> outputs, const std::string& file,
                        bool is_last_frame) {
  for (const FrameOutput& output : outputs) {
    if (output.wanted && !(output.needs_next_frame && is_last_frame))
      write(folder / output.name / file, output.image());
  }
}

void ImageWriter::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return (jobs_.empty() && busy_ == 0) || failure_; });
  if (failure_) std::rethrow_exception(failure_);
}

void ImageWriter::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stop_ || !jobs_.empty(); });
    if (stop_) return;
    const Job job = std::move(jobs_.front());
    jobs_.pop_front();
    ++busy_;
    lock.unlock();
    std::exception_ptr failure;
    try {
      std::visit([&](const auto& image) { nn::write_image(job.path, image.view()); }, job.image);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    --busy_;
    if (failure && !failure_) failure_ = failure;
    changed_.notify_all();
  }
}

void write_whole_masks(ImageWriter& images, const fs::path& folder,
                       const std::vector<InstanceMasks>& instances, const Size& size) {
  make_folder(folder);
  for (const InstanceMasks& instance : instances) {
    images.write(folder / fmt::format("{:05d}.png", instance.instance), mask_image(instance.whole, size));
  }
}

}  // namespace penumbra::slam::synthetic
