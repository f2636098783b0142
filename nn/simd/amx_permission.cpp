#include "nn/simd/amx_permission.h"

#if defined(__x86_64__)
#include <cpuid.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>
#endif

namespace penumbra::nn {

namespace {

#if defined(__x86_64__)
// Of XCR0, the states that the system saves: shapes and contents of the tiles.
constexpr unsigned kTileConfigurationState = 17, kTileDataState = 18;
constexpr long kRequestPermission = 0x1023;  // ARCH_REQ_XCOMP_PERM

bool processor_has_tiles() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  if (__get_cpuid_count(7, 0, &a, &b, &c, &d) == 0) return false;
  constexpr unsigned kBf16 = 1U << 22, kTile = 1U << 24, kInt8 = 1U << 25;
  return (d & (kBf16 | kTile | kInt8)) == (kBf16 | kTile | kInt8);
}

bool system_saves_tiles() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  if (__get_cpuid(1, &a, &b, &c, &d) == 0 || (c & bit_OSXSAVE) == 0) return false;
  std::uint32_t low = 0, high = 0;
  asm volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return (low >> kTileConfigurationState & 1U) != 0 && (low >> kTileDataState & 1U) != 0;
}

AmxState ask() {
  if (!processor_has_tiles()) return AmxState::absent;
  if (!system_saves_tiles()) return AmxState::not_enabled;
  const bool granted = syscall(SYS_arch_prctl, kRequestPermission, kTileDataState) == 0;
  return granted ? AmxState::granted : AmxState::refused;
}
#else
AmxState ask() { return AmxState::absent; }
#endif

}  // namespace

AmxState amx_state() {
  static const AmxState state = ask();
  return state;
}

const char* describe(AmxState state) {
  switch (state) {
    case AmxState::absent:
      return "not in this processor";
    case AmxState::not_enabled:
      return "in this processor, but the system does not save its registers";
    case AmxState::refused:
      return "in this processor, but the system refuses it to this process";
    case AmxState::granted:
      return "yes";
  }
  return "?";
}

}  // namespace penumbra::nn
