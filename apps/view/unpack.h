// Unpacks what the program carries in itself.
#pragma once

#include <string>

namespace penumbra::apps {

// The content of one gzip member at [begin, end). Throws Error where it is not that.
std::string unpack_gzip(const unsigned char* begin, const unsigned char* end);

}  // namespace penumbra::apps
