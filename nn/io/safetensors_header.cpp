#include "nn/io/safetensors_header.h"

#include <fmt/format.h>

#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::nn {

namespace {

constexpr std::size_t kMostDimensions = 64;  // as in PyTorch

// Receives the parser's events one by one, so no tree is built: names that stand twice are seen (a tree would
// keep the last one silently) and unexpected structure ends the parse where it begins.
class HeaderHandler final : public nlohmann::json_sax<nlohmann::json> {
 public:
  explicit HeaderHandler(std::string place) : place_(std::move(place)) {}

  SafetensorsHeader take() { return std::move(header_); }

  bool start_object(std::size_t) override {
    if (state_ == State::start) {
      state_ = State::root;
    } else if (state_ == State::root) {
      state_ = key_ == "__metadata__" ? State::metadata : State::tensor;
      if (state_ == State::tensor) begin_tensor();
    } else {
      unexpected("an object");
    }
    return true;
  }

  bool end_object() override {
    if (state_ == State::tensor) end_tensor();
    state_ = state_ == State::root ? State::done : State::root;
    return true;
  }

  bool key(string_t& name) override {
    key_ = name;
    bool is_new = true;
    if (state_ == State::root) {
      is_new = names_.insert(name).second;
    } else if (state_ == State::metadata) {
      is_new = !header_.metadata.contains(name);
    } else {
      const std::size_t field = name == "dtype" ? 0 : name == "shape" ? 1 : name == "data_offsets" ? 2 : 3;
      if (field == 3) fail("dtype, shape and data_offsets", "\"" + printable(name) + "\"");
      is_new = !has_field_[field];
      has_field_[field] = true;
    }
    if (!is_new) fail("every name once", "\"" + printable(name) + "\" twice");
    return true;
  }

  bool string(string_t& value) override {
    if (state_ == State::metadata) {
      header_.metadata[key_] = value;
    } else if (state_ == State::tensor && key_ == "dtype") {
      const std::optional<DataType> type = data_type_named(value);
      if (!type) {
        fail("an element type that safetensors has, such as F32", "\"" + printable(value) + "\"");
      }
      header_.tensors.back().type = *type;
    } else {
      unexpected("a string");
    }
    return true;
  }

  bool start_array(std::size_t) override {
    if (state_ != State::tensor || key_ == "dtype") unexpected("an array");
    state_ = key_ == "shape" ? State::shape : State::offsets;
    return true;
  }

  bool end_array() override {
    state_ = State::tensor;
    return true;
  }

  bool number_unsigned(number_unsigned_t value) override {
    if (state_ == State::shape) {
      if (value > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
        fail("extents below 2^63", std::to_string(value));
      }
      if (header_.tensors.back().shape.size() == kMostDimensions) {
        fail(fmt::format("a shape of at most {} extents", kMostDimensions), "more");
      }
      header_.tensors.back().shape.push_back(static_cast<std::int64_t>(value));
    } else if (state_ == State::offsets) {
      if (offset_count_ == 2) fail("two data_offsets", "more");
      offsets_[offset_count_++] = value;
    } else {
      unexpected(fmt::format("the number {}", value));
    }
    return true;
  }

  bool number_integer(number_integer_t value) override { return unexpected(std::to_string(value)); }
  bool number_float(number_float_t, const string_t& text) override { return unexpected(printable(text)); }
  // Some writers put null where they have no metadata.
  bool null() override { return (state_ == State::root && key_ == "__metadata__") || unexpected("null"); }
  bool boolean(bool value) override { return unexpected(value ? "true" : "false"); }
  bool binary(binary_t&) override { return unexpected("binary data"); }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::json::exception& error) override {
    throw InputError(fmt::format("{}: header, byte {}", place_, 8 + position), "well-formed JSON",
                     printable(error.what(), 200));
  }

 private:
  enum class State { start, root, metadata, tensor, shape, offsets, done };

  [[noreturn]] void fail(std::string_view expected, std::string_view found) const {
    const bool in_tensor = state_ == State::tensor || state_ == State::shape || state_ == State::offsets;
    const std::string& name = in_tensor ? header_.tensors.back().name : key_;
    throw InputError(
        name.empty() ? place_ + ": header" : fmt::format("{}: header, \"{}\"", place_, printable(name)),
        expected, found);
  }

  [[noreturn]] bool unexpected(std::string_view found) const {
    switch (state_) {
      case State::start:
      case State::done:
        fail("a JSON object", found);
      case State::root:
        fail("an object with dtype, shape and data_offsets", found);
      case State::metadata:
        fail("a string", found);
      case State::tensor:
        fail(key_ == "dtype" ? "dtype to be a string" : key_ + " to be an array of whole numbers >= 0",
             found);
      case State::shape:
      case State::offsets:
        break;
    }
    fail(key_ + " to hold whole numbers >= 0", found);
  }

  void begin_tensor() {
    header_.tensors.emplace_back().name = key_;
    has_field_ = {};
    offset_count_ = 0;
  }

  void end_tensor() {
    SafetensorsEntry& tensor = header_.tensors.back();
    if (!has_field_[0] || !has_field_[1] || !has_field_[2]) {
      fail("dtype, shape and data_offsets", "only some of them");
    }
    if (offset_count_ != 2) fail("two data_offsets", std::to_string(offset_count_));
    tensor.begin = offsets_[0];
    tensor.end = offsets_[1];
    if (tensor.end < tensor.begin) {
      fail("data_offsets [BEGIN, END] with BEGIN <= END", fmt::format("[{}, {}]", tensor.begin, tensor.end));
    }
    std::int64_t elements = 1;  // in the type that readers count in; an extent of 0 may follow large ones
    bool overflows = false;
    for (const std::int64_t extent : tensor.shape) {
      overflows = overflows || __builtin_mul_overflow(elements, extent, &elements);
    }
    const std::optional<std::uint64_t> size =
        overflows ? std::nullopt : bytes_of(tensor.type, static_cast<std::uint64_t>(elements));
    if (!size || *size > kLargestSize) {
      fail("a shape of less than 2^63 bytes, all of them whole",
           fmt::format("{} [{}]", to_string(tensor.type), fmt::join(tensor.shape, ", ")));
    }
    if (*size != tensor.end - tensor.begin) {
      fail(fmt::format("{} bytes for {} [{}]", *size, to_string(tensor.type), fmt::join(tensor.shape, ", ")),
           fmt::format("data_offsets that span {}", tensor.end - tensor.begin));
    }
  }

  static constexpr std::uint64_t kLargestSize = std::numeric_limits<std::int64_t>::max();

  std::string place_;
  SafetensorsHeader header_;
  State state_ = State::start;
  std::string key_;
  std::set<std::string> names_;
  std::array<bool, 3> has_field_{};  // dtype, shape, data_offsets of the current tensor
  std::array<std::uint64_t, 2> offsets_{};
  std::size_t offset_count_ = 0;
};

}  // namespace

SafetensorsHeader parse_safetensors_header(std::string_view json, const std::string& place) {
  // The parser takes a zero byte for the end of its input and would ignore what follows.
  const std::size_t zero = json.find('\0');
  if (zero != std::string_view::npos) {
    throw InputError(fmt::format("{}: header, byte {}", place, 8 + zero), "well-formed JSON", "a zero byte");
  }
  HeaderHandler handler(place);
  nlohmann::json::sax_parse(json.begin(), json.end(), &handler);
  return handler.take();
}

}  // namespace penumbra::nn
