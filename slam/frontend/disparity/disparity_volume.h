// A number for each pixel and each disparity that it may have, as the steps of dense stereo matching hand on.
#pragma once

#include <cstddef>
#include <vector>

namespace penumbra::slam {

// The numbers of a pixel lie side by side, d = 0 first.
template <class T>
class DisparityVolume {
 public:
  // The numbers are not set. Keeps the memory where it is large enough.
  void create(int width, int height, int disparities) {
    width_ = width;
    height_ = height;
    disparities_ = disparities;
    numbers_.resize(std::size_t(width) * std::size_t(height) * std::size_t(disparities));
  }
  int width() const { return width_; }
  int height() const { return height_; }
  int disparities() const { return disparities_; }
  T* at(int x, int y) { return numbers_.data() + offset(x, y); }
  const T* at(int x, int y) const { return numbers_.data() + offset(x, y); }

 private:
  std::ptrdiff_t offset(int x, int y) const {
    return (std::ptrdiff_t(y) * width_ + x) * std::ptrdiff_t(disparities_);
  }

  int width_ = 0, height_ = 0, disparities_ = 0;
  std::vector<T> numbers_;
};

}  // namespace penumbra::slam
