#include "weights_tools/pickle_globals.h"

#include <algorithm>
#include <array>
#include <cctype>

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

// Modules whose functions run programs or code, change files, load further pickles or reach the network; with
// all that lies inside them, and their twins that begin with "_". builtins is one: what checkpoints need of
// it stands above.
constexpr std::array<std::string_view, 111> kRefusedModules = {"builtins",
                                                               "os",
                                                               "posix",
                                                               "nt",
                                                               "subprocess",
                                                               "posixsubprocess",
                                                               "sys",
                                                               "shutil",
                                                               "socket",
                                                               "socketserver",
                                                               "pty",
                                                               "tty",
                                                               "commands",
                                                               "popen2",
                                                               "importlib",
                                                               "imp",
                                                               "runpy",
                                                               "code",
                                                               "codeop",
                                                               "pdb",
                                                               "bdb",
                                                               "timeit",
                                                               "trace",
                                                               "cProfile",
                                                               "profile",
                                                               "ctypes",
                                                               "cffi",
                                                               "webbrowser",
                                                               "antigravity",
                                                               "pickle",
                                                               "cPickle",
                                                               "dill",
                                                               "cloudpickle",
                                                               "joblib",
                                                               "shelve",
                                                               "dbm",
                                                               "sqlite3",
                                                               "marshal",
                                                               "types",
                                                               "io",
                                                               "signal",
                                                               "faulthandler",
                                                               "multiprocessing",
                                                               "concurrent",
                                                               "asyncio",
                                                               "asyncore",
                                                               "asynchat",
                                                               "smtpd",
                                                               "threading",
                                                               "thread",
                                                               "http",
                                                               "httplib",
                                                               "urllib",
                                                               "urllib2",
                                                               "requests",
                                                               "aiohttp",
                                                               "httpx",
                                                               "ftplib",
                                                               "telnetlib",
                                                               "smtplib",
                                                               "imaplib",
                                                               "poplib",
                                                               "nntplib",
                                                               "xmlrpc",
                                                               "ssl",
                                                               "pip",
                                                               "ensurepip",
                                                               "venv",
                                                               "setuptools",
                                                               "distutils",
                                                               "pkgutil",
                                                               "pydoc",
                                                               "doctest",
                                                               "unittest",
                                                               "pytest",
                                                               "nose",
                                                               "idlelib",
                                                               "lib2to3",
                                                               "tempfile",
                                                               "fileinput",
                                                               "linecache",
                                                               "tarfile",
                                                               "zipfile",
                                                               "zipimport",
                                                               "mmap",
                                                               "site",
                                                               "sitecustomize",
                                                               "usercustomize",
                                                               "compileall",
                                                               "py_compile",
                                                               "modulefinder",
                                                               "pyclbr",
                                                               "cgitb",
                                                               "mailcap",
                                                               "netrc",
                                                               "pipes",
                                                               "tkinter",
                                                               "turtle",
                                                               "curses",
                                                               "readline",
                                                               "osx_support",
                                                               "aix_support",
                                                               "pyrepl",
                                                               "pexpect",
                                                               "ptyprocess",
                                                               "paramiko",
                                                               "fabric",
                                                               "invoke",
                                                               "plumbum",
                                                               "sh",
                                                               "IPython"};

constexpr std::array<std::string_view, 19> kRefusedInside = {"torch.hub",
                                                             "torch.package",
                                                             "torch.utils.cpp_extension",
                                                             "torch.utils.collect_env",
                                                             "torch.utils.bottleneck",
                                                             "torch.utils.model_zoo",
                                                             "torch.distributed.rpc",
                                                             "torch.distributed.elastic",
                                                             "torch._inductor",
                                                             "torchvision.datasets.utils",
                                                             "numpy.f2py",
                                                             "numpy.distutils",
                                                             "numpy.testing",
                                                             "numpy.ctypeslib",
                                                             "logging.config",
                                                             "ruamel.yaml",
                                                             "sympy.parsing",
                                                             "test.support",
                                                             "test.libregrtest"};

// Modules that are refused as parts of other modules and of names, too: numpy.os, Net.sys. (Others have
// namesakes there, as torch.trace and scipy.signal.)
constexpr std::array<std::string_view, 12> kRefusedParts = {
    "builtins", "os",     "posix",     "nt",     "subprocess", "posixsubprocess",
    "sys",      "shutil", "importlib", "ctypes", "runpy",      "pty"};

