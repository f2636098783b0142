#include "apps/view/unpack.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <vector>

#include "apps/view/embedded_files.h"
#include "nn/base/error.h"

namespace penumbra::apps {
namespace {

std::vector<unsigned char> gzip_of(std::string text) {
  std::vector<unsigned char> packed(compressBound(static_cast<uLong>(text.size())) + 32);
  z_stream stream = {};
  deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<unsigned char*>(text.data());
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = packed.data();
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

std::string unpacked(const std::vector<unsigned char>& packed) {
  return unpack_gzip(packed.data(), packed.data() + packed.size());
}

TEST(Unpack, GivesBackWhatWasPacked) {
  for (const std::size_t size : {0U, 1U, 100'000U}) {
    const std::string text(size, 'x');
    EXPECT_EQ(unpacked(gzip_of(text)), text);
  }
}

TEST(Unpack, RefusesDamage) {
  const std::vector<unsigned char> whole = gzip_of("every light leaves a penumbra");
  EXPECT_THROW(unpacked({whole.begin(), whole.begin() + 9}), Error);
  EXPECT_THROW(unpacked({whole.begin(), whole.end() - 9}), Error);
  std::vector<unsigned char> damaged = whole;
  damaged[damaged.size() - 6] ^= 1;  // its checksum
  EXPECT_THROW(unpacked(damaged), Error);
}

TEST(Unpack, TheProgramCarriesItsFilesWhole) {
  EXPECT_EQ(embedded::page_html().substr(0, 15), "<!DOCTYPE html>");
  EXPECT_NE(embedded::three_js().find("REVISION"), std::string_view::npos);
  EXPECT_NE(embedded::licences().find("three.js"), std::string_view::npos);
}

}  // namespace
}  // namespace penumbra::apps
