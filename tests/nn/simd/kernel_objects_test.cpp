// What the compiler made of the kernel files. One binary serves all processors, so a file that is compiled
// for AVX-512 must not define a function that others may call: an inline function of a header, of which the
// linker keeps any one copy, would do that. And multiply-adds must be fused, else the kernels run at half
// their speed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace penumbra::nn {
namespace {

std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string output;
  std::array<char, 65536> buffer;
  while (pipe != nullptr) {
    const std::size_t read = std::fread(buffer.data(), 1, buffer.size(), pipe.get());
    if (read == 0) break;
    output.append(buffer.data(), read);
  }
  return output;
}

std::vector<std::string> objects(const std::string& target) {
  std::vector<std::string> paths;
  const std::filesystem::path folder = std::filesystem::path(PENUMBRA_OBJECTS) / (target + ".dir");
  if (!std::filesystem::exists(folder)) return paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".o") paths.push_back(fmt::format("'{}'", entry.path().string()));
  }
  return paths;
}

int count(const std::string& text, const std::string& word) {
  int found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

const std::array kTargets{"penumbra_kernels_baseline", "penumbra_kernels_avx2",
                          "penumbra_kernels_avx512",   "penumbra_kernels_avx512_low",
                          "penumbra_kernels_amx",      "penumbra_kernels_amx_emulated"};

TEST(KernelObjects, DefineNoFunctionThatOtherFilesMightUse) {
  for (const std::string target : kTargets) {
    const std::vector<std::string> paths = objects(target);
    ASSERT_FALSE(paths.empty()) << target;
    for (const std::string& path : paths) {
      const std::string symbols = output_of("nm -C " + path);
      ASSERT_NE(symbols.find("penumbra::nn::"), std::string::npos) << path;
      // Weak functions (W), and unique objects (u): inline variables and statics of inline functions.
      for (const char* kind : {" W ", " u "}) {
        EXPECT_EQ(count(symbols, kind), 0) << path << " shares symbols:\n" << symbols;
      }
    }
  }
}

TEST(KernelObjects, MultiplyAndAddInOneInstruction) {
  const auto tile_code = [](const std::string& target) {
    std::string code;
    for (const std::string& path : objects(target)) {
      if (path.find("register_tile") == std::string::npos && path.find("low_precision") == std::string::npos)
        continue;
      code += output_of("objdump -d --no-show-raw-insn " + path);
    }
    return code;
  };
  for (const std::string target : {"penumbra_kernels_avx2", "penumbra_kernels_avx512"}) {
    const std::string code = tile_code(target), vector = target.ends_with("512") ? "%zmm" : "%ymm";
    ASSERT_NE(code.find(vector), std::string::npos) << target;
    // Fused ones by the hundred, plain products not at all: they would be halves of others.
    EXPECT_GT(count(code, "vfmadd231ps"), 400) << target;
    EXPECT_EQ(count(code, "vmulps"), 0) << target;
  }
  const std::string low = tile_code("penumbra_kernels_avx512_low");
  EXPECT_GT(count(low, "vdpbf16ps"), 400);
  EXPECT_GT(count(low, "vpdpbusd"), 400);
}

// Machines without a tile unit cannot run these kernels: at least the compiler must have left them whole.
TEST(KernelObjects, UseTheTileUnitOrNot) {
  const auto code_of = [](const std::string& target) {
    std::string code;
    for (const std::string& path : objects(target))
      code += output_of("objdump -d --no-show-raw-insn " + path);
    return code;
  };
  const std::string real = code_of("penumbra_kernels_amx"),
                    emulated = code_of("penumbra_kernels_amx_emulated");
  // Four shapes of blocks in each kind of numbers: of one or two segments by 16 or 32 outputs.
  EXPECT_GE(count(real, "tdpbf16ps"), 9);
  EXPECT_GE(count(real, "tdpbusd"), 9);
  EXPECT_GE(count(real, "tileloadd"), 24);
  EXPECT_GE(count(real, "tilestored"), 18);
  // The configuration is in memory when it is loaded: its 64 bytes are cleared by one store, or by several.
  EXPECT_GE(count(real, "ldtilecfg"), 2);
  for (const char* word : {"tdpb", "tileloadd", "ldtilecfg", "%zmm"})
    EXPECT_EQ(count(emulated, word), 0) << word;
}

}  // namespace
}  // namespace penumbra::nn
