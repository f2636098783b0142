// Python's pickle format read as data, without Python and without running anything.
//
// A pickle is a program for a small stack machine. The operations that build numbers, strings, tuples, lists
// and dicts are carried out; the ones that would call Python code only ever build descriptions: of torch
// tensors, and of objects as attributes by name (pickle_globals.h). Globals that only attacks need end the
// reading.
//
// Bounds: time and memory are linear in the pickle's length; at most kMostPickledValues values; no recursion.
//
// Sources: the opcodes' documentation in CPython's Lib/pickletools.py; the subset that state dicts need is
// that of torch/_weights_only_unpickler.py (PyTorch 1.13), with protocols up to 5.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "weights_tools/pickle_value.h"

namespace penumbra::weights_tools {

inline constexpr std::size_t kMostPickledValues = 2'000'000;
inline constexpr std::size_t kLongestPickle = 32U
                                              << 20;  // bytes; a pickle holds names and shapes, not numbers

// Runs the one pickle that begins at bytes[begin]. `place` names the file (and the entry in it) in messages.
// Throws InputError, with the byte position, for a pickle that is truncated, malformed, too large, or that
// needs an operation or a global that is not allowed.
PickledObject run_pickle(std::span<const std::byte> bytes, std::size_t begin, const std::string& place);

}  // namespace penumbra::weights_tools
