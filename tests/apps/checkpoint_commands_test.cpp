// penumbra convert and penumbra info, run as a user does.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/bytes.h"
#include "tests/support/test_data.h"

namespace penumbra::test {
namespace {

std::string checkpoint(const std::string& name) { return fixture("checkpoints/" + name).string(); }

nlohmann::json info(const std::filesystem::path& path) {
  const ProgramResult result = run_penumbra("info --json " + path.string());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return nlohmann::json::parse(result.out);
}

TEST(ConvertCommand, KeepsElementTypesUnlessToldOtherwise) {
  const TemporaryDirectory folder;
  const std::string out = (folder / "out.safetensors").string();
  const ProgramResult result = run_penumbra("convert " + checkpoint("every_kind_legacy.pth") + " -o " + out);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_CONTAINS(result.out, "24 tensors");
  const nlohmann::json before = info(checkpoint("every_kind_legacy.pth")), after = info(out);
  EXPECT_EQ(before["tensors"], after["tensors"]);
  EXPECT_EQ(before["format"], "pytorch-legacy");
  EXPECT_EQ(after["format"], "safetensors");
  EXPECT_EQ(after["metadata"], nlohmann::json({{"source_format", "pytorch-legacy"}}));
}

TEST(ConvertCommand, ConvertsFloatsAndRecordsMetadata) {
  const TemporaryDirectory folder;
  const std::string first = (folder / "first.safetensors").string(), second = (folder / "second").string();
  ASSERT_EQ(
      run_penumbra("convert " + checkpoint("training.pth") + " --dtype f16 --metadata batch_norm_eps=0" +
                   " --metadata 'classes=person, car' -o " + first)
          .exit_code,
      0);
  ASSERT_EQ(
      run_penumbra("convert " + first + " --dtype f32 --metadata batch_norm_eps=1e-5 -o " + second).exit_code,
      0);
  for (const auto& [path, dtype] : {std::pair{first, "F16"}, std::pair{second, "F32"}}) {
    const nlohmann::json found = info(path);
    for (const nlohmann::json& tensor : found["tensors"]) {
      // Module 1 is a batch norm, whose vectors f16 would falsify.
      const std::string name = tensor["name"];
      const char* expected = name == "1.num_batches_tracked" ? "I64" : name.starts_with("1.") ? "F32" : dtype;
      EXPECT_EQ(tensor["dtype"], expected) << tensor;
    }
  }
  EXPECT_EQ(info(second)["metadata"],
            nlohmann::json(
                {{"source_format", "pytorch-zip"}, {"batch_norm_eps", "1e-5"}, {"classes", "person, car"}}));
}

TEST(ConvertCommand, RefusesToOverwriteItsInput) {
  const TemporaryDirectory folder;
  std::filesystem::copy(checkpoint("small_zip.pth"), folder / "in.pth");
  std::filesystem::create_symlink(folder / "in.pth", folder / "link");
  const std::string before = read_file(folder / "in.pth");
  for (const char* name : {"in.pth", "link", "./in.pth"}) {
    const ProgramResult result =
        run_penumbra("convert " + (folder / "in.pth").string() + " -o " + (folder / name).string());
    EXPECT_EQ(result.exit_code, 2) << name;
    EXPECT_CONTAINS(result.err, "the input itself");
  }
  EXPECT_EQ(read_file(folder / "in.pth"), before);
}

TEST(ConvertCommand, FailuresLeaveNoOutputAndSayWhy) {
  const TemporaryDirectory folder;
  const std::string out = " -o " + (folder / "out").string();
  const ProgramResult hostile = run_penumbra("convert " + checkpoint("os_system.pth") + out);
  EXPECT_EQ(hostile.exit_code, 1);
  EXPECT_CONTAINS(hostile.err, "posix.system (nothing was executed");
  EXPECT_EQ(run_penumbra("convert /no/such/file" + out).exit_code, 1);
  EXPECT_EQ(run_penumbra("convert " + checkpoint("small_zip.pth") + " -o /no/such/folder/out").exit_code, 1);
  EXPECT_EQ(run_penumbra("convert " + checkpoint("small_zip.pth")).exit_code, 2);
  EXPECT_EQ(run_penumbra("convert " + checkpoint("small_zip.pth") + " --dtype f8" + out).exit_code, 2);
  EXPECT_EQ(run_penumbra("convert " + checkpoint("small_zip.pth") + " --metadata eps" + out).exit_code, 2);
  EXPECT_EQ(run_penumbra("convert " + checkpoint("small_zip.pth") + " --metadata =1" + out).exit_code, 2);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(InfoCommand, ListsTensorsAndTotals) {
  const ProgramResult result = run_penumbra("info " + checkpoint("small_zip.pth"));
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_CONTAINS(result.out, "weight  F32    [2, 3]          24\n");
  EXPECT_CONTAINS(result.out, "pytorch-zip, 2 tensors, 8 elements, 32 bytes");
  EXPECT_EQ(result.err, "");
}

TEST(InfoCommand, WritesJsonForMachines) {
  const nlohmann::json found = info(checkpoint("small_legacy.pth"));
  EXPECT_EQ(found["elements"], 8);
  EXPECT_EQ(found["bytes"], 32);
  EXPECT_EQ(found["tensors"][1],
            nlohmann::json({{"name", "weight"}, {"dtype", "F32"}, {"shape", {2, 3}}, {"bytes", 24}}));
}

TEST(InfoCommand, EscapesNamesThatCouldHarmATerminal) {
  const TemporaryDirectory folder;
  const std::string header = "{\"a\\u001b[2J\":{\"dtype\":\"U8\",\"shape\":[],\"data_offsets\":[0,1]}}";
  write_file(folder / "file", little_endian<std::uint64_t>(header.size()) + header + "x");
  const ProgramResult result = run_penumbra("info " + (folder / "file").string());
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out.find('\x1b'), std::string::npos);
  EXPECT_CONTAINS(result.out, "a\\x1b[2J");
}

TEST(InfoCommand, AMissingFileIsAFailureAndAMissingArgumentAMistake) {
  EXPECT_EQ(run_penumbra("info /no/such/file").exit_code, 1);
  EXPECT_EQ(run_penumbra("info").exit_code, 2);
}

}  // namespace
}  // namespace penumbra::test
