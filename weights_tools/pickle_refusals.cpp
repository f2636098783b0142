#include "weights_tools/pickle_refusals.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace penumbra::weights_tools {

namespace {

// Modules whose functions run programs or code, change files, load further pickles or reach the network; with
// all that lies inside them, and their twins that begin with "_". builtins is one: what checkpoints need of
// it stands in pickle_globals.cpp.
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

struct RefusedFunction {
  std::string_view module, name;
};

constexpr std::array kRefusedFunctions = {
    RefusedFunction{"torch", "load"},
    RefusedFunction{"torch.storage", "_load_from_bytes"},
    RefusedFunction{"torch.serialization", "load"},
    RefusedFunction{"numpy", "load"},
    RefusedFunction{"numpy", "save"},
    RefusedFunction{"pandas", "eval"},
    RefusedFunction{"pandas.core.computation.eval", "eval"},
    RefusedFunction{"pandas", "read_json"},
    RefusedFunction{"pandas", "read_csv"},
    RefusedFunction{"sympy", "sympify"},
    RefusedFunction{"sympy.core.sympify", "sympify"},
    RefusedFunction{"yaml", "load"},
    RefusedFunction{"yaml", "load_all"},
    RefusedFunction{"uuid", "_get_command_stdout"},
    RefusedFunction{"platform", "_syscmd_ver"},
    RefusedFunction{"platform", "_syscmd_file"},
    RefusedFunction{"torch.utils._config_module", "load_config"},
    RefusedFunction{"atexit", "register"},
};

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

}  // namespace

bool module_lies_in(std::string_view module, std::string_view package) {
  return module.starts_with(package) && (module.size() == package.size() || module[package.size()] == '.');
}

bool is_refused_global(std::string_view module, std::string_view name) {
  if (name.empty()) return true;
  if (is_exception(name)) return false;
  const std::string_view top = without_underscores(module.substr(0, module.find('.')));
  const std::string_view last = name.substr(name.rfind('.') + 1);
  return is_among(kRefusedModules, top) || has_refused_part(module) || has_refused_part(name) ||
         leads_into_a_module(name) || is_among(kRefusedNames, last) ||
         std::any_of(kRefusedInside.begin(), kRefusedInside.end(),
                     [&](std::string_view package) { return module_lies_in(module, package); }) ||
         std::any_of(kRefusedFunctions.begin(), kRefusedFunctions.end(), [&](const RefusedFunction& entry) {
           return entry.module == module && entry.name == name;
         });
}

}  // namespace penumbra::weights_tools
