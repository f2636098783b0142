// How many there are of something, in words: "1 image", "2 images".
#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

namespace penumbra {

// `many`: the plural, where it is not `one` with an s.
std::string counted(std::uint64_t count, std::string_view one, std::string_view many = {});

// The same of numbers of any type, which are not negative.
template <std::integral Number>
std::string counted(Number count, std::string_view one, std::string_view many = {}) {
  return counted(static_cast<std::uint64_t>(count), one, many);
}

}  // namespace penumbra
