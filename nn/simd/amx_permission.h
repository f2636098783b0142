// Whether this process may use the processor's tile unit (Intel's AMX): the processor must have it, the
// system must save its registers, and Linux wants to be asked once (arch_prctl, ARCH_REQ_XCOMP_PERM), since a
// thread that uses it needs 8 KB more for them.
#pragma once

namespace penumbra::nn {

enum class AmxState {
  absent,       // the processor lacks AMX-TILE, AMX-BF16 or AMX-INT8
  not_enabled,  // the system does not save the tiles
  refused,      // the system said no to this process: a kernel before 5.16, a sandbox, a small signal stack
  granted
};

// Asks once, at the first call; the answer holds for all threads.
AmxState amx_state();
// For people: "not in this processor".
const char* describe(AmxState state);

}  // namespace penumbra::nn
