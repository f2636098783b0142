#include "nn/base/inflate.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <optional>
#include <random>
#include <string>
#include <vector>

namespace penumbra {
namespace {

// Bytes of several kinds: noise, few values, runs, mostly zeros, repetitions.
std::vector<std::uint8_t> some_bytes(std::mt19937& random) {
  std::vector<std::uint8_t> bytes(random() % 5000);
  const unsigned kind = random() % 5, period = 1 + random() % 40;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto noise = static_cast<std::uint8_t>(random());
    switch (kind) {
      case 0:
        bytes[i] = noise;
        break;
      case 1:
        bytes[i] = noise % 3;
        break;
      case 2:
        bytes[i] = i == 0 || random() % 7 == 0 ? noise : bytes[i - 1];
        break;
      case 3:
        bytes[i] = random() % 50 == 0 ? noise : std::uint8_t{0};
        break;
      default:
        bytes[i] = i < period || random() % 9 == 0 ? noise : bytes[i - period];
    }
  }
  return bytes;
}

// Packed by zlib, with any of its levels (0: stored) and strategies, sometimes in several blocks.
std::string packed(std::vector<std::uint8_t> bytes, std::mt19937& random) {
  z_stream z{};
  deflateInit2(&z, static_cast<int>(random() % 10), Z_DEFLATED, 15, 8, static_cast<int>(random() % 5));
  std::string out(deflateBound(&z, bytes.size()) + 100, '\0');
  z.next_in = bytes.data();
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  const std::size_t first = random() % 2 == 0 ? bytes.size() / 2 : 0;
  z.avail_in = static_cast<uInt>(first);
  if (first > 0) deflate(&z, Z_FULL_FLUSH);
  z.avail_in += static_cast<uInt>(bytes.size() - first);
  deflate(&z, Z_FINISH);
  out.resize(z.total_out);
  deflateEnd(&z);
  return out;
}

using Unpacked = std::optional<std::vector<std::uint8_t>>;

// The oracle: nothing where zlib finds something wrong, or another size, or more behind the stream.
Unpacked by_zlib(std::string stream, std::size_t size) {
  std::vector<std::uint8_t> out(size + 1);
  z_stream z{};
  inflateInit(&z);
  z.next_in = reinterpret_cast<Bytef*>(stream.data());
  z.avail_in = static_cast<uInt>(stream.size());
  z.next_out = out.data();
  z.avail_out = static_cast<uInt>(out.size());
  const bool ends = inflate(&z, Z_FINISH) == Z_STREAM_END && z.total_out == size && z.avail_in == 0;
  inflateEnd(&z);
  out.resize(size);
  return ends ? Unpacked(std::move(out)) : std::nullopt;
}

Unpacked by_us(const std::string& stream, std::size_t size) {
  std::vector<std::uint8_t> out(size + kInflateSlack);
  const std::vector<char> exactly(stream.begin(), stream.end());  // for sanitizers: not a byte behind it
  if (!inflate_all({exactly.data(), exactly.size()}, out.data(), size)) return std::nullopt;
  out.resize(size);
  return out;
}

TEST(Inflate, UnpacksWhatZlibPacks) {
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    const std::vector<std::uint8_t> bytes = some_bytes(random);
    const std::string stream = packed(bytes, random);
    ASSERT_EQ(by_us(stream, bytes.size()), Unpacked(bytes)) << i;
    ASSERT_EQ(by_us(stream, bytes.size() + 1), std::nullopt) << i;
    if (!bytes.empty()) {
      ASSERT_EQ(by_us(stream, bytes.size() - 1), std::nullopt) << i;
    }
  }
}

TEST(Inflate, OfDamagedStreamsAgreesWithZlib) {
  std::mt19937 random(2);
  for (int i = 0; i < 6000; ++i) {
    const std::vector<std::uint8_t> bytes = some_bytes(random);
    std::string stream = packed(bytes, random);
    const std::size_t at = random() % stream.size();
    if (i % 3 == 0) stream[at] = static_cast<char>(stream[at] ^ (1 << random() % 8));
    if (i % 3 == 1) stream.resize(at);
    if (i % 3 == 2) stream.insert(at, 1, static_cast<char>(random()));
    ASSERT_EQ(by_us(stream, bytes.size()), by_zlib(stream, bytes.size())) << i;
  }
}

// Noise as blocks of codes: never more than an answer.
TEST(Inflate, OfNoiseAgreesWithZlib) {
  std::mt19937 random(3);
  for (int i = 0; i < 20000; ++i) {
    std::string stream(2 + random() % 200, '\0');
    for (char& byte : stream) byte = static_cast<char>(random());
    stream[0] = '\x78';
    stream[1] = '\x01';
    if (stream.size() > 2) stream[2] = static_cast<char>((stream[2] & 0xF8) | 0x05);  // last, its own codes
    ASSERT_EQ(by_us(stream, 100), by_zlib(stream, 100)) << i;
  }
}

TEST(Inflate, RefusesWhatIsTooShortOrHasNoHeader) {
  for (const std::string& stream :
       {std::string(), std::string("\x78"), std::string("\x78\x01\x03\x00\x00", 5)})
    EXPECT_EQ(by_us(stream, 0), std::nullopt);
  EXPECT_NE(by_us(std::string("\x78\x01\x03\x00\x00\x00\x00\x01", 8), 0), std::nullopt) << "nothing, packed";
  EXPECT_EQ(by_us(std::string("\x78\x02\x03\x00\x00\x00\x00\x01", 8), 0), std::nullopt);
}

}  // namespace
}  // namespace penumbra
