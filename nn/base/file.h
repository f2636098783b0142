// Whole files in and out of memory, with errors that name the file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace penumbra::nn {

// The bytes of a regular file (or a link to one). Throws InputError where there is none, where it is a folder
// or a device (which could block or never end), where it cannot be read, or where it holds 2 GiB or
// more; `expected` names what was wanted in the message, such as "a PNG or JPEG image".
std::string read_file(const std::filesystem::path& path, std::string_view expected);

// The text of such a file, as all editors of all systems write it: a UTF-8 byte order mark is left out, and
// lines end in '\n' where the file has "\r\n" or '\r'. Throws InputError as read_file does, and for UTF-16
// and UTF-32, which it names. Other encodings are handed on as they are.
std::string read_text_file(const std::filesystem::path& path, std::string_view expected);

// Writes a whole file or none (nn/base/file_in_the_making.h); what can be made again need not be `durable`.
// Throws Error where the folder is missing, not writable or full.
void write_file(const std::filesystem::path& path, std::string_view bytes, bool durable = true);

// Throws Error unless a file can be written in `folder`; leaves nothing there.
void require_writable_folder(const std::filesystem::path& folder);
// The same, and makes the folder where it is missing.
void make_writable_folder(const std::filesystem::path& folder);

}  // namespace penumbra::nn
