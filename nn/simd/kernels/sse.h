// SSE4.2 and AVX2 as the kernels of bytes are written in them. On other processors SIMDe translates the
// 128-bit ones: to NEON, or where it knows no instructions to plain loops.
#pragma once

#if defined(__x86_64__) && !defined(PENUMBRA_PORTABLE)
#include <immintrin.h>
#else
#define SIMDE_ENABLE_NATIVE_ALIASES
#include <simde/x86/sse4.2.h>
#endif
