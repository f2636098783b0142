#include "tests/support/onnx.h"

#include <cstring>

#include "nn/base/error.h"

namespace penumbra::test {

namespace {

// The fields of a message, one after the other; never reads beyond its bytes.
class Fields {
 public:
  Fields(std::string_view bytes, const std::string& place) : rest_(bytes), place_(place) {}

  int number = 0;           // of the current field
  std::uint64_t value = 0;  // of wire types 0, 1 and 5
  std::string_view bytes;   // of wire type 2

  // Moves to the next field; false at the end.
  bool next() {
    if (rest_.empty()) return false;
    const std::uint64_t key = varint(rest_);
    number = static_cast<int>(key >> 3);
    bytes = {};
    value = 0;
    switch (key & 7U) {
      case 0:
        value = varint(rest_);
        return true;
      case 1:
        value = fixed<std::uint64_t>(rest_);
        return true;
      case 2:
        bytes = take(rest_, varint(rest_));
        return true;
      case 5:
        value = fixed<std::uint32_t>(rest_);
        return true;
      default:
        throw InputError(place_, "wire type 0, 1, 2 or 5", std::to_string(key & 7U));
    }
  }

  std::string text() const { return std::string(bytes); }
  Fields message() const { return {bytes, place_}; }

  float as_float() const {
    const auto bits = static_cast<std::uint32_t>(value);
    float result = 0.0F;
    std::memcpy(&result, &bits, sizeof(result));
    return result;
  }

  // A repeated number: packed into bytes, or one of many fields.
  template <class Number>
  void append_varints(std::vector<Number>& numbers) const {
    if (bytes.data() == nullptr) return numbers.push_back(static_cast<Number>(value));
    for (std::string_view packed = bytes; !packed.empty();) {
      numbers.push_back(static_cast<Number>(static_cast<std::int64_t>(varint(packed))));
    }
  }
  // Raw little-endian numbers.
  template <class Stored>
  void append_raw(std::vector<float>& numbers) const {
    for (std::string_view packed = bytes; !packed.empty();) {
      numbers.push_back(static_cast<float>(fixed<Stored>(packed)));
    }
  }

 private:
  std::uint64_t varint(std::string_view& from) const {
    std::uint64_t result = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const auto byte = static_cast<unsigned char>(take(from, 1).front());
      result |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
      if (byte < 0x80U) return result;
    }
    throw InputError(place_, "a varint of at most 10 bytes", "a longer one");
  }

  std::string_view take(std::string_view& from, std::uint64_t count) const {
    if (count > from.size()) {
      throw InputError(place_, fmt::format("{} more bytes", count), fmt::format("{}", from.size()));
    }
    const std::string_view taken = from.substr(0, count);
    from.remove_prefix(count);
    return taken;
  }

  template <class Stored>
  Stored fixed(std::string_view& from) const {
    Stored result;
    std::memcpy(&result, take(from, sizeof(Stored)).data(), sizeof(Stored));
    return result;
  }

