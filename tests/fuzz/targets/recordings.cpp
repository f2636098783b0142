// Readers of robots' recordings, and of the messages in them.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <system_error>

#include "slam/sources/bag/bag_index.h"
#include "slam/sources/bag/rosbag2_sqlite.h"
#include "slam/sources/bag_topics.h"
#include "slam/sources/camera_info.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/target.h"

namespace penumbra::fuzz {

namespace {

constexpr std::size_t kMostImages = 8;  // that are decoded

// Bytes in a file that has a name of its own, which SQLite must have.
class NamedFile {
 public:
  explicit NamedFile(std::string_view bytes) {
    std::error_code error;
    const std::filesystem::path memory = "/dev/shm";
    path_ = (std::filesystem::is_directory(memory, error) ? memory : std::filesystem::temp_directory_path()) /
            ("penumbra_fuzz_" + std::to_string(getpid()) + ".db3");
    std::ofstream(path_, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  ~NamedFile() {
    std::error_code error;
    std::filesystem::remove(path_, error);
  }
  NamedFile(const NamedFile&) = delete;
  NamedFile& operator=(const NamedFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void require_camera(const slam::RecordedCamera& made) {
  require(std::isfinite(made.camera.fx) && made.camera.fx > 0.0, "focal lengths are positive");
  require(std::isfinite(made.camera.baseline) && made.camera.baseline > 0.0, "baselines are positive");
  require(made.camera.width >= 0 && made.camera.height >= 0, "sizes are not negative");
}

template <class Image>
void decode(const Image& image) {
  const std::string place = "message";
  is_read([&] {
    const nn::StoredImage pixels =
        slam::pixels_of(image, nn::ImageColour::grey, nn::ImageBits::stored, place);
    require(pixels.size().width > 0 && pixels.channels() == 1, "grey images are grey");
  });
  is_read([&] { slam::pixels_of(image, nn::ImageColour::bgr, nn::ImageBits::eight, place); });
  is_read([&] { slam::info_of(image, place); });
  is_read([&] {
    const FloatImage depth = slam::depth_of(image, place);
    for (std::size_t i = 0; i < depth.elements(); ++i)
      require(std::isfinite(depth.data()[i]) && depth.data()[i] >= 0.0F, "depths are 0 or more");
  });
}

// Lenses of any size would make tables of any size.
bool is_small(const slam::CameraInfoMessage& info) {
  return std::max({info.width, info.height, info.roi_width, info.roi_height}) <= 64;
}

}  // namespace

bool read_recording(std::string_view bytes) {
  const bool needs_name = bytes.starts_with(slam::kSqliteBegins);
  std::optional<NamedFile> named;
  if (needs_name) named.emplace(bytes);
  const MemoryFile memory(needs_name ? std::string_view() : bytes);
  return is_read([&] {
    const auto source = slam::open_bag(needs_name ? named->path() : memory.path());
    const slam::BagIndex index = slam::index_bag(*source);
    for (const std::string& note : source->notes()) require_showable(note);
    std::string reason;
    is_read([&] { slam::choose_topics(index, {}, "file", reason); });
    std::size_t decoded = 0;
    for (const slam::ImageTopic& topic : index.images) {
      require(!topic.images.empty(), "topics with images have some");
      for (const slam::IndexedImage& image : topic.images) {
        if (++decoded > kMostImages) return;
        const std::string_view message = source->read(image.place);
        require(message.size() == image.place.size, "a message is as long as it was");
        if (topic.is_compressed) {
          decode(slam::read_compressed_image(message, topic.encoding, "message"));
        } else {
          decode(slam::read_image_message(message, topic.encoding, "message"));
        }
      }
    }
  });
}

// As each of the messages, in ROS 1's encoding and in CDR; read where it is one of them.
bool read_message(std::string_view bytes) {
  bool is_message = false;
  for (const slam::MessageEncoding encoding : {slam::MessageEncoding::ros1, slam::MessageEncoding::cdr}) {
    is_message |= is_read([&] { decode(slam::read_image_message(bytes, encoding, "message")); });
    is_message |= is_read([&] { decode(slam::read_compressed_image(bytes, encoding, "message")); });
    is_message |= is_read([&] {
      const slam::CameraInfoMessage info = slam::read_camera_info(bytes, encoding, "message");
      if (!is_small(info)) return;
      for (const bool is_rectified : {false, true}) {
        is_read([&] { require_camera(slam::rgbd_camera({info, "camera"}, is_rectified)); });
        is_read([&] { require_camera(slam::stereo_camera({info, "left"}, {info, "right"}, is_rectified)); });
      }
    });
  }
  return is_message;
}

}  // namespace penumbra::fuzz
