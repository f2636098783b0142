#include "slam/sources/bag/bag_folder.h"

#include <algorithm>
#include <system_error>

#include "nn/base/error.h"
#include "nn/base/natural_order.h"
#include "nn/base/text.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

bool ends_with(const fs::path& path, std::initializer_list<std::string_view> endings) {
  const std::string name = lower_case(path.filename().string());
  return std::any_of(endings.begin(), endings.end(), [&](std::string_view e) { return name.ends_with(e); });
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (ends_with(at->path(), {".mcap", ".db3", ".mcap.zstd", ".db3.zstd"})) files.push_back(at->path());
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

class BagFolder final : public MessageSource {
 public:
  explicit BagFolder(const fs::path& folder) {
    for (const fs::path& file : files_in(folder)) {
      if (ends_with(file, {".zstd"}))
        throw InputError(file.string(), "a file that is not compressed as a whole (zstd -d unpacks it)",
                         "rosbag2's compression of files");
      files_.push_back(open_bag(file));
    }
  }

  std::string kind() const override {
    return files_.size() == 1 ? files_.front()->kind()
                              : fmt::format("{} in {} files", files_.front()->kind(), files_.size());
  }

  void read_all(const Take& take) override {
    for (std::size_t file = 0; file < files_.size(); ++file) {
      std::vector<std::size_t> places;  // of the file's topics among those of all
      files_[file]->read_all([&](const Message& message) {
        const std::vector<Topic>& topics = files_[file]->topics();
        while (places.size() < topics.size()) {
          const Topic& t = topics[places.size()];
          places.push_back(topic_place(t.name, t.type, t.encoding));
        }
        Message joined = message;
        joined.topic = places[message.topic];
        joined.place.file = static_cast<std::uint32_t>(file);
        count(joined.topic, message.record_time);
        take(joined);
      });
      notes_.insert(notes_.end(), files_[file]->notes().begin(), files_[file]->notes().end());
    }
  }

  std::string_view read(const MessagePlace& place) override { return files_.at(place.file)->read(place); }

 private:
  std::vector<std::unique_ptr<MessageSource>> files_;
};

}  // namespace

bool is_bag_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path / "metadata.yaml", error) && !files_in(path).empty();
}

std::unique_ptr<MessageSource> open_bag_folder(const fs::path& path) {
  return std::make_unique<BagFolder>(path);
}

}  // namespace penumbra::slam
