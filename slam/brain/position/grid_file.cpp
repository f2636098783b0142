#include "slam/brain/position/grid_file.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <span>
#include <utility>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "nn/io/safetensors.h"

namespace penumbra::slam::brain {

namespace {

using RowMajorWeights = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Shape = std::vector<std::int64_t>;

constexpr const char* kFormat = "penumbra grid code 1";

std::string module_part(std::size_t module, const char* part) {
  return fmt::format("modules.{}.{}", module, part);
}

template <class Number>
void add_tensor(nn::StateDict& state, const std::string& name, Shape shape, const Number* values,
                std::size_t count) {
  auto copy = std::make_shared<std::vector<Number>>(values, values + count);
  state.tensors[name] = {sizeof(Number) == 8 ? nn::DataType::f64 : nn::DataType::f32, std::move(shape),
                         std::as_bytes(std::span(*copy))};
  state.owners.push_back(std::move(copy));
}

// Takes tensors out of a file and checks them.
class TensorTaker {
 public:
  explicit TensorTaker(const nn::StateDict& state) : state_(state) {}

  bool has(const std::string& name) const { return state_.tensors.count(name) > 0; }

  // -1 in `shape` stands for any length above 0. Row after row.
  template <class Number>
  std::vector<Number> take(const std::string& name, const Shape& shape) const {
    const nn::StoredTensor& tensor = shaped(name, shape);
    constexpr nn::DataType type = sizeof(Number) == 8 ? nn::DataType::f64 : nn::DataType::f32;
    if (tensor.type != type) throw wrong(name, to_string(type), to_string(tensor.type));
    std::vector<Number> values(tensor.bytes.size() / sizeof(Number));
    std::memcpy(values.data(), tensor.bytes.data(), tensor.bytes.size());
    for (const Number value : values) {
      if (!std::isfinite(value)) throw wrong(name, "finite numbers", fmt::format("{}", value));
    }
    return values;
  }

  InputError wrong(const std::string& name, std::string_view expected, std::string_view found) const {
    return {fmt::format("{}: {}", state_.source, name), expected, found};
  }

 private:
  const nn::StoredTensor& shaped(const std::string& name, const Shape& shape) const {
    const auto found = state_.tensors.find(name);
    if (found == state_.tensors.end()) throw wrong(name, "this tensor of a grid code", "none");
    const Shape& has = found->second.shape;
    bool fits = has.size() == shape.size();
    for (std::size_t i = 0; fits && i < has.size(); ++i) {
      fits = shape[i] < 0 ? has[i] > 0 : has[i] == shape[i];
    }
    if (!fits) {
      throw wrong(name, fmt::format("shape [{}] (-1: any)", fmt::join(shape, ", ")),
                  fmt::format("[{}]", fmt::join(has, ", ")));
    }
    return found->second;
  }

  const nn::StateDict& state_;
};

Eigen::Matrix2Xd take_directions(const TensorTaker& taker) {
  const std::vector<double> values = taker.take<double>("directions", {-1, 2});
  const auto n = static_cast<Eigen::Index>(values.size() / 2);
  const Eigen::Matrix2Xd directions = Eigen::Map<const Eigen::Matrix2Xd>(values.data(), 2, n);
  for (const auto direction : directions.colwise()) {
    if (std::abs(direction.norm() - 1.0) > 1e-6) {
      throw taker.wrong("directions", "vectors of length 1", fmt::format("{}", direction.norm()));
    }
  }
  if (n % 6 != 0) throw taker.wrong("directions", "a multiple of 6", fmt::format("{}", n));
  return directions;
}

GridModule take_module(const TensorTaker& taker, std::size_t m, Eigen::Index directions) {
  GridModule module;
  const std::string wavelength = module_part(m, "wavelength");
  module.wavelength = taker.take<double>(wavelength, {1}).front();
  if (!(module.wavelength > 0.0)) {
    throw taker.wrong(wavelength, "a length above 0", fmt::format("{}", module.wavelength));
  }
  const std::vector<double> start = taker.take<double>(module_part(m, "start"), {directions});
  module.start = Eigen::Map<const Eigen::VectorXd>(start.data(), directions);
  const std::vector<float> weights = taker.take<float>(module_part(m, "weights"), {-1, 2 * directions});
  const auto cells = static_cast<Eigen::Index>(weights.size()) / (2 * directions);
  module.weights = Eigen::Map<const RowMajorWeights>(weights.data(), cells, 2 * directions);
  return module;
}

}  // namespace

void write_grid_code(const std::filesystem::path& path, const GridCode& code,
                     const GridCodeHistory& history) {
  nn::StateDict state;
  state.source = path.string();
  state.metadata = history;
  state.metadata["format"] = kFormat;
  const double output[] = {static_cast<double>(code.rule.threshold), code.rule.bipolar ? 1.0 : 0.0};
  add_tensor(state, "output", {2}, output, 2);
  const std::int64_t n = code.directions.cols();
  add_tensor(state, "directions", {n, 2}, code.directions.data(),
             static_cast<std::size_t>(code.directions.size()));
  for (std::size_t m = 0; m < code.modules.size(); ++m) {
    const GridModule& module = code.modules[m];
    add_tensor(state, module_part(m, "wavelength"), {1}, &module.wavelength, 1);
    add_tensor(state, module_part(m, "start"), {n}, module.start.data(), static_cast<std::size_t>(n));
    const RowMajorWeights weights = module.weights;
    add_tensor(state, module_part(m, "weights"), {weights.rows(), weights.cols()}, weights.data(),
               static_cast<std::size_t>(weights.size()));
  }
  nn::write_safetensors(path, state);
}

StoredGridCode read_grid_code(const std::filesystem::path& path) {
  const nn::StateDict state = nn::read_safetensors(path);
  const TensorTaker taker(state);
  const auto format = state.metadata.find("format");
  if (format == state.metadata.end() || format->second != kFormat) {
    throw taker.wrong("format", kFormat, format == state.metadata.end() ? "none" : printable(format->second));
  }
  StoredGridCode stored;
  stored.history = state.metadata;
  stored.history.erase("format");
  const std::vector<double> output = taker.take<double>("output", {2});
  stored.code.rule.threshold = static_cast<float>(output[0]);
  stored.code.rule.bipolar = output[1] != 0.0;
  stored.code.directions = take_directions(taker);
  for (std::size_t m = 0; m == 0 || taker.has(module_part(m, "weights")); ++m) {
    stored.code.modules.push_back(take_module(taker, m, stored.code.directions.cols()));
  }
  return stored;
}

}  // namespace penumbra::slam::brain