// Functions that do such things, by their names in any module.
constexpr std::array<std::string_view, 25> kRefusedNames = {"system",
                                                            "popen",
                                                            "Popen",
                                                            "fork_exec",
                                                            "check_call",
                                                            "check_output",
                                                            "getoutput",
                                                            "getstatusoutput",
                                                            "__import__",
                                                            "import_module",
                                                            "execfile",
                                                            "_exec_with_source",
                                                            "_forward_from_src",
                                                            "load_library",
                                                            "unsafe_load",
                                                            "unsafe_load_all",
                                                            "open",
                                                            "open_code",
                                                            "fromfile",
                                                            "loadtxt",
                                                            "genfromtxt",
                                                            "read_pickle",
                                                            "load_url",
                                                            "urlopen",
                                                            "urlretrieve"};

constexpr std::array kRefusedFunctions = {
    Entry{"torch", "load", GlobalKind::record},
    Entry{"torch.storage", "_load_from_bytes", GlobalKind::record},
    Entry{"torch.serialization", "load", GlobalKind::record},
    Entry{"numpy", "load", GlobalKind::record},
    Entry{"numpy", "save", GlobalKind::record},
    Entry{"pandas", "eval", GlobalKind::record},
    Entry{"pandas.core.computation.eval", "eval", GlobalKind::record},
    Entry{"pandas", "read_json", GlobalKind::record},
    Entry{"pandas", "read_csv", GlobalKind::record},
    Entry{"sympy", "sympify", GlobalKind::record},
    Entry{"sympy.core.sympify", "sympify", GlobalKind::record},
    Entry{"yaml", "load", GlobalKind::record},
    Entry{"yaml", "load_all", GlobalKind::record},
    Entry{"uuid", "_get_command_stdout", GlobalKind::record},
    Entry{"platform", "_syscmd_ver", GlobalKind::record},
    Entry{"platform", "_syscmd_file", GlobalKind::record},
    Entry{"torch.utils._config_module", "load_config", GlobalKind::record},
    Entry{"atexit", "register", GlobalKind::record},
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

// Exceptions that a training script kept: classes, in whatever module.
bool is_exception(std::string_view name) {
  return std::isupper(static_cast<unsigned char>(name.front())) != 0 &&
         name.find('.') == std::string_view::npos &&
         (name.ends_with("Error") || name.ends_with("Exception") || name.ends_with("Warning"));
}

// Without the "_" that private twins begin with: _posixsubprocess, random._os.
std::string_view without_underscores(std::string_view name) {
  const std::size_t begin = name.find_first_not_of('_');
  return begin == std::string_view::npos ? name : name.substr(begin);
}

template <std::size_t kCount>
bool is_among(const std::array<std::string_view, kCount>& list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

// Whether a part of a dotted name, or all of it, is a module that gives everything away.
bool has_refused_part(std::string_view dotted) {
  while (true) {
    const std::size_t dot = dotted.find('.');
    if (is_among(kRefusedParts, without_underscores(dotted.substr(0, dot)))) return true;
    if (dot == std::string_view::npos) return false;
    dotted.remove_prefix(dot + 1);
  }
}

// A dotted name reaches into what it names. Inside a class it names a part of it (Net.Head), inside a module
// whatever that imports: torch.serialization.os.system. Modules have small letters.
bool leads_into_a_module(std::string_view name) {
  for (std::size_t dot = name.find('.'); dot != std::string_view::npos; dot = name.find('.')) {
    const std::string_view part = without_underscores(name.substr(0, dot));
    if (part.empty() || std::islower(static_cast<unsigned char>(part.front())) != 0) return true;
    name.remove_prefix(dot + 1);
  }
  return false;
}

bool is_refused(std::string_view module, std::string_view name) {
  if (name.empty()) return true;
  if (is_exception(name)) return false;
  const std::string_view top = without_underscores(module.substr(0, module.find('.')));
  const std::string_view last = name.substr(name.rfind('.') + 1);
  return is_among(kRefusedModules, top) || has_refused_part(module) || has_refused_part(name) ||
         leads_into_a_module(name) || is_among(kRefusedNames, last) ||
         std::any_of(kRefusedInside.begin(), kRefusedInside.end(),
                     [&](std::string_view package) { return lies_in(module, package); }) ||
         std::any_of(kRefusedFunctions.begin(), kRefusedFunctions.end(),
                     [&](const Entry& entry) { return entry.module == module && entry.name == name; });
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
  if (is_torch_script(module) || is_refused(module, name)) return std::nullopt;
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
