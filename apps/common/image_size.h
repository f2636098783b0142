// Sizes of images on the command line: WIDTHxHEIGHT, such as 620x188.
#pragma once

#include <optional>
#include <string>

#include "nn/image/image.h"

namespace penumbra::apps {

// Nothing where `text` is not two numbers of at most five digits with an x between them. What a size may be
// is for the caller to say.
std::optional<Size> parse_image_size(const std::string& text);

}  // namespace penumbra::apps