  std::string_view rest_;
  std::string place_;
};

OnnxAttribute parse_attribute(Fields fields, std::string& name) {
  OnnxAttribute attribute;
  while (fields.next()) {
    if (fields.number == 1) name = fields.text();
    if (fields.number == 2) attribute.number = fields.as_float();
    if (fields.number == 3) attribute.integer = static_cast<std::int64_t>(fields.value);
    if (fields.number == 4) attribute.text = fields.text();
    if (fields.number == 7 && fields.bytes.empty()) attribute.numbers.push_back(fields.as_float());
    if (fields.number == 7) fields.append_raw<float>(attribute.numbers);
    if (fields.number == 8) fields.append_varints(attribute.integers);
  }
  return attribute;
}

OnnxNode parse_node(Fields fields) {
  OnnxNode node;
  while (fields.next()) {
    if (fields.number == 1) node.inputs.push_back(fields.text());
    if (fields.number == 2) node.outputs.push_back(fields.text());
    if (fields.number == 4) node.operation = fields.text();
    if (fields.number == 5) {
      std::string name;
      OnnxAttribute attribute = parse_attribute(fields.message(), name);
      node.attributes[name] = std::move(attribute);
    }
  }
  return node;
}

// The name of a graph's input or output.
std::string parse_name(Fields fields) {
  std::string name;
  while (fields.next()) {
    if (fields.number == 1) name = fields.text();
  }
  return name;
}

OnnxTensor parse_tensor(Fields fields, const std::string& place) {
  OnnxTensor result;
  std::vector<float> values;
  Fields raw("", place);
  while (fields.next()) {
    if (fields.number == 1) fields.append_varints(result.tensor.shape);
    if (fields.number == 2) result.type = static_cast<int>(fields.value);
    if (fields.number == 4 && fields.bytes.empty()) values.push_back(fields.as_float());
    if (fields.number == 4) fields.append_raw<float>(values);
    if (fields.number == 5 || fields.number == 7) fields.append_varints(values);
    if (fields.number == 8) result.name = fields.text();
    if (fields.number == 9) raw = fields;
    if (fields.number == 10) fields.append_raw<double>(values);
  }
  if (!raw.bytes.empty()) {
    switch (result.type) {
      case OnnxTensor::f32:
        raw.append_raw<float>(values);
        break;
      case OnnxTensor::f64:
        raw.append_raw<double>(values);
        break;
      case OnnxTensor::i32:
        raw.append_raw<std::int32_t>(values);
        break;
      case OnnxTensor::i64:
        raw.append_raw<std::int64_t>(values);
        break;
      case OnnxTensor::u8:
      case OnnxTensor::boolean:
        raw.append_raw<std::uint8_t>(values);
        break;
      default:
        throw InputError(place, "a tensor of f32, f64, i32, i64, u8 or bool",
                         fmt::format("type {}", result.type));
    }
  }
  std::int64_t expected = 1;
  for (const std::int64_t extent : result.tensor.shape) {
    if (extent < 0 || (extent > 0 && expected > (std::int64_t{1} << 40) / extent)) {
      throw InputError(place, "a shape of fewer than 2^40 elements", nn::to_string(result.tensor.shape));
    }
    expected *= extent;
  }
  if (expected != static_cast<std::int64_t>(values.size())) {
    throw InputError(place, fmt::format("{} values", expected), fmt::format("{}", values.size()));
  }
  result.tensor.values = std::move(values);
  return result;
}

void parse_graph(Fields fields, const std::string& place, OnnxModel& model) {
  while (fields.next()) {
    if (fields.number == 1) model.nodes.push_back(parse_node(fields.message()));
    if (fields.number == 5) model.initializers.push_back(parse_tensor(fields.message(), place));
    if (fields.number == 11) model.inputs.push_back(parse_name(fields.message()));
    if (fields.number == 12) model.outputs.push_back(parse_name(fields.message()));
  }
}

}  // namespace

std::int64_t OnnxNode::integer(const std::string& name, std::int64_t otherwise) const {
  const auto found = attributes.find(name);
  return found == attributes.end() ? otherwise : found->second.integer;
}

float OnnxNode::number(const std::string& name, float otherwise) const {
  const auto found = attributes.find(name);
  return found == attributes.end() ? otherwise : found->second.number;
}

std::string OnnxNode::text(const std::string& name, const std::string& otherwise) const {
  const auto found = attributes.find(name);
  return found == attributes.end() ? otherwise : found->second.text;
}

std::vector<std::int64_t> OnnxNode::integers(const std::string& name,
                                             std::vector<std::int64_t> otherwise) const {
  const auto found = attributes.find(name);
  return found == attributes.end() ? std::move(otherwise) : found->second.integers;
}

OnnxModel parse_onnx_model(std::string_view bytes, const std::string& place) {
  OnnxModel model;
  Fields fields(bytes, place);
  while (fields.next()) {
    if (fields.number == 7) parse_graph(fields.message(), place, model);
    if (fields.number == 8) {  // operator set: domain and version
      std::string domain;
      int version = 0;
      Fields set = fields.message();
      while (set.next()) {
        if (set.number == 1) domain = set.text();
        if (set.number == 2) version = static_cast<int>(set.value);
      }
      if (domain.empty()) model.opset = version;
    }
  }
  return model;
}

OnnxTensor parse_onnx_tensor(std::string_view bytes, const std::string& place) {
  return parse_tensor(Fields(bytes, place), place);
}

}  // namespace penumbra::test
