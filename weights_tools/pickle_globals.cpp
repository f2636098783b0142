#include "weights_tools/pickle_globals.h"

#include <array>

#include "weights_tools/pickle_refusals.h"

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
    Entry{"collections", "defaultdict", GlobalKind::dict},
    Entry{"collections", "Counter", GlobalKind::dict},
    // The built-in types that pickles name.
    Entry{"builtins", "dict", GlobalKind::dict},
    Entry{"builtins", "set", GlobalKind::set},
    Entry{"builtins", "frozenset", GlobalKind::set},
    Entry{"builtins", "getattr", GlobalKind::attribute},
    Entry{"builtins", "bool", GlobalKind::record},
    Entry{"builtins", "bytearray", GlobalKind::record},
    Entry{"builtins", "bytes", GlobalKind::record},
    Entry{"builtins", "complex", GlobalKind::record},
    Entry{"builtins", "Ellipsis", GlobalKind::record},
    Entry{"builtins", "float", GlobalKind::record},
    Entry{"builtins", "int", GlobalKind::record},
    Entry{"builtins", "list", GlobalKind::record},
    Entry{"builtins", "long", GlobalKind::record},
    Entry{"builtins", "NotImplemented", GlobalKind::record},
    Entry{"builtins", "object", GlobalKind::record},
    Entry{"builtins", "range", GlobalKind::record},
    Entry{"builtins", "slice", GlobalKind::record},
    Entry{"builtins", "str", GlobalKind::record},
    Entry{"builtins", "tuple", GlobalKind::record},
    Entry{"builtins", "type", GlobalKind::record},
    Entry{"builtins", "unicode", GlobalKind::record},
    Entry{"builtins", "xrange", GlobalKind::record},
    // Functions that change nothing, whatever they are given.
    Entry{"builtins", "abs", GlobalKind::record},
    Entry{"builtins", "all", GlobalKind::record},
    Entry{"builtins", "any", GlobalKind::record},
    Entry{"builtins", "callable", GlobalKind::record},
    Entry{"builtins", "divmod", GlobalKind::record},
    Entry{"builtins", "enumerate", GlobalKind::record},
    Entry{"builtins", "filter", GlobalKind::record},
    Entry{"builtins", "format", GlobalKind::record},
    Entry{"builtins", "hash", GlobalKind::record},
    Entry{"builtins", "isinstance", GlobalKind::record},
    Entry{"builtins", "issubclass", GlobalKind::record},
    Entry{"builtins", "iter", GlobalKind::record},
    Entry{"builtins", "len", GlobalKind::record},
    Entry{"builtins", "map", GlobalKind::record},
    Entry{"builtins", "max", GlobalKind::record},
    Entry{"builtins", "min", GlobalKind::record},
    Entry{"builtins", "next", GlobalKind::record},
    Entry{"builtins", "pow", GlobalKind::record},
    Entry{"builtins", "print", GlobalKind::record},
    Entry{"builtins", "property", GlobalKind::record},
    Entry{"builtins", "reduce", GlobalKind::record},
    Entry{"builtins", "repr", GlobalKind::record},
    Entry{"builtins", "reversed", GlobalKind::record},
    Entry{"builtins", "round", GlobalKind::record},
    Entry{"builtins", "sorted", GlobalKind::record},
    Entry{"builtins", "sum", GlobalKind::record},
    Entry{"builtins", "zip", GlobalKind::record},
    Entry{"builtins", "ExceptionGroup", GlobalKind::record},
    Entry{"builtins", "BaseExceptionGroup", GlobalKind::record},
    Entry{"builtins", "GeneratorExit", GlobalKind::record},
    Entry{"builtins", "KeyboardInterrupt", GlobalKind::record},
    Entry{"builtins", "StopAsyncIteration", GlobalKind::record},
    Entry{"builtins", "StopIteration", GlobalKind::record},
    Entry{"builtins", "SystemExit", GlobalKind::record},
    // Inside modules that are refused otherwise.
    Entry{"os", "stat_result", GlobalKind::record},
    Entry{"os", "statvfs_result", GlobalKind::record},
    Entry{"os", "terminal_size", GlobalKind::record},
    Entry{"posix", "uname_result", GlobalKind::record},
    Entry{"posix", "times_result", GlobalKind::record},
    Entry{"subprocess", "CompletedProcess", GlobalKind::record},
    Entry{"subprocess", "TimeoutExpired", GlobalKind::record},
    Entry{"signal", "Handlers", GlobalKind::record},
    Entry{"signal", "Signals", GlobalKind::record},
    Entry{"http", "HTTPMethod", GlobalKind::record},
    Entry{"http", "HTTPStatus", GlobalKind::record},
    Entry{"socket", "AddressFamily", GlobalKind::record},
    Entry{"socket", "SocketKind", GlobalKind::record},
    Entry{"urllib.parse", "DefragResult", GlobalKind::record},
    Entry{"urllib.parse", "ParseResult", GlobalKind::record},
    Entry{"urllib.parse", "ParseResultBytes", GlobalKind::record},
    Entry{"urllib.parse", "SplitResult", GlobalKind::record},
    Entry{"urllib.parse", "SplitResultBytes", GlobalKind::record},
    Entry{"types", "GenericAlias", GlobalKind::record},
    Entry{"types", "NoneType", GlobalKind::record},
    Entry{"types", "UnionType", GlobalKind::record},
    Entry{"io", "BytesIO", GlobalKind::record},
    Entry{"io", "StringIO", GlobalKind::record},
    Entry{"types", "SimpleNamespace", GlobalKind::record},
    Entry{"types", "MappingProxyType", GlobalKind::record},
};

