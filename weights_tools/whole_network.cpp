#include "weights_tools/whole_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <set>
#include <string_view>

#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::weights_tools {

namespace {

constexpr std::size_t kDeepestPart = 64, kMostNotes = 16;

constexpr std::array<std::string_view, 13> kActivations = {
    "SiLU", "ReLU", "ReLU6", "LeakyReLU", "PReLU", "ELU",  "CELU",
    "SELU", "GELU", "Mish",  "Hardswish", "FReLU", "Swish"};

// What YOLOv5 and torchvision call the part that is the activation, whatever its class.
bool is_activation_name(std::string_view name) { return name == "act" || name == "relu"; }

class Walk {
 public:
  Walk(const PickledObject& object, const std::string& place, WalkBudget& budget)
      : object_(object), place_(place), budget_(budget) {}

  WholeNetwork run(const Value& network) {
    // Parts that are still to be visited: no recursion, so that depth costs no stack.
    std::vector<Part> parts = {{&network, "", 0}};
    while (!parts.empty()) {
      const Part part = std::move(parts.back());
      parts.pop_back();
      visit(part);
      const Value* modules = find(*part.value, "_modules");
      if (modules == nullptr) continue;
      for (std::size_t i = 0; i + 1 < modules->items.size(); i += 2) {
        const Value& inner = object_[modules->items[i + 1]];
        if (inner.kind != ValueKind::object) continue;  // None: a part that is left out
        parts.push_back({&inner, name_of(part, modules->items[i]) + ".", part.depth + 1});
        if (is_activation_name(object_[modules->items[i]].text)) note_activation(inner);
        take(budget_.parts, 1);
        if (part.depth + 1 > kDeepestPart)
          throw InputError(place_, "a network of at most 64 nested parts", "more");
      }
    }
    finish();
    return std::move(network_);
  }

 private:
  struct Part {
    const Value* value;
    std::string prefix;
    std::size_t depth;
  };

  void take(std::size_t& left, std::size_t count) const {
    if (count > left) {
      throw InputError(place_, "networks of at most 200,000 parts and 262,144 tensors",
                       "more, or shared parts");
    }
    left -= count;
  }

  // PickledObject::find, counted: a hostile pickle may share a large dict among many parts.
  const Value* find(const Value& holder, std::string_view key) {
    take(budget_.looks, holder.items.size() + 1);
    return object_.find(holder, key);
  }

  std::string name_of(const Part& part, ValueId key) {
    const Value& text = object_[key];
    if (text.kind != ValueKind::text) {
      throw InputError(place_, "the names of a network's parts as text", to_string(text.kind));
    }
    if (part.prefix.size() + text.text.size() > kLongestTensorName) {
      throw InputError(place_, fmt::format("names of at most {} bytes", kLongestTensorName), "longer ones");
    }
    take(budget_.name_bytes, part.prefix.size() + text.text.size());
    return part.prefix + std::string(text.text);
  }

  void visit(const Part& part) {
    std::set<std::string_view> left_out;  // buffers that state_dict() does not keep
    if (const Value* names = find(*part.value, "_non_persistent_buffers_set")) {
      for (const ValueId name : names->items) left_out.insert(object_[name].text);
    }
    for (const std::string_view key : {"_parameters", "_buffers"}) {
      const Value* tensors = find(*part.value, key);
      if (tensors == nullptr) continue;
      for (std::size_t i = 0; i + 1 < tensors->items.size(); i += 2) {
        const ValueKind kind = object_[tensors->items[i + 1]].kind;
        if (kind != ValueKind::tensor && kind != ValueKind::unread_tensor) continue;  // None: no bias
        const std::string name = name_of(part, tensors->items[i]);
        if (key == "_buffers" && left_out.contains(object_[tensors->items[i]].text)) continue;
        take(budget_.tensors, 1);
        network_.tensors.push_back({name, tensors->items[i + 1]});
      }
      if (key == "_buffers" && find(*tensors, "running_var") != nullptr) note_epsilon(*part.value);
    }
    note_settings(*part.value);
    if (std::find(kActivations.begin(), kActivations.end(), part.value->text) != kActivations.end()) {
      note_activation(*part.value);
    }
    // A function instead of a part: act = torch.nn.functional.silu.
    const Value* function = find(*part.value, "act");
    if (function != nullptr && function->kind == ValueKind::global) note_activation(*function);
    // The outermost part that has names or strides speaks for all.
    if (const Value* names = find(*part.value, "names"); names != nullptr && part.depth <= names_depth_) {
      if (const auto classes = read_class_list(object_, *names)) {
        network_.metadata["classes"] = *classes;
        names_depth_ = part.depth;
      }
    }
    const Value* stride = find(*part.value, "stride");
    if (stride != nullptr && stride->kind == ValueKind::tensor && part.depth <= stride_depth_) {
      network_.stride = static_cast<ValueId>(stride - object_.values.data());
      stride_depth_ = part.depth;
    }
  }

  // A class, or a function by its name.
  void note_activation(const Value& value) { activations_.insert(printable(value.text, 80)); }

  void note_epsilon(const Value& norm) {
    const Value* eps = find(norm, "eps");
    if (eps == nullptr || eps->kind != ValueKind::real) return;
    epsilons_.insert(fmt::format("{}", std::bit_cast<double>(eps->number)));
  }

