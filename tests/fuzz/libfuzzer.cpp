// libFuzzer's way into the target PENUMBRA_FUZZ_TARGET; one executable a target (CMakeLists.txt beside this).
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const penumbra::fuzz::Target& target = penumbra::fuzz::target_named(PENUMBRA_FUZZ_TARGET);
  target.read({reinterpret_cast<const char*>(data), size});
  return 0;
}
