// A plain tensor of f32: dense, row-major, any rank. Weights, references and small results live in it; the
// engine's activations are FeatureMaps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace penumbra::nn {

using Shape = std::vector<std::int64_t>;

// "[64, 3, 7, 7]"
std::string to_string(const Shape& shape);
// Product of the extents; 1 for a scalar's empty shape.
std::int64_t elements(const Shape& shape);

struct Tensor {
  Shape shape;
  std::vector<float> values;  // elements(shape) of them

  Tensor() = default;
  explicit Tensor(Shape extents)
      : shape(std::move(extents)), values(static_cast<std::size_t>(elements(shape))) {}
  Tensor(Shape extents, std::vector<float> data) : shape(std::move(extents)), values(std::move(data)) {}

  std::int64_t extent(std::size_t axis) const { return shape[axis]; }
  // Element (i, j, k, l) of a rank-4 tensor, the usual [N, C, H, W].
  float& at(std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t l) {
    return values[static_cast<std::size_t>(((i * shape[1] + j) * shape[2] + k) * shape[3] + l)];
  }
  float at(std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t l) const {
    return const_cast<Tensor*>(this)->at(i, j, k, l);
  }
};

}  // namespace penumbra::nn
