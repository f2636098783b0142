// Files with a time in each line: times.txt of KITTI and of folders of images; and headings of lists.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra::slam {

// The times in seconds; `notes` says which unit was taken where it is another, and that a heading was
// skipped. Throws InputError (file:line) for a line that is no time, and times that go back.
std::vector<double> read_time_list(const std::filesystem::path& path, std::vector<std::string>& notes);

// Whether the first line of a list names its columns, "timestamp [ns],filename", without a '#': its first
// word is one of letters.
bool is_heading(std::string_view line);
// What notes say of it.
std::string heading_note(std::string_view place, std::string_view line);

}  // namespace penumbra::slam
