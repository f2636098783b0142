// Whole checkpoints: what PyTorch wrote is read bit for bit, what is hostile or damaged is refused.
#include "weights_tools/load_weights.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "nn/base/error.h"
#include "nn/io/safetensors.h"
#include "tests/support/bytes.h"
#include "tests/support/test_data.h"

namespace penumbra::weights_tools {
namespace {

using test::fixture;

TEST(LoadWeights, EveryFixtureHoldsWhatPyTorchReads) {
  // weights_tools/reference/make_checkpoint_fixtures.py wrote the files and the expectation.
  const nlohmann::json fixtures = test::read_json(fixture("checkpoints/expected.json"));
  for (const auto& [file, expected] : fixtures.items()) {
    const nn::StateDict state = load_weights(fixture("checkpoints/" + file));
    EXPECT_EQ(state.tensors.size(), expected.size()) << file;
    for (const auto& [name, tensor] : expected.items()) {
      ASSERT_TRUE(state.tensors.contains(name)) << file << ": " << name;
      const nn::StoredTensor& found = state.tensors.at(name);
      EXPECT_EQ(to_string(found.type), tensor["dtype"]) << file << ": " << name;
      EXPECT_EQ(found.shape, tensor["shape"].get<std::vector<std::int64_t>>()) << file << ": " << name;
      EXPECT_EQ(test::to_hex(found.bytes), tensor["hex"]) << file << ": " << name;
    }
  }
}

TEST(LoadWeights, FormatsAreToldByContentAndNotByName) {
  const test::TemporaryDirectory folder;
  std::filesystem::copy(fixture("checkpoints/small_zip.pth"), folder / "zip.safetensors");
  std::filesystem::copy(fixture("checkpoints/small_legacy.pth"), folder / "legacy.zip");
  nn::write_safetensors(folder / "safe.pth", load_weights(folder / "zip.safetensors"));
  EXPECT_EQ(checkpoint_format(folder / "zip.safetensors"), CheckpointFormat::pytorch_zip);
  EXPECT_EQ(checkpoint_format(folder / "legacy.zip"), CheckpointFormat::pytorch_legacy);
  EXPECT_EQ(checkpoint_format(folder / "safe.pth"), CheckpointFormat::safetensors);
  const std::vector<float> weight = {0, 1, 2, 3, 4, 5};
  for (const char* name : {"zip.safetensors", "legacy.zip", "safe.pth"}) {
    EXPECT_EQ(load_weights(folder / name).tensors.at("weight").to_f32(), weight) << name;
  }
}

TEST(LoadWeights, ASafetensorsHeaderWhoseLengthLooksLikeAPickleIsStillOne) {
  // 0x0280 = 640: the file begins with 80 02, as pickles do.
  const test::TemporaryDirectory folder;
  test::write_file(folder / "file",
                   test::little_endian(std::uint64_t{0x280}) + "{}" + std::string(0x27E, ' '));
  EXPECT_EQ(checkpoint_format(folder / "file"), CheckpointFormat::safetensors);
  EXPECT_CONTAINS(test::message_of<InputError>([&] { load_weights(folder / "file"); }), "0 tensors");
}

TEST(LoadWeights, WhatIsNoCheckpointIsNamed) {
  const test::TemporaryDirectory folder;
  EXPECT_THROW(load_weights(folder / "missing"), InputError);
  EXPECT_THROW(load_weights(folder.path()), InputError);
  const auto refusal = [&](const std::string& bytes) {
    test::write_file(folder / "file", bytes);
    return test::message_of<InputError>([&] { load_weights(folder / "file"); });
  };
  EXPECT_CONTAINS(refusal(""), "an empty file");
  EXPECT_CONTAINS(refusal("<!DOCTYPE html>"), "<!DOCTYPE html>");
  EXPECT_CONTAINS(refusal("version https://git-lfs"), "version https://");
  EXPECT_CONTAINS(refusal(test::little_endian(std::uint64_t{1} << 63) + "{\"a\":1}"), "9223372036854775808");
  EXPECT_CONTAINS(refusal("PK\x03\x04"), "zip");
}

TEST(LoadWeights, HostileAndUnsuitableFilesSayWhy) {
  const auto refusal = [](const std::string& name) {
    const std::filesystem::path path = fixture("checkpoints/" + name);
    const std::string message = test::message_of<InputError>([&] { load_weights(path); });
    EXPECT_CONTAINS(message, path.string());
    return message;
  };
  for (const char* name : {"os_system.pth", "os_system_legacy.pth"}) {
    EXPECT_CONTAINS(refusal(name), "posix.system (nothing was executed");
    EXPECT_CONTAINS(refusal(name), "byte ");
  }
  EXPECT_FALSE(std::filesystem::exists("penumbra_was_here"));
  EXPECT_CONTAINS(refusal("eval.pth"), "builtins.eval");
  EXPECT_CONTAINS(refusal("numpy_array.pth"), "numpy arrays are not taken for weights");
  EXPECT_CONTAINS(refusal("sparse.pth"), "sparse");
  EXPECT_CONTAINS(refusal("list.pth"), "a list");
  EXPECT_CONTAINS(refusal("no_tensors.pth"), "\"epoch\", \"lr\"");
  EXPECT_CONTAINS(refusal("plain_pickle.pth"), "torch.save");
  EXPECT_CONTAINS(refusal("storage_missing.pth"), "data/1");
  EXPECT_CONTAINS(refusal("storage_short.pth"), "20 bytes");
  EXPECT_CONTAINS(refusal("view_outside.pth"), "offset 200");
  EXPECT_CONTAINS(refusal("big_endian.pth"), "big");
  EXPECT_CONTAINS(refusal("other_zip.pth"), "data.pkl");
  EXPECT_CONTAINS(refusal("claims_gigabytes.pth"), "a claim of 4294967280");
  EXPECT_CONTAINS(refusal("expanded_terabyte.pth"), "4398046511104 bytes when unpacked");
  EXPECT_CONTAINS(refusal("legacy_negative_count.pth"), "-6");
  EXPECT_CONTAINS(refusal("legacy_key_missing.pth"), "keys of all");
}

TEST(LoadWeights, EntriesThatAreNoTensorsAreLeftOut) {
  const nn::StateDict state = load_weights(fixture("checkpoints/training.pth"));
  EXPECT_TRUE(state.tensors.contains("0.weight"));
  EXPECT_FALSE(state.tensors.contains("loss"));
  EXPECT_TRUE(state.metadata.empty());
}

TEST(LoadWeights, ContiguousTensorsOfAStorageShareItsBytes) {
  for (const char* name : {"every_kind_zip.pth", "every_kind_legacy.pth"}) {
    const nn::StateDict state = load_weights(fixture(std::string("checkpoints/") + name));
    EXPECT_EQ(state.tensors.at("shared.offset").bytes.data(),
              state.tensors.at("shared.all").bytes.data() + 5 * sizeof(float));
  }
}

TEST(LoadWeights, RealCheckpointsAreReadBitForBit) {
  PENUMBRA_REAL_DATA(weights, "weights");
  const nlohmann::json fixtures = test::read_json(fixture("checkpoints/real_checksums.json"));
  for (const auto& [file, expected] : fixtures.items()) {
    const nn::StateDict state = load_weights(weights / file);
    EXPECT_EQ(state.tensors.size(), expected["tensors"]) << file;
    std::uint32_t crc = 0;
    for (const auto& [name, tensor] : state.tensors) crc = test::crc32(tensor.bytes, crc);
    EXPECT_EQ(crc, expected["crc32"]) << file;
    for (const auto& [name, value] : expected["crc32_of"].items()) {
      EXPECT_EQ(test::crc32(state.tensors.at(name).bytes), value) << file << ": " << name;
    }
  }
}

}  // namespace
}  // namespace penumbra::weights_tools
