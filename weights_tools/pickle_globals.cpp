#include "weights_tools/pickle_globals.h"

#include <algorithm>
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
    // Inside modules that are refused otherwise.
    Entry{"io", "BytesIO", GlobalKind::record},
    Entry{"io", "StringIO", GlobalKind::record},
    Entry{"_io", "BytesIO", GlobalKind::record},
    Entry{"_io", "StringIO", GlobalKind::record},
    Entry{"types", "SimpleNamespace", GlobalKind::record},
    Entry{"types", "MappingProxyType", GlobalKind::record},
};

// Modules whose functions run programs or code, change files, load further pickles or reach the network; with
// all that lies inside them. builtins is one: what checkpoints need of it stands above.
constexpr std::array<std::string_view, 74> kRefusedModules = {
    "builtins",   "os",           "posix",     "nt",        "subprocess",  "sys",          "shutil",
    "socket",     "socketserver", "pty",       "tty",       "commands",    "popen2",       "importlib",
    "imp",        "runpy",        "code",      "codeop",    "pdb",         "bdb",          "timeit",
    "trace",      "cProfile",     "profile",   "ctypes",    "_ctypes",     "cffi",         "webbrowser",
    "pickle",     "_pickle",      "cPickle",   "dill",      "cloudpickle", "joblib",       "shelve",
    "marshal",    "types",        "io",        "_io",       "signal",      "faulthandler", "multiprocessing",
    "concurrent", "asyncio",      "threading", "_thread",   "http",        "httplib",      "urllib",
    "urllib2",    "requests",     "aiohttp",   "httpx",     "ftplib",      "telnetlib",    "smtplib",
    "xmlrpc",     "ssl",          "pip",       "ensurepip", "venv",        "setuptools",   "distutils",
    "pkgutil",    "pydoc",        "doctest",   "unittest",  "idlelib",     "lib2to3",      "tempfile",
    "fileinput",  "linecache",    "tarfile",   "zipfile"};

constexpr std::array<std::string_view, 7> kRefusedInside = {
    "torch.hub",       "torch.package", "torch.utils.cpp_extension", "torch.distributed.rpc", "numpy.f2py",
    "numpy.distutils", "numpy.testing"};

constexpr std::array kRefusedFunctions = {
    Entry{"torch", "load", GlobalKind::record},
    Entry{"torch.storage", "_load_from_bytes", GlobalKind::record},
    Entry{"numpy", "load", GlobalKind::record},
    Entry{"numpy", "fromfile", GlobalKind::record},
    Entry{"numpy", "loadtxt", GlobalKind::record},
    Entry{"numpy", "genfromtxt", GlobalKind::record},
    Entry{"numpy", "save", GlobalKind::record},
    Entry{"pandas", "read_pickle", GlobalKind::record},
    Entry{"torch.serialization", "load", GlobalKind::record},
    Entry{"codecs", "open", GlobalKind::record},
    Entry{"operator", "attrgetter", GlobalKind::record},
    Entry{"operator", "methodcaller", GlobalKind::record},
    Entry{"_operator", "attrgetter", GlobalKind::record},
    Entry{"_operator", "methodcaller", GlobalKind::record},
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

bool lies_in(std::string_view module, std::string_view package) {
  return module.starts_with(package) && (module.size() == package.size() || module[package.size()] == '.');
}

bool is_torch_script(std::string_view module) {
  return lies_in(module, "__torch__") || lies_in(module, "torch.jit");
}

// Exceptions that a training script kept.
bool is_exception(std::string_view module, std::string_view name) {
  return module == "builtins" &&
         (name.ends_with("Error") || name.ends_with("Exception") || name.ends_with("Warning"));
}

bool is_refused(std::string_view module, std::string_view name) {
  if (is_exception(module, name)) return false;
  const auto is_around = [&](std::string_view package) { return lies_in(module, package); };
  // A dotted name reaches into what it names: os can be spelled shutil.os.
  const std::string_view first = name.substr(0, name.find('.'));
  return std::any_of(kRefusedModules.begin(), kRefusedModules.end(),
                     [&](std::string_view package) {
                       return is_around(package) || (first.size() < name.size() && first == package);
                     }) ||
         std::any_of(kRefusedInside.begin(), kRefusedInside.end(), is_around) ||
         std::any_of(kRefusedFunctions.begin(), kRefusedFunctions.end(),
                     [&](const Entry& entry) { return entry.module == module && entry.name == name; });
}

}  // namespace

std::optional<Global> find_global(std::string_view module, std::string_view name) {
  if (module == "__builtin__") module = "builtins";  // Python 2's, which protocol 2 writes
  for (const Entry& entry : kGlobals) {
    if (entry.module == module && entry.name == name) return Global{entry.kind};
  }
  if (module == "torch" || module == "torch.cuda" || module == "torch.storage") {
    for (const Storage& storage : kStorages) {
      if (storage.name == name) return Global{GlobalKind::storage, storage.type};
    }
  }
  if (module == "torch._utils" && name.starts_with("_rebuild")) return Global{GlobalKind::unread_tensor};
  if (is_torch_script(module) || is_refused(module, name)) return std::nullopt;
  return Global{GlobalKind::record};
}

std::string_view advice_on_refused_global(std::string_view module) {
  if (is_torch_script(module)) return "this is a TorchScript program: save its state_dict()";
  return "Python would run it while loading: the file may be an attack";
}

}  // namespace penumbra::weights_tools
