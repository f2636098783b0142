#include "nn/simd/isa.h"

#if defined(__aarch64__)
#include <sys/auxv.h>
#endif

#include <fmt/format.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "nn/base/error.h"
#include "nn/simd/amx_permission.h"

namespace penumbra::nn {

namespace {

#if defined(__aarch64__)
// Of Linux's <asm/hwcap.h>, whose older versions lack some.
constexpr unsigned long kDotProducts = 1UL << 20;              // of AT_HWCAP: ASIMDDP
constexpr unsigned long kI8mm = 1UL << 13, kBf16 = 1UL << 14;  // of AT_HWCAP2

bool has(unsigned long type, unsigned long bits) { return (getauxval(type) & bits) == bits; }
#endif

Isa& chosen() {
  static Isa isa = [] {
    if (const char* name = std::getenv("PENUMBRA_ISA"); name != nullptr && *name != '\0') {
      const Isa wanted = isa_from_name(name);
      if (!is_supported(wanted)) throw UsageError(fmt::format("PENUMBRA_ISA={}: not on this machine", name));
      return wanted;
    }
    for (auto widest = kIsas.rbegin(); widest != kIsas.rend(); ++widest) {
      if (*widest != Isa::amx_emulated && is_supported(*widest)) return *widest;
    }
    throw Error("this processor lacks SSE4.2, which Penumbra needs");
  }();
  return isa;
}

}  // namespace

const char* to_string(Isa isa) {
  switch (isa) {
    case Isa::baseline:
      return "baseline";
    case Isa::avx2:
      return "avx2";
    case Isa::avx512:
      return "avx512";
    case Isa::amx:
      return "amx";
    case Isa::amx_emulated:
      return "amx-emulated";
    case Isa::neon:
      return "neon";
    case Isa::neon_dot:
      return "neon-dot";
    case Isa::neon_bf16:
      return "neon-bf16";
  }
  return "?";
}

Isa isa_from_name(std::string_view name) {
  std::vector<const char*> names;
  for (const Isa isa : kIsas) {
    if (name == to_string(isa)) return isa;
    names.push_back(to_string(isa));
  }
  throw UsageError(
      fmt::format("instruction set: expected one of {}, found '{}'", fmt::join(names, ", "), name));
}

bool is_supported(Isa isa) {
#if defined(__x86_64__)
  // __builtin_cpu_supports also asks whether the operating system saves the wide registers.
  switch (isa) {
    case Isa::baseline:
      return __builtin_cpu_supports("sse4.2") != 0;
    case Isa::avx2:
      return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
    case Isa::avx512:
      return is_supported(Isa::avx2) && __builtin_cpu_supports("avx512f") != 0 &&
             __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("avx512cd") != 0 &&
             __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
    case Isa::amx:
      return is_supported(Isa::avx512) && amx_state() == AmxState::granted;
    case Isa::amx_emulated:
      return is_supported(Isa::avx2);
    default:
      return false;
  }
#elif defined(__aarch64__)
  switch (isa) {
    case Isa::baseline:
    case Isa::neon:
      return true;
    case Isa::neon_dot:
      return has(AT_HWCAP, kDotProducts);
    case Isa::neon_bf16:
      return is_supported(Isa::neon_dot) && has(AT_HWCAP2, kI8mm | kBf16);
    default:
      return false;
  }
#else
  return isa == Isa::baseline;
#endif
}

Isa current_isa() { return chosen(); }

void use_isa(Isa isa) {
  if (!is_supported(isa)) {
    const bool tiles = isa == Isa::amx && is_supported(Isa::avx512);
    throw UsageError(
        fmt::format("--isa {}: {}", to_string(isa), tiles ? describe(amx_state()) : "not on this machine"));
  }
  chosen() = isa;
}

}  // namespace penumbra::nn
