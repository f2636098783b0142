#include "apps/common/image_size.h"

#include <cstdio>

namespace penumbra::apps {

std::optional<Size> parse_image_size(const std::string& text) {
  int width = 0, height = 0, used = 0;
  // Up to five digits each, so that no number overflows.
  if (std::sscanf(text.c_str(), "%5dx%5d%n", &width, &height, &used) != 2 ||
      used != static_cast<int>(text.size())) {
    return std::nullopt;
  }
  return Size{width, height};
}

}  // namespace penumbra::apps
