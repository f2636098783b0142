// How many pieces of size b cover a: a / b, rounded up. For a >= 0, b > 0.
#pragma once

namespace penumbra {

template <typename Integer>
constexpr Integer ceil_div(Integer a, Integer b) {
  return (a + b - 1) / b;
}

}  // namespace penumbra
