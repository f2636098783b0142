#include "nn/base/checksummed_file.h"

#include "nn/base/byte_stream.h"
#include "nn/base/crc32.h"
#include "nn/base/file.h"

namespace penumbra::nn {

void write_checksummed_file(const std::filesystem::path& path, std::string_view magic, std::uint32_t version,
                            std::string_view body) {
  ByteWriter file;
  file.put_array(std::span(magic));
  file.put(version);
  file.put(crc32(body));
  file.put(static_cast<std::uint64_t>(body.size()));
  file.put_array(std::span(body));
  write_file(path, file.bytes());
}

std::string read_checksummed_file(const std::filesystem::path& path, std::string_view magic,
                                  std::uint32_t version, std::string_view what) {
  std::string bytes = read_file(path, what);
  const std::string place = path.string();
  if (bytes.substr(0, magic.size()) != magic) throw InputError(place, what, "a file that begins differently");
  ByteReader header(std::string_view(bytes).substr(magic.size()), place, magic.size());
  const auto found = header.get<std::uint32_t>("version");
  if (found != version) {
    throw InputError(place, fmt::format("version {}", version), fmt::format("version {}", found));
  }
  const auto crc = header.get<std::uint32_t>("checksum");
  const auto size = header.get<std::uint64_t>("size");
  if (size != header.remaining()) {
    throw InputError(place, fmt::format("{} bytes after the header", size),
                     fmt::format("{}: the file is torn", header.remaining()));
  }
  bytes.erase(0, kChecksummedHeaderBytes);
  if (crc32(bytes) != crc) throw InputError(place, "the checksum that the header names", "damaged bytes");
  return bytes;
}

}  // namespace penumbra::nn
