// Readers of what people write by hand: lists of class names, and --frames.
#include <algorithm>

#include "nn/base/text.h"
#include "nn/models/class_names.h"
#include "slam/sources/frame_range.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/target.h"

namespace penumbra::fuzz {

// As a file with a name a line and as the weights' metadata, for networks with about as many classes as there
// are names: most other numbers are refused at once.
bool read_class_names(std::string_view bytes) {
  const MemoryFile file(bytes);
  nn::StateDict weights;
  weights.source = "weights";
  weights.metadata["classes"] = bytes;
  const auto separators =
      std::count_if(bytes.begin(), bytes.end(), [](char c) { return c == '\n' || c == ','; });
  bool is_list = false;
  for (int classes = static_cast<int>(separators); classes <= separators + 2; ++classes) {
    for (const std::filesystem::path& path : {file.path(), std::filesystem::path()}) {
      is_list |= is_read([&] {
        const std::vector<std::string> names = nn::class_names(weights, classes, path);
        require(static_cast<int>(names.size()) == classes, "every class has a name");
        for (const std::string& name : names) {
          require(!name.empty() && name == printable(name, name.size()), "names can be shown");
        }
      });
      is_read([&] {
        const auto names = nn::output_names(weights, classes, path);
        require(static_cast<int>(names.size()) == classes, "every output has a name");
      });
    }
  }
  return is_list;
}

bool read_frame_range(std::string_view bytes) {
  return is_read([&] {
    const slam::FrameRange range = slam::parse_frame_range(bytes);
    require(range.begin >= 0 && range.end.value_or(range.begin + 1) > range.begin, "a range is not empty");
    is_read([&] {
      const int size = range.size(100, "sequence");
      require(size > 0 && range.begin + size <= 100, "a range lies in its sequence");
    });
  });
}

}  // namespace penumbra::fuzz
