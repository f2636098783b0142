#include "apps/view/unpack.h"

#include <zlib.h>

#include "nn/base/error.h"

namespace penumbra::apps {

std::string unpack_gzip(const unsigned char* begin, const unsigned char* end) {
  constexpr std::size_t kHeader = 10, kTrailer = 8;  // the last four bytes are the content's size
  if (static_cast<std::size_t>(end - begin) < kHeader + kTrailer) throw Error("packed file: too short");
  std::string text(end[-4] | end[-3] << 8 | end[-2] << 16 | static_cast<std::size_t>(end[-1]) << 24, '\0');
  z_stream stream = {};
  stream.next_in = const_cast<unsigned char*>(begin);  // zlib reads it only
  stream.avail_in = static_cast<uInt>(end - begin);
  stream.next_out = reinterpret_cast<unsigned char*>(text.data());
  stream.avail_out = static_cast<uInt>(text.size());
  constexpr int kGzip = 16;
  int status = inflateInit2(&stream, MAX_WBITS + kGzip);
  if (status == Z_OK) status = inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  if (status != Z_STREAM_END || stream.total_out != text.size()) throw Error("packed file: damaged");
  return text;
}

}  // namespace penumbra::apps
