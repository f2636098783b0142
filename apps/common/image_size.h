// Sizes of images on the command line: WIDTHxHEIGHT, such as 620x188.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

namespace penumbra::apps {

// Nothing where `text` is not two numbers of at most five digits with an x between them. What a size may be
// is for the caller to say.
std::optional<cv::Size> parse_image_size(const std::string& text);

}  // namespace penumbra::apps
