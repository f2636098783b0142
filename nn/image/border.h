// What a filter sees beyond an image's border: the image mirrored about its outermost pixels.
//
//   ... 2 1 | 0 1 2 3 ... n-1 | n-2 n-3 ...
#pragma once

namespace penumbra {

// The pixel 0 <= x < n that stands for x.
inline int mirrored(int x, int n) {
  if (n == 1) return 0;
  while (x < 0 || x >= n) x = x < 0 ? -x : 2 * (n - 1) - x;
  return x;
}

}  // namespace penumbra
