#include "slam/sources/bag/chunk_packing.h"

#include <algorithm>
#include <memory>

#include "nn/base/error.h"
#include "nn/base/text.h"

#ifdef PENUMBRA_LZ4
#include <lz4frame.h>
#endif
#ifdef PENUMBRA_BZ2
#include <bzlib.h>
#endif
#ifdef PENUMBRA_ZSTD
#include <zstd.h>
#endif

namespace penumbra::slam {

namespace {

// What a decoder did with the bytes it was given.
struct Step {
  std::size_t taken = 0, made = 0;  // bytes
  bool ended = false;
};

// Feeds `decode` with `packed` until it has made `size` bytes and says that this was all.
// Step decode(const char* in, std::size_t in_size, char* out, std::size_t out_size); throws InputError.
template <class Decode>
std::string unpack_by(const Decode& decode, std::string_view packed, std::size_t size,
                      std::string_view place) {
  constexpr std::size_t kFirst = std::size_t{1} << 20, kMostAtOnce = std::size_t{1} << 30;
  std::string out(std::min(size, kFirst), '\0');
  std::size_t made = 0;
  bool ended = false;
  while (!ended) {
    // One byte more than there should be shows whether there are more.
    char beyond = 0;
    if (made == out.size() && made < size) out.resize(std::min(size, 2 * made));
    const bool is_full = made == size;
    const std::size_t given = std::min(packed.size(), kMostAtOnce);
    const Step step = is_full ? decode(packed.data(), given, &beyond, 1)
                              : decode(packed.data(), given, out.data() + made, out.size() - made);
    if (is_full && step.made > 0) throw InputError(place, fmt::format("{} unpacked bytes", size), "more");
    packed.remove_prefix(step.taken);
    made += step.made;
    ended = step.ended && (made == size || packed.empty());  // several frames may follow each other
    if (!ended && step.taken == 0 && step.made == 0) break;  // it wants more bytes than there are
  }
  if (!ended || made != size)
    throw InputError(place, fmt::format("{} unpacked bytes", size), fmt::format("{}", made));
  return out;
}

[[maybe_unused]] [[noreturn]] void refuse(std::string_view place, const char* library,
                                          std::string_view reason) {
  throw InputError(place, fmt::format("bytes packed by {}", library), printable(reason, 80));
}

#ifdef PENUMBRA_LZ4
std::string unpack_lz4(std::string_view packed, std::size_t size, std::string_view place) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION))) throw Error("lz4: out of memory");
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      raw, &LZ4F_freeDecompressionContext);
  return unpack_by(
      [&](const char* in, std::size_t in_size, char* out, std::size_t out_size) {
        Step step{in_size, out_size, false};
        const std::size_t hint = LZ4F_decompress(context.get(), out, &step.made, in, &step.taken, nullptr);
        if (LZ4F_isError(hint)) refuse(place, "lz4", LZ4F_getErrorName(hint));
        step.ended = hint == 0;
        return step;
      },
      packed, size, place);
}
#endif

#ifdef PENUMBRA_BZ2
std::string unpack_bz2(std::string_view packed, std::size_t size, std::string_view place) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw Error("bz2: out of memory");
  const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> end(&stream, &BZ2_bzDecompressEnd);
  return unpack_by(
      [&](const char* in, std::size_t in_size, char* out, std::size_t out_size) {
        stream.next_in = const_cast<char*>(in);
        stream.avail_in = static_cast<unsigned>(in_size);
        stream.next_out = out;
        stream.avail_out = static_cast<unsigned>(out_size);
        const int result = BZ2_bzDecompress(&stream);
        if (result != BZ_OK && result != BZ_STREAM_END) refuse(place, "bz2", fmt::format("error {}", result));
        return Step{in_size - stream.avail_in, out_size - stream.avail_out, result == BZ_STREAM_END};
      },
      packed, size, place);
}
#endif

#ifdef PENUMBRA_ZSTD
std::string unpack_zstd(std::string_view packed, std::size_t size, std::string_view place) {
  constexpr int kLargestWindow = 28;  // log2 of kLargestChunk
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  if (context == nullptr) throw Error("zstd: out of memory");
  ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, kLargestWindow);
  return unpack_by(
      [&](const char* in, std::size_t in_size, char* out, std::size_t out_size) {
        ZSTD_inBuffer input{in, in_size, 0};
        ZSTD_outBuffer output{out, out_size, 0};
        const std::size_t hint = ZSTD_decompressStream(context.get(), &output, &input);
        if (ZSTD_isError(hint)) refuse(place, "zstd", ZSTD_getErrorName(hint));
        return Step{input.pos, output.pos, hint == 0};
      },
      packed, size, place);
}
#endif

}  // namespace

Packing packing_named(std::string_view name, std::string_view place) {
  if (name.empty() || name == "none") return Packing::none;
  if (name == "lz4") return Packing::lz4;
  if (name == "bz2") return Packing::bz2;
  if (name == "zstd") return Packing::zstd;
  throw InputError(place, "chunks that are packed by none, lz4, bz2 or zstd",
                   fmt::format("'{}'", printable(name, 40)));
}

std::vector<BagLibrary> bag_libraries() {
  std::vector<BagLibrary> list = {{"lz4", false}, {"bz2", false}, {"zstd", false}, {"sqlite3", false}};
#ifdef PENUMBRA_LZ4
  list[0].is_there = true;
#endif
#ifdef PENUMBRA_BZ2
  list[1].is_there = true;
#endif
#ifdef PENUMBRA_ZSTD
  list[2].is_there = true;
#endif
#ifdef PENUMBRA_SQLITE
  list[3].is_there = true;
#endif
  return list;
}

void require_packing(Packing packing, std::string_view place) {
  if (packing == Packing::none) return;
  const BagLibrary library = bag_libraries()[static_cast<std::size_t>(packing) - 1];
  if (library.is_there) return;
  throw InputError(
      place, fmt::format("a build of penumbra with the library {}, which unpacks this file", library.name),
      "one without (install its -dev package and build again)");
}

std::string unpack_chunk(std::string_view packed, Packing packing, std::size_t size, std::string_view place) {
  require_packing(packing, place);
  if (size > kLargestChunk)
    throw InputError(place, fmt::format("a chunk of at most {} bytes", kLargestChunk),
                     fmt::format("{}", size));
  switch (packing) {
    case Packing::lz4:
#ifdef PENUMBRA_LZ4
      return unpack_lz4(packed, size, place);
#endif
      break;
    case Packing::bz2:
#ifdef PENUMBRA_BZ2
      return unpack_bz2(packed, size, place);
#endif
      break;
    case Packing::zstd:
#ifdef PENUMBRA_ZSTD
      return unpack_zstd(packed, size, place);
#endif
      break;
    case Packing::none:
      break;
  }
  if (packed.size() != size)
    throw InputError(place, fmt::format("{} bytes", size), fmt::format("{}", packed.size()));
  return std::string(packed);
}

}  // namespace penumbra::slam
