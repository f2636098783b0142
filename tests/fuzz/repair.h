// Makes check sums right again. A flipped byte almost never leaves a CRC right, so without this a fuzzer
// would only ever test the check sums, not what lies behind them.
#pragma once

#include <string>
#include <string_view>

namespace penumbra::fuzz {

// `bytes` with the CRC of every PNG chunk made right, as far as chunks follow each other.
std::string repair_png(std::string_view bytes);

// `bytes` with the CRC of every stored (not deflated) zip entry that lies in the file made right, in its own
// header and in the central directory.
std::string repair_zip(std::string_view bytes);

// `bytes` with the size and the CRC in the header of a map file made right.
std::string repair_map(std::string_view bytes);

}  // namespace penumbra::fuzz
