// The word that was probably meant: for messages about names that are not known.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace penumbra {

// How many letters must be changed, added or taken away to make `b` of `a` (Levenshtein), capitals and small
// letters being the same. Cost: a.size() * b.size().
std::size_t edit_distance(std::string_view a, std::string_view b);

// The candidate nearest to `word`, the first of equals; empty where none is nearer than half of `word`, or,
// of words of less than four letters, the same in capitals or small letters.
std::string_view nearest_word(std::string_view word, std::span<const std::string_view> candidates);

// " (is 'CANDIDATE' meant?)" of that candidate, or nothing.
std::string suggestion(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace penumbra
