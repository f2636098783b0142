// Real data for tests: read from $PENUMBRA_DATA, by default ../shared/data beside the project.
//
// Where it is absent, PENUMBRA_REAL_DATA(name, "kitti/sequences/00") skips the test with a clear message, or
// fails it if $PENUMBRA_REQUIRE_DATA is 1. Where it is present, `name` is its std::filesystem::path.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace penumbra::test {

std::filesystem::path data_root();
bool data_is_required();
// Files on which programs of this field were seen to fail: $PENUMBRA_CASES, by default "cases" beside the
// data.
std::filesystem::path cases_root();
// A path relative to the root of the source tree, and to its tests/fixtures.
std::filesystem::path source_path(const std::string& relative);
std::filesystem::path fixture(const std::string& name);
nlohmann::json read_json(const std::filesystem::path& path);

// A directory that is empty at the start of the test and removed at its end.
class TemporaryDirectory {
 public:
  TemporaryDirectory();
  ~TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

// What a run of the program did.
struct ProgramResult {
  int exit_code = 0;  // 128 + signal where a signal ended it
  std::string out, err;
};
// The file of the program that is tested.
std::string penumbra_program();
// Runs `penumbra ARGUMENTS` (a shell command line) with the file `input` as its standard input, and waits for
// it.
ProgramResult run_penumbra(const std::string& arguments, const std::filesystem::path& input = "/dev/null");

}  // namespace penumbra::test

#define PENUMBRA_REAL_DATA(name, relative)                                                                \
  const std::filesystem::path name = penumbra::test::data_root() / (relative);                            \
  if (!std::filesystem::exists(name)) {                                                                   \
    if (penumbra::test::data_is_required()) FAIL() << "PENUMBRA_REQUIRE_DATA=1 but there is no " << name; \
    GTEST_SKIP() << "no " << name << ": set PENUMBRA_DATA to the folder of the real data";                \
  }
