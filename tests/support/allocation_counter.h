// Counts what the program asks of operator new, on all threads: allocation_counter.cpp replaces it.
#pragma once

#include <cstddef>

namespace penumbra::test {

std::size_t allocation_count();

}  // namespace penumbra::test
