#include "nn/base/crc32.h"

#include <libdeflate.h>

namespace penumbra::nn {

std::uint32_t crc32(std::string_view bytes, std::uint32_t crc) {
  return ::libdeflate_crc32(crc, bytes.data(), bytes.size());
}

}  // namespace penumbra::nn
