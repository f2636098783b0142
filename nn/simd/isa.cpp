#include "nn/simd/isa.h"

#include <array>
#include <cstdlib>
#include <string>

#include "nn/base/error.h"

namespace penumbra::nn {

namespace {

constexpr std::array kAll{Isa::avx512, Isa::avx2, Isa::baseline};  // widest first

Isa& chosen() {
  static Isa isa = [] {
    if (const char* name = std::getenv("PENUMBRA_ISA"); name != nullptr && *name != '\0') {
      const Isa wanted = isa_from_name(name);
      if (!is_supported(wanted)) throw UsageError(fmt::format("PENUMBRA_ISA={}: not on this machine", name));
      return wanted;
    }
    for (const Isa candidate : kAll) {
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
  }
  return "?";
}

Isa isa_from_name(std::string_view name) {
  for (const Isa isa : kAll) {
    if (name == to_string(isa)) return isa;
  }
  throw UsageError(fmt::format("instruction set: expected baseline, avx2 or avx512, found '{}'", name));
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
  }
  return false;
}

Isa current_isa() { return chosen(); }

void use_isa(Isa isa) {
  if (!is_supported(isa)) throw UsageError(fmt::format("--isa {}: not on this machine", to_string(isa)));
  chosen() = isa;
}

}  // namespace penumbra::nn
