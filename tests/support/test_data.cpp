#include "tests/support/test_data.h"

#include <stdlib.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

namespace penumbra::test {

namespace {

std::string read_all(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace

std::filesystem::path data_root() {
  const char* root = std::getenv("PENUMBRA_DATA");
  return root != nullptr ? std::filesystem::path(root) : source_path("../shared/data");
}

std::filesystem::path cases_root() {
  const char* root = std::getenv("PENUMBRA_CASES");
  return root != nullptr ? std::filesystem::path(root) : source_path("../shared/cases");
}

bool data_is_required() {
  const char* required = std::getenv("PENUMBRA_REQUIRE_DATA");
  return required != nullptr && std::string(required) == "1";
}

std::filesystem::path source_path(const std::string& relative) {
  return std::filesystem::path(PENUMBRA_SOURCE_DIR) / relative;
}

std::filesystem::path fixture(const std::string& name) { return source_path("tests/fixtures") / name; }

nlohmann::json read_json(const std::filesystem::path& path) { return nlohmann::json::parse(read_all(path)); }

TemporaryDirectory::TemporaryDirectory() {
  std::string pattern = (std::filesystem::temp_directory_path() / "penumbra_test_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
  path_ = pattern;
}

TemporaryDirectory::~TemporaryDirectory() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string penumbra_program() { return PENUMBRA_BINARY; }

ProgramResult run_penumbra(const std::string& arguments, const std::filesystem::path& input) {
  const TemporaryDirectory scratch;
  const std::string command = penumbra_program() + " " + arguments + " >" + (scratch / "out").string() +
                              " 2>" + (scratch / "err").string() + " <'" + input.string() + "'";
  const int status = std::system(command.c_str());
  ProgramResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = read_all(scratch / "out");
  result.err = read_all(scratch / "err");
  return result;
}

}  // namespace penumbra::test
