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

#if defined(__x86_64__)
const std::array kTargets{"penumbra_kernels_baseline", "penumbra_kernels_avx2",
                          "penumbra_kernels_avx512",   "penumbra_kernels_avx512_low",
                          "penumbra_kernels_amx",      "penumbra_kernels_amx_emulated"};
#elif defined(__aarch64__)
const std::array kTargets{"penumbra_kernels_baseline", "penumbra_kernels_neon", "penumbra_kernels_neon_dot",
                          "penumbra_kernels_neon_bf16"};
#else
const std::array kTargets{"penumbra_kernels_baseline"};
#endif

std::string code_of(const std::string& path) {
  return output_of("'" PENUMBRA_OBJDUMP "' -d --no-show-raw-insn " + path);
}

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

// The code of a target's register tiles.
std::string tile_code(const std::string& target) {
  std::string code;
  for (const std::string& path : objects(target)) {
    for (const char* file : {"register_tile", "low_precision", "int8", "bf16.cpp"}) {
      if (path.find(file) == std::string::npos) continue;
      code += code_of(path);
      break;
    }
  }
  return code;
}

#if defined(__x86_64__)

TEST(KernelObjects, MultiplyAndAddInOneInstruction) {
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
  const auto whole = [](const std::string& target) {
    std::string code;
    for (const std::string& path : objects(target)) code += code_of(path);
    return code;
  };
  const std::string real = whole("penumbra_kernels_amx"), emulated = whole("penumbra_kernels_amx_emulated");
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

#elif defined(__aarch64__)

// Instructions that move a vector register to or from the stack.
int spills(const std::string& code) {
  int found = 0;
  for (std::size_t at = code.find("[sp"); at != std::string::npos; at = code.find("[sp", at + 1)) {
    const std::size_t line = code.rfind('\n', at);
    if (code.substr(line, at - line).find("\tq") != std::string::npos) ++found;
  }
  return found;
}

TEST(KernelObjects, MultiplyAndAddInOneInstruction) {
  const std::string code = tile_code("penumbra_kernels_neon");
  EXPECT_GT(count(code, "fmla"), 400);
  EXPECT_EQ(count(code, "fmul"), 0);
  const std::string dot = tile_code("penumbra_kernels_neon_dot");
  EXPECT_GT(count(dot, "sdot"), 400);
  const std::string bf16 = tile_code("penumbra_kernels_neon_bf16");
  EXPECT_GT(count(bf16, "bfmmla"), 400);
  EXPECT_GT(count(bf16, "smmla"), 400);
  // Sums and inputs stay in registers: nothing goes to the stack and back.
  for (const std::string& tile : {code, dot, bf16}) EXPECT_EQ(spills(tile), 0);
}

#endif

}  // namespace
}  // namespace penumbra::nn
