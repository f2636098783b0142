// Marks what the shared library shows: everything else in it is hidden.
#pragma once

#if defined(__GNUC__)
#define PENUMBRA_API __attribute__((visibility("default")))
#else
#define PENUMBRA_API
#endif
