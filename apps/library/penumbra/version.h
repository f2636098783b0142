// The library's version, as the headers had it and as the library that is linked has it.
#pragma once

#include "penumbra/export.h"

namespace penumbra {

PENUMBRA_API const char* version();

}  // namespace penumbra
