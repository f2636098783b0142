#include "weights_tools/pickle_globals.h"

#include <array>

namespace penumbra::weights_tools {

namespace {

using nn::DataType;

struct Entry {
  std::string_view module, name;
  GlobalKind kind;
};

constexpr std::array kGlobals = {
    Entry{"collections", "OrderedDict", GlobalKind::ordered_dict},
    Entry{"torch", "Size", GlobalKind::size},
    Entry{"torch._utils", "_rebuild_tensor", GlobalKind::rebuild_tensor},
    Entry{"torch._utils", "_rebuild_tensor_v2", GlobalKind::rebuild_tensor},
    Entry{"torch._utils", "_rebuild_parameter", GlobalKind::rebuild_parameter},
    Entry{"torch._utils", "_rebuild_parameter_with_state", GlobalKind::rebuild_parameter},
    Entry{"torch.nn.parameter", "Parameter", GlobalKind::rebuild_parameter},
    Entry{"torch._tensor", "_rebuild_from_type_v2", GlobalKind::rebuild_from_type},
    Entry{"torch", "Tensor", GlobalKind::inert},
    Entry{"torch", "device", GlobalKind::inert},
    // What training scripts put beside the state dict: options, schedulers' state.
    Entry{"argparse", "Namespace", GlobalKind::inert},
    Entry{"collections", "Counter", GlobalKind::inert},
    Entry{"collections", "defaultdict", GlobalKind::inert},
    Entry{"builtins", "set", GlobalKind::inert},
    Entry{"__builtin__", "set", GlobalKind::inert},
};

// Element types as members of the module torch, and the names of their storages.
struct Storage {
  std::string_view name;
  DataType type;
};

constexpr std::array kStorages = {
    Storage{"DoubleStorage", DataType::f64}, Storage{"FloatStorage", DataType::f32},
    Storage{"HalfStorage", DataType::f16},   Storage{"BFloat16Storage", DataType::bf16},
    Storage{"LongStorage", DataType::i64},   Storage{"IntStorage", DataType::i32},
    Storage{"ShortStorage", DataType::i16},  Storage{"CharStorage", DataType::i8},
    Storage{"ByteStorage", DataType::u8},    Storage{"BoolStorage", DataType::boolean},
    Storage{"UntypedStorage", DataType::u8},
};

constexpr std::array<std::string_view, 13> kTypes = {"float64", "double",   "float32", "float", "float16",
                                                     "half",    "bfloat16", "int64",   "int32", "int16",
                                                     "int8",    "uint8",    "bool"};

}  // namespace

std::optional<Global> find_global(std::string_view module, std::string_view name) {
  for (const Entry& entry : kGlobals) {
    if (entry.module == module && entry.name == name) return Global{entry.kind};
  }
  if (module == "torch" || module == "torch.cuda" || module == "torch.storage") {
    for (const Storage& storage : kStorages) {
      if (storage.name == name) return Global{GlobalKind::storage, storage.type};
    }
  }
  if (module == "torch") {
    for (const std::string_view type : kTypes) {
      if (type == name) return Global{GlobalKind::inert};
    }
  }
  return std::nullopt;
}

std::string_view advice_on_refused_global(std::string_view module, std::string_view name) {
  if (module.substr(0, 5) == "numpy") return "numpy values are not read: store torch tensors";
  if (module.substr(0, 9) == "__torch__") return "this is a TorchScript program: save its state_dict()";
  if (module == "torch._utils" || name.find("Storage") != std::string_view::npos) {
    return "sparse, quantised and complex tensors are not read";
  }
  return "if this is a whole network, save its state_dict() instead";
}

}  // namespace penumbra::weights_tools
