#include "weights_tools/zip_archive.h"

#include <fmt/format.h>
#include <zip.h>

#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::weights_tools {

namespace {

// Deflate packs at most 258 bytes into 2 bits.
constexpr std::uint64_t kBestDeflate = 1032;

std::string message(zip_error_t* error) {
  std::string text = zip_error_strerror(error);
  zip_error_fini(error);
  return text;
}

}  // namespace

ZipArchive::ZipArchive(std::span<const std::byte> bytes, std::string place) : place_(std::move(place)) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  if (source != nullptr) {
    archive_ = zip_open_from_source(source, ZIP_RDONLY | ZIP_CHECKCONS, &error);
    if (archive_ == nullptr) zip_source_free(source);
  }
  if (archive_ == nullptr) {
    throw InputError(place_, "a whole zip file (truncated or damaged?)", message(&error));
  }
  try {
    list_entries(bytes.size());
  } catch (...) {
    zip_discard(archive_);
    throw;
  }
}

ZipArchive::~ZipArchive() { zip_discard(archive_); }

void ZipArchive::list_entries(std::uint64_t file_size) {
  const std::int64_t count = zip_get_num_entries(archive_, 0);
  for (std::int64_t i = 0; i < count; ++i) {
    const auto index = static_cast<std::uint64_t>(i);
    zip_stat_t status;
    if (zip_stat_index(archive_, index, ZIP_FL_ENC_RAW, &status) != 0 || status.name == nullptr) {
      throw InputError(place_, "readable zip entries", zip_strerror(archive_));
    }
    const std::string where = fmt::format("{}: {}", place_, printable(status.name));
    constexpr std::uint64_t kNeeded = ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_COMP_METHOD;
    if ((status.valid & kNeeded) != kNeeded) throw InputError(where, "an entry with its sizes", "none");
    const bool is_stored = status.comp_method == ZIP_CM_STORE;
    if (!is_stored && status.comp_method != ZIP_CM_DEFLATE) {
      throw InputError(where, "a stored or deflated entry",
                       fmt::format("compression method {}", status.comp_method));
    }
    if (status.comp_size > file_size) {
      throw InputError(where, fmt::format("an entry within the file's {} bytes", file_size),
                       fmt::format("{} bytes", status.comp_size));
    }
    const std::uint64_t largest = is_stored ? status.comp_size : status.comp_size * kBestDeflate;
    if (status.size > largest) {
      throw InputError(where, fmt::format("at most {} bytes from {} packed ones", largest, status.comp_size),
                       fmt::format("a claim of {}", status.size));
    }
    if (!entries_.try_emplace(status.name, ZipEntry{index, status.size}).second) {
      throw InputError(where, "every entry once", "two of this name");
    }
  }
}

std::shared_ptr<std::byte[]> ZipArchive::read(const std::string& name, const ZipEntry& entry,
                                              MemoryBudget& budget) const {
  const std::string where = fmt::format("{}: {}", place_, printable(name));
  budget.take(entry.size, where);
  const std::unique_ptr<zip_file_t, decltype(&zip_fclose)> file(zip_fopen_index(archive_, entry.index, 0),
                                                                &zip_fclose);
  if (file == nullptr) throw InputError(where, "a readable zip entry", zip_strerror(archive_));

  const std::shared_ptr<std::byte[]> buffer = make_buffer(entry.size);
  std::uint64_t done = 0;
  std::byte beyond{};
  while (true) {
    // The read at the end, which gets nothing, is the one that verifies the check sum.
    const bool at_end = done == entry.size;
    const zip_int64_t got =
        zip_fread(file.get(), at_end ? &beyond : buffer.get() + done, at_end ? 1 : entry.size - done);
    if (got < 0) throw InputError(where, "an undamaged zip entry", zip_file_strerror(file.get()));
    if (got == 0) break;
    if (at_end) throw InputError(where, fmt::format("{} bytes", entry.size), "more");
    done += static_cast<std::uint64_t>(got);
  }
  if (done != entry.size) {
    throw InputError(where, fmt::format("{} bytes", entry.size), fmt::format("{}", done));
  }
  return buffer;
}

}  // namespace penumbra::weights_tools
