// What is in the folders of a dataset.
#pragma once

#include <filesystem>
#include <vector>

namespace penumbra::slam {

bool is_folder(const std::filesystem::path& path);
bool is_present(const std::filesystem::path& path);

// Entries of a folder, sorted by name. Throws InputError where it cannot be listed.
std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder);

// The images (.png, .jpg, .jpeg) of a folder, sorted by name; other files are left out. Throws InputError for
// something that is no folder or has no images.
std::vector<std::filesystem::path> list_images(const std::filesystem::path& folder);

// Throws InputError unless `path` is a folder with something in it.
void require_dataset_folder(const std::filesystem::path& path);

}  // namespace penumbra::slam