  // Of torchvision's detectors: what their tensors do not tell.
  void note_settings(const Value& part) {
    if (part.text == "GeneralizedRCNNTransform") {
      for (const char* key : {"min_size", "max_size"}) {
        const std::vector<std::string> sizes = numbers_of(part, key);
        if (!sizes.empty()) network_.metadata[key] = sizes.back();  // of several sizes for training the last
      }
      for (const char* key : {"image_mean", "image_std"}) keep_numbers(key, numbers_of(part, key));
    } else if (part.text == "AnchorGenerator") {
      keep_numbers("anchor_sizes", numbers_of(part, "sizes"));
      keep_numbers("aspect_ratios", numbers_of(part, "aspect_ratios"));
    } else if (part.text == "RoIHeads") {
      note_if_other(part, "score_thresh", "0.05");
      note_if_other(part, "nms_thresh", "0.5");
      note_if_other(part, "detections_per_img", "100");
    } else if (part.text == "RegionProposalNetwork") {
      note_if_other(part, "nms_thresh", "0.7");
    }
  }

  void keep_numbers(const char* key, const std::vector<std::string>& numbers) {
    if (!numbers.empty()) network_.metadata[key] = fmt::format("{}", fmt::join(numbers, ","));
  }

  // What a user chose for the results, which commands have options of their own for.
  void note_if_other(const Value& part, const char* key, const char* usual) {
    const std::vector<std::string> numbers = numbers_of(part, key);
    if (numbers.empty() || numbers.front() == usual || network_.notes.size() >= kMostNotes) return;
    network_.notes.push_back(
        fmt::format("{}.{} = {} is not taken: {} is used", part.text, key, numbers.front(), usual));
  }

  // An attribute that is a number, or tuples and lists of them, at most two deep: ((32,), (64,), ...).
  std::vector<std::string> numbers_of(const Value& part, std::string_view key) {
    constexpr std::size_t kMostNumbers = 64;
    const Value* value = find(part, key);
    if (value == nullptr) return {};
    std::vector<std::string> numbers;
    const auto add = [&](const Value& number) {
      if (numbers.size() >= kMostNumbers) return;
      if (number.kind == ValueKind::integer) numbers.push_back(fmt::format("{}", number.number));
      if (number.kind == ValueKind::real) {
        numbers.push_back(fmt::format("{}", std::bit_cast<double>(number.number)));
      }
    };
    const auto is_row = [](const Value& row) {
      return row.kind == ValueKind::tuple || row.kind == ValueKind::list;
    };
    add(*value);
    if (!is_row(*value)) return numbers;
    for (std::size_t i = 0; i < std::min(value->items.size(), kMostNumbers); ++i) {
      const Value& item = object_[value->items[i]];
      add(item);
      if (!is_row(item)) continue;
      for (std::size_t k = 0; k < std::min(item.items.size(), kMostNumbers); ++k) {
        add(object_[item.items[k]]);
      }
    }
    return numbers;
  }

  void finish() {
    // Several epsilons make a list that no network takes: none of ours could be told them.
    if (!epsilons_.empty())
      network_.metadata["batch_norm_eps"] = fmt::format("{}", fmt::join(epsilons_, ","));
    if (!activations_.empty())
      network_.metadata["activations"] = fmt::format("{}", fmt::join(activations_, ","));
    std::sort(network_.tensors.begin(), network_.tensors.end(),
              [](const NamedValue& a, const NamedValue& b) { return a.name < b.name; });
  }

  const PickledObject& object_;
  std::string place_;
  WalkBudget& budget_;
  WholeNetwork network_;
  std::set<std::string> epsilons_, activations_;
  std::size_t names_depth_ = kDeepestPart + 1, stride_depth_ = kDeepestPart + 1;
};

}  // namespace

bool is_network(const PickledObject& object, const Value& value) {
  return value.kind == ValueKind::object &&
         (object.find(value, "_modules") != nullptr || object.find(value, "_parameters") != nullptr);
}

WholeNetwork read_whole_network(const PickledObject& object, const Value& network, const std::string& place,
                                WalkBudget& budget) {
  return Walk(object, place, budget).run(network);
}

std::optional<std::string> read_class_list(const PickledObject& object, const Value& value) {
  constexpr std::size_t kMostNames = 10'000, kLongestClass = 120;
  const bool is_dict = value.kind == ValueKind::dict;
  if (!is_dict && value.kind != ValueKind::list && value.kind != ValueKind::tuple) return std::nullopt;
  const std::size_t step = is_dict ? 2 : 1, count = value.items.size() / step;
  if (count == 0 || count > kMostNames) return std::nullopt;
  std::vector<std::string> names(count);
  bool has_comma = false;
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t index = i;
    if (is_dict) {
      const Value& key = object[value.items[2 * i]];
      if (key.kind != ValueKind::integer || key.number < 0 || static_cast<std::size_t>(key.number) >= count) {
        return std::nullopt;
      }
      index = static_cast<std::size_t>(key.number);
    }
    const Value& name = object[value.items[step * i + step - 1]];
    if (name.kind != ValueKind::text || name.text.empty() || printable(name.text) != name.text ||
        name.text.size() > kLongestClass) {
      return std::nullopt;
    }
    names[index] = name.text;
    has_comma |= name.text.find(',') != std::string_view::npos;
  }
  if (std::find(names.begin(), names.end(), "") != names.end()) return std::nullopt;  // a key stood twice
  return fmt::format("{}", fmt::join(names, has_comma ? "\n" : ", "));
}

}  // namespace penumbra::weights_tools
