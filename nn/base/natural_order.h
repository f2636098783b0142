// The order in which people number their files: 0, 1, 2, 10 and not 0, 1, 10, 2.
#pragma once

#include <string_view>

namespace penumbra {

// Of ASCII, whatever the locale says.
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Whether `a` comes before `b`: runs of digits compare as numbers, however long they are, everything else
// byte by byte. Texts that are equal so far ("7" and "007") compare as text: no two texts are equal but the
// same.
bool natural_less(std::string_view a, std::string_view b);

}  // namespace penumbra
