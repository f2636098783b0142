#include "nn/simd/isa.h"

#include <array>
#include <cstdlib>
#include <string>

#include "nn/base/error.h"
#include "nn/simd/amx_permission.h"

namespace penumbra::nn {

namespace {

constexpr std::array kNative{Isa::amx, Isa::avx512, Isa::avx2, Isa::baseline};  // widest first

Isa& chosen() {
  static Isa isa = [] {
    if (const char* name = std::getenv("PENUMBRA_ISA"); name != nullptr && *name != '\0') {
      const Isa wanted = isa_from_name(name);
      if (!is_supported(wanted)) throw UsageError(fmt::format("PENUMBRA_ISA={}: not on this machine", name));
      return wanted;
    }
    for (const Isa candidate : kNative) {
      if (is_supported(candidate)) return candidate;
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
  }
  return "?";
}

Isa isa_from_name(std::string_view name) {
  for (const Isa isa : kNative) {
    if (name == to_string(isa)) return isa;
  }
  if (name == to_string(Isa::amx_emulated)) return Isa::amx_emulated;
  throw UsageError(
      fmt::format("instruction set: expected baseline, avx2, avx512, amx or amx-emulated, found '{}'", name));
}

bool is_supported(Isa isa) {
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
  }
  return false;
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
