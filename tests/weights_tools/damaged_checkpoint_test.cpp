// Checkpoints cut short or with flipped bits: every one is read or refused with an InputError, never more.
#include <gtest/gtest.h>

#include <random>

#include "nn/base/error.h"
#include "nn/io/safetensors.h"
#include "tests/support/bytes.h"
#include "tests/support/test_data.h"
#include "weights_tools/load_weights.h"
#include "weights_tools/pickle_machine.h"
#include "weights_tools/torch_state_dict.h"

namespace penumbra::weights_tools {
namespace {

using test::fixture;

// True where the file is read; every byte of every tensor is then touched.
bool is_read(const std::filesystem::path& path) {
  try {
    for (const auto& [name, tensor] : load_weights(path).tensors) {
      EXPECT_EQ(tensor.bytes.size(), static_cast<std::size_t>(tensor.elements()) * size_of(tensor.type));
      EXPECT_EQ(tensor.to_f32().size(), static_cast<std::size_t>(tensor.elements()));
    }
    return true;
  } catch (const InputError&) {
    return false;
  }
}

void flip_bits(std::string& bytes, std::mt19937& random) {
  std::uniform_int_distribution<std::size_t> position(0, bytes.size() - 1);
  std::uniform_int_distribution<int> bit(0, 7), count(1, 4);
  for (int i = count(random); i > 0; --i) bytes[position(random)] ^= static_cast<char>(1 << bit(random));
}

class DamagedCheckpoint : public ::testing::TestWithParam<const char*> {
 protected:
  // The file's bytes; "safetensors" is made from the zip file.
  std::string whole() const {
    const std::string name = GetParam();
    if (name != "safetensors") return test::read_file(fixture("checkpoints/" + name));
    nn::write_safetensors(folder_ / "whole", load_weights(fixture("checkpoints/every_kind_zip.pth")));
    return test::read_file(folder_ / "whole");
  }

  test::TemporaryDirectory folder_;
};

TEST_P(DamagedCheckpoint, IsRefusedWhereverItIsCut) {
  const std::string bytes = whole();
  test::write_file(folder_ / "file", bytes);
  EXPECT_TRUE(is_read(folder_ / "file"));
  for (std::size_t length = 0; length < bytes.size(); length += 64) {
    test::write_file(folder_ / "file", bytes.substr(0, length));
    EXPECT_FALSE(is_read(folder_ / "file")) << length;
  }
  for (std::size_t cut = 1; cut < 64; ++cut) {
    test::write_file(folder_ / "file", bytes.substr(0, bytes.size() - cut));
    EXPECT_FALSE(is_read(folder_ / "file")) << cut << " bytes before the end";
  }
}

TEST_P(DamagedCheckpoint, NeverCrashesWithFlippedBits) {
  const std::string bytes = whole();
  for (unsigned seed = 0; seed < 1000; ++seed) {
    std::mt19937 random(seed);
    std::string damaged = bytes;
    flip_bits(damaged, random);
    test::write_file(folder_ / "file", damaged);
    is_read(folder_ / "file");
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, DamagedCheckpoint,
                         ::testing::Values("every_kind_zip.pth", "every_kind_legacy.pth", "deflated.pth",
                                           "training_legacy.pth", "safetensors"),
                         [](const auto& info) {
                           const std::string name = info.param;
                           return name.substr(0, name.find('.'));
                         });

// A zip file's check sums catch flipped bits before the pickle is read; here the machine sees them itself.
TEST(DamagedPickle, NeverCrashesWithFlippedBits) {
  const std::string legacy = test::read_file(fixture("checkpoints/training_legacy.pth"));
  std::size_t begin = 0;
  for (int i = 0; i < 3; ++i) begin = run_pickle(test::as_bytes(legacy), begin, "pickle").end;
  const std::size_t end = run_pickle(test::as_bytes(legacy), begin, "pickle").end;
  const std::string pickle = legacy.substr(begin, end - begin);
  int found = 0;
  for (unsigned seed = 0; seed < 20'000; ++seed) {
    std::mt19937 random(seed);
    std::string damaged = pickle;
    flip_bits(damaged, random);
    try {
      found +=
          find_state_dict(run_pickle(test::as_bytes(damaged), 0, "pickle"), "pickle").tensors.empty() ? 0 : 1;
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(found, 0);  // some flips only change a name or a number
}

TEST(DamagedPickle, NeverCrashesOnRandomOperations) {
  // Random bytes die at once; random sequences of known operations go deep.
  const std::vector<std::string> operations = {"(",
                                               ".",
                                               "0",
                                               "1",
                                               "N",
                                               "\x88",
                                               "K\x01",
                                               "J\xFF\xFF\xFF\xFF",
                                               "X\x01",
                                               "U\x05model",
                                               ")",
                                               "t",
                                               "\x85",
                                               "\x86",
                                               "\x87",
                                               "]",
                                               "a",
                                               "e",
                                               "}",
                                               "s",
                                               "u",
                                               "\x8f",
                                               "\x90",
                                               "q\x01",
                                               "q\x02",
                                               "h\x01",
                                               "h\x02",
                                               "\x94",
                                               "R",
                                               "\x81",
                                               "b",
                                               "Q",
                                               "ccollections\nOrderedDict\n",
                                               "ctorch\nFloatStorage\n",
                                               "ctorch._utils\n_rebuild_tensor_v2\n",
                                               "ctorch._tensor\n_rebuild_from_type_v2\n",
                                               "ctorch\nSize\n",
                                               "\x93",
                                               "U\x07storage",
                                               "U\x01w"};
  for (unsigned seed = 0; seed < 50'000; ++seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<std::size_t> pick(0, operations.size() - 1);
    std::string pickle;
    for (int i = 0; i < 40; ++i) pickle += operations[pick(random)];
    try {
      find_state_dict(run_pickle(test::as_bytes(pickle), 0, "pickle"), "pickle");
    } catch (const InputError&) {
    }
  }
}

}  // namespace
}  // namespace penumbra::weights_tools