// Element types as members of the module torch, and the names of their storages.
struct Storage {
  std::string_view name;
  DataType type;
};

constexpr std::array kStorages = {
    Storage{"DoubleStorage", DataType::f64},
    Storage{"FloatStorage", DataType::f32},
    Storage{"HalfStorage", DataType::f16},
    Storage{"BFloat16Storage", DataType::bf16},
    Storage{"LongStorage", DataType::i64},
    Storage{"IntStorage", DataType::i32},
    Storage{"ShortStorage", DataType::i16},
    Storage{"CharStorage", DataType::i8},
    Storage{"ByteStorage", DataType::u8},
    Storage{"BoolStorage", DataType::boolean},
    Storage{"UntypedStorage", DataType::u8},
    Storage{"ComplexFloatStorage", DataType::c64},
    Storage{"ComplexDoubleStorage", DataType::c128},
    Storage{"QInt8Storage", DataType::i8},
    Storage{"QUInt8Storage", DataType::u8},
    Storage{"QInt32Storage", DataType::i32},
};

bool is_torch_script(std::string_view module) {
  return module_lies_in(module, "__torch__") || module_lies_in(module, "torch.jit");
}

}  // namespace

std::optional<Global> find_global(std::string_view module, std::string_view name) {
  // Python 2's, which protocol 2 writes, and other spellings of the same.
  if (module == "__builtin__" || module == "exceptions") module = "builtins";
  if (module == "_io") module = "io";
  if (module == "commands") module = "subprocess";
  // As PyTorch names its memory formats: torch._utils, "torch.channels_last".
  constexpr std::string_view kTorch = "torch.";
  if (name.starts_with(kTorch) && name.find('.', kTorch.size()) == std::string_view::npos) {
    return find_global("torch", name.substr(kTorch.size()));
  }
  for (const Entry& entry : kGlobals) {
    if (entry.module == module && entry.name == name) return Global{entry.kind};
  }
  if (module == "torch" || module == "torch.cuda" || module == "torch.storage") {
    for (const Storage& storage : kStorages) {
      if (storage.name == name) return Global{GlobalKind::storage, storage.type};
    }
  }
  if (module == "torch._utils" && name.starts_with("_rebuild")) return Global{GlobalKind::unread_tensor};
  if (is_torch_script(module) || is_refused_global(module, name)) return std::nullopt;
  return Global{GlobalKind::record};
}

std::string_view advice_on_refused_global(std::string_view module, std::string_view name) {
  if (is_torch_script(module)) return "this is a TorchScript program: save its state_dict()";
  if (module == "torch.storage" && name == "_load_from_bytes") {
    return "this is a plain pickle, whose tensors are pickles again: save it with torch.save";
  }
  return "Python would run it while loading: the file may be an attack";
}

}  // namespace penumbra::weights_tools
