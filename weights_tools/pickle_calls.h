// The calls that a pickle asks for, answered by building descriptions (used by the pickle machine alone).
#pragma once

#include "weights_tools/pickle_heap.h"

namespace penumbra::weights_tools {

// function(*arguments): a dict, set or tensor where it builds one, else an object without attributes. Throws
// InputError where the result of getattr is called, as only attacks need.
ValueId call(PickleHeap& heap, ValueId function, ValueId arguments);

// The storage that a persistent id ('storage', type, key, location, elements[, view]) names; the view, in the
// legacy format, is None or (key, offset, elements).
ValueId find_storage(PickleHeap& heap, ValueId persistent_id);

}  // namespace penumbra::weights_tools
