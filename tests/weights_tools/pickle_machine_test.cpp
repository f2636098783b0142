// The pickle machine on byte strings that are assembled by hand, as CPython's pickletools.py describes them.
#include "weights_tools/pickle_machine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <deque>
#include <limits>

#include "nn/base/error.h"
#include "tests/support/bytes.h"
#include "weights_tools/torch_state_dict.h"

namespace penumbra::weights_tools {
namespace {

using namespace std::string_literals;
using test::little_endian;

// What a pickle describes views its bytes: they are kept until the test program ends.
PickledObject run(const std::string& pickle) {
  static std::deque<std::string> kept;
  return run_pickle(test::as_bytes(kept.emplace_back(pickle)), 0, "pickle");
}

std::string refusal(const std::string& pickle) {
  return test::message_of<InputError>([&] { run(pickle); });
}

std::string text(const std::string& value) {
  return "X"s + little_endian(static_cast<std::uint32_t>(value.size())) + value;
}
std::string integer(std::int32_t value) { return "J"s + little_endian(value); }

// ('storage', torch.FloatStorage, key, 'cpu', elements, view), as a persistent id
std::string storage(const std::string& key, int elements, const std::string& view = "") {
  return "("s + text("storage") + "ctorch\nFloatStorage\n" + text(key) + text("cpu") + integer(elements) +
         view + "tQ";
}
std::string tuple(const std::vector<int>& numbers) {
  std::string pickle = "(";
  for (const int number : numbers) pickle += integer(number);
  return pickle + "t";
}
// torch._utils._rebuild_tensor(storage, offset, size, stride)
std::string tensor(const std::string& storage, int offset, const std::vector<int>& size,
                   const std::vector<int>& stride) {
  return "ctorch._utils\n_rebuild_tensor\n("s + storage + integer(offset) + tuple(size) + tuple(stride) +
         "tR";
}
std::string dict_of_one(const std::string& name, const std::string& value) {
  return "}"s + text(name) + value + "s";
}

std::int64_t number(const std::string& pickle) {
  const PickledObject object = run(pickle);
  EXPECT_EQ(object[object.root].kind, ValueKind::integer);
  return object[object.root].number;
}

TEST(PickleMachine, IntegersOfEveryWidth) {
  EXPECT_EQ(number("K\xFF."), 255);
  EXPECT_EQ(number("M\xFF\xFF."), 65535);
  EXPECT_EQ(number("J\xFF\xFF\xFF\xFF."), -1);
  EXPECT_EQ(number("\x8a\x00."s), 0);
  EXPECT_EQ(number("\x8a\x01\x80."), -128);
  EXPECT_EQ(number("\x8a\x02\x80\x00."s), 128);
  EXPECT_EQ(number("\x8a\x08\x00\x00\x00\x00\x00\x00\x00\x80."s), std::numeric_limits<std::int64_t>::min());
  const PickledObject large = run("\x8a\x09"s + std::string(9, '\1') + ".");
  EXPECT_EQ(large[large.root].kind, ValueKind::bytes);
}

TEST(PickleMachine, ContainersKeepTheirItems) {
  // {"a": [1], "b": ((None, True),)}
  const std::string list = "]K\x01"s + "a", tuple = "(N\x88t\x85";
  const PickledObject object = run("\x80\x02}("s + text("a") + list + text("b") + tuple + "u.");
  const Value& dict = object[object.root];
  ASSERT_EQ(dict.kind, ValueKind::dict);
  ASSERT_EQ(dict.items.size(), 4U);
  EXPECT_EQ(object[dict.items[0]].text, "a");
  ASSERT_EQ(object[dict.items[1]].kind, ValueKind::list);
  EXPECT_EQ(object[object[dict.items[1]].items.at(0)].number, 1);
  const Value& outer = object[dict.items[3]];
  ASSERT_EQ(outer.items.size(), 1U);
  const Value& inner = object[outer.items[0]];
  ASSERT_EQ(inner.items.size(), 2U);
  EXPECT_EQ(object[inner.items[0]].kind, ValueKind::none);
  EXPECT_EQ(object[inner.items[1]].kind, ValueKind::boolean);
}

TEST(PickleMachine, TheMemoSharesObjects) {
  // l = []; l.append(1); (l, l)
  const PickledObject object = run("(]q\x05K\x01"s + "aj\x05\x00\x00\x00t."s);
  const Value& tuple = object[object.root];
  ASSERT_EQ(tuple.items.size(), 2U);
  EXPECT_EQ(tuple.items[0], tuple.items[1]);
  EXPECT_EQ(object[tuple.items[0]].items.size(), 1U);
}

TEST(PickleMachine, ProtocolFourNamesGlobalsOnTheStack) {
  const PickledObject object = run("\x80\x04\x95\x00\x00\x00\x00\x00\x00\x00\x00\x8c\x0b"s +
                                   "collections\x94\x8c\x0bOrderedDict\x94\x93)R.");
  EXPECT_EQ(object[object.root].kind, ValueKind::dict);
}

TEST(PickleMachine, OrderedDictOfPython2TakesAListOfPairs) {
  const PickledObject object = run("ccollections\nOrderedDict\n(](]("s + text("a") +
                                   "K\x01"
                                   "e](" +
                                   text("b") +
                                   "K\x02"
                                   "eetR.");
  ASSERT_EQ(object[object.root].kind, ValueKind::dict);
  EXPECT_EQ(object[object.root].items.size(), 4U);
  EXPECT_CONTAINS(refusal("ccollections\nOrderedDict\n(](K\x01K\x02"
                          "etR."),
                  "a list of pairs");
}

TEST(PickleMachine, GlobalsThatAreNotAllowedAreNamedWithTheirPlace) {
  const std::string message = refusal("\x80\x02}cposix\nsystem\n"s + text("true") + "\x85R.");
  EXPECT_CONTAINS(message, "pickle: byte 3");
  EXPECT_CONTAINS(message, "posix.system");
  EXPECT_CONTAINS(message, "nothing was executed");
  for (const std::string global :
       {"builtins\neval", "__builtin__\nexecfile", "builtins\nbuiltins.eval", "os\nsystem",
        "os.path\nos.system", "subprocess\nPopen", "runpy\n_run_code", "webbrowser\nopen", "pip\nmain",
        "torch\nload", "types\nCodeType", "torch.storage\n_load_from_bytes", "torch.hub\nload",
        "numpy.testing._private.utils\nrunstring", "ctypes\nCDLL", "importlib\nimport_module"}) {
    EXPECT_CONTAINS(refusal("c"s + global + "\n)R."), "nothing was executed");
  }
  EXPECT_CONTAINS(refusal("\x8c\x02"
                          "os\x8c\x06system\x93."),
                  "os.system");
  EXPECT_CONTAINS(refusal("cos\nsys\x1b[2Jtem\n."), "\\x1b");
}

TEST(PickleMachine, NoPartOfADottedNameLeadsToARefusedModule) {
  for (const std::string global : {"random\n_os.system",
                                   "argparse\n_os.system",
                                   "torch.serialization\nos.system",
                                   "torch\nos",
                                   "torch.utils.collect_env\nrun",
                                   "_posixsubprocess\nfork_exec",
                                   "psutil\nPopen",
                                   "pexpect\nrun",
                                   "yaml\nunsafe_load",
                                   "sympy\nsympify",
                                   "pandas\neval",
                                   "torch.fx.graph_module\n_exec_with_source",
                                   "uuid\n_get_command_stdout",
                                   "platform\n_syscmd_ver",
                                   "torch.ops\nload_library",
                                   "numpy.ctypeslib\nload_library",
                                   "site\nexecsitecustomize",
                                   "compileall\ncompile_dir",
                                   "zipimport\nzipimporter",
                                   "test.support.script_helper\nassert_python_ok",
                                   "_io\nFileIO",
                                   "train\n",
                                   "collections\n_sys.modules.get",
                                   "numpy\nlib.npyio.os.system",
                                   "zoneinfo\n_common.load_tzdata",
                                   "__main__\n__builtins__.eval",
                                   "train.os\nX",
                                   "train\nNet.sys.exit",
                                   "exceptions\neval"}) {
    EXPECT_CONTAINS(refusal("c"s + global + "\n)R."), "may be an attack");
  }
  // Classes inside classes, and names that only look alike.
  for (const std::string global :
       {"train\nNet.Head", "train.models\nNet._Head.Part", "models.common\nConv", "my.types\nOptions",
        "torch\ntrace", "scipy.signal\nX", "operators\nosx", "project.code.io\nReader"}) {
    EXPECT_NO_THROW(run("c"s + global + "\n)R.")) << global;
  }
  EXPECT_CONTAINS(refusal("ctorch.storage\n_load_from_bytes\n)R."), "save it with torch.save");
}

TEST(PickleMachine, HarmlessValuesOfThePythonLibraryAreRecords) {
  for (const std::string global : {"types\nGenericAlias",
                                   "os\nstat_result",
                                   "posix\nuname_result",
                                   "os\nterminal_size",
                                   "subprocess\nCompletedProcess",
                                   "subprocess\nCalledProcessError",
                                   "builtins\nKeyboardInterrupt",
                                   "builtins\nSystemExit",
                                   "builtins\nStopIteration",
                                   "builtins\nGeneratorExit",
                                   "builtins\nExceptionGroup",
                                   "exceptions\nKeyboardInterrupt",
                                   "builtins\nmax",
                                   "__builtin__\nlen",
                                   "builtins\nsorted",
                                   "builtins\nprint",
                                   "builtins\niter",
                                   "builtins\nreversed",
                                   "builtins\nenumerate",
                                   "builtins\nrange",
                                   "functools\npartial",
                                   "operator\nattrgetter",
                                   "_operator\nmethodcaller",
                                   "operator\nitemgetter",
                                   "signal\nSignals",
                                   "http\nHTTPStatus",
                                   "socket\nAddressFamily",
                                   "urllib.parse\nParseResult",
                                   "_io\nStringIO",
                                   "commands\nCompletedProcess",
                                   "__builtin__\nreduce",
                                   "torch._utils\ntorch.channels_last"}) {
    const PickledObject object = run("c"s + global + "\n)R.");
    EXPECT_EQ(object[object.root].kind, ValueKind::object) << global;
  }
  // functools.reduce(operator.or_, (int, NoneType)): int | None
  EXPECT_NO_THROW(run("cfunctools\nreduce\nc_operator\nor_\ncbuiltins\nint\nN\x86\x86R."));
  // getattr(zoneinfo.ZoneInfo, "_unpickle")("Europe/Berlin", 1)
  const std::string zone = "cbuiltins\ngetattr\nczoneinfo\nZoneInfo\n"s + text("_unpickle") + "\x86R" +
                           text("Europe/Berlin") + "K\x01\x86R.";
  const PickledObject berlin = run(zone);
  EXPECT_EQ(berlin[berlin.root].text, "ZoneInfo");
  EXPECT_CONTAINS(refusal("coperator\nattrgetter\n"s + text("__globals__") + "\x85Rctrain\nf\n\x85R."),
                  "may be an attack");
}

TEST(PickleMachine, OperationsThatAreNotAllowedAreNamed) {
  // OBJ, EXT1, NEXT_BUFFER, DUP, and the text protocol
  for (const std::string opcode : {"o", "\x82", "\x97", "2", "I", "V", "g", "p", "\xFF", "\n"}) {
    EXPECT_CONTAINS(refusal("("s + opcode + "posix\nsystem\n."), "opcode");
  }
  EXPECT_CONTAINS(refusal("(iposix\nsystem\n."), "posix.system (nothing was executed; Python would run it");
  EXPECT_CONTAINS(refusal("(itrain\nNet\n."), "INST of train.Net");
  EXPECT_CONTAINS(refusal("Pposix.system\n."), "PERSID 'posix.system'");
}

TEST(PickleMachine, OnlyListedFunctionsAreCalled) {
  EXPECT_CONTAINS(refusal("K\x01)R."), "a class or function");
  EXPECT_CONTAINS(refusal("])R."), "a class or function");
  EXPECT_CONTAINS(refusal("ctorch\nFloatStorage\n)R."), "a storage");
  EXPECT_CONTAINS(refusal("ctorch._utils\n_rebuild_tensor_v2\n)R."), "arguments");
  EXPECT_CONTAINS(refusal("ctorch._utils\n_rebuild_tensor_v2\n(NNNNtR."), "a torch storage");
  EXPECT_CONTAINS(
      refusal("ctorch._tensor\n_rebuild_from_type_v2\n(ctorch._tensor\n_rebuild_from_type_v2\nN)tR."),
      "rebuilds a tensor");
}

TEST(PickleMachine, ClassesThatNobodyKnowsBecomeTheirAttributes) {
  const PickledObject object =
      run("ctrain\nNet\n)\x81}"s + text("lr") + "G\x3F\xE0\x00\x00\x00\x00\x00\x00"s + "sb.");
  const Value& root = object[object.root];
  ASSERT_EQ(root.kind, ValueKind::object);
  EXPECT_EQ(root.text, "Net");
  const Value* rate = object.find(root, "lr");
  ASSERT_NE(rate, nullptr);
  EXPECT_EQ(std::bit_cast<double>(rate->number), 0.5);
}

TEST(PickleMachine, TheResultOfGetattrIsNotCalled) {
  const std::string scheduler = "ctorch.optim.lr_scheduler\nOneCycleLR\n";
  EXPECT_NO_THROW(run("cbuiltins\ngetattr\n"s + scheduler + text("_annealing_cos") + "\x86R."));
  EXPECT_CONTAINS(refusal("cbuiltins\ngetattr\n"s + scheduler + text("step") + "\x86R)R."),
                  "may be an attack");
  EXPECT_CONTAINS(refusal("cbuiltins\ngetattr\n"s + scheduler + text("__globals__") + "\x86R."),
                  "__globals__");
}

TEST(FindStateDict, ActivationsAreNamedWhateverTheirClass) {
  for (const std::string name :
       {"SiLU", "AconC", "MetaAconC", "MemoryEfficientMish", "Hardtanh", "Identity"}) {
    const std::string weight =
        text("_parameters") + "}" + text("w") + tensor(storage("0", 1), 0, {1}, {1}) + "s";
    const PickledObject object = run("cmodels.common\nConv\n)\x81}("s + weight + text("_modules") + "}" +
                                     text("act") + "cany.module\n" + name + "\n)\x81sub.");
    EXPECT_EQ(find_state_dict(object, "pickle").metadata.at("activations"), name);
  }
}

TEST(FindStateDict, SettingsOfDetectorsAreKeptOrSaid) {
  const auto real = [](double value) {
    std::string bytes = little_endian(std::bit_cast<std::uint64_t>(value)) + "G";
    std::reverse(bytes.begin(), bytes.end());
    return bytes;
  };
  const std::string weight =
      text("_parameters") + "}" + text("w") + tensor(storage("0", 1), 0, {1}, {1}) + "s";
  const TorchState transform =
      find_state_dict(run("ct\nGeneralizedRCNNTransform\n)\x81}("s + weight + text("image_mean") + "](" +
                          real(0) + real(0.5) + "e" + text("min_size") + "K\x20\x85ub."),
                      "pickle");
  EXPECT_EQ(transform.metadata.at("image_mean"), "0,0.5");
  EXPECT_EQ(transform.metadata.at("min_size"), "32");
  const TorchState heads = find_state_dict(run("ct\nRoIHeads\n)\x81}("s + weight + text("score_thresh") +
                                               real(0.3) + text("nms_thresh") + real(0.5) + "ub."),
                                           "pickle");
  EXPECT_EQ(heads.notes, std::vector<std::string>{"RoIHeads.score_thresh = 0.3 is not taken: 0.05 is used"});
}

TEST(FindStateDict, NetworksThatShareTheirPartsAreBounded) {
  // Each part holds the one before ten times.
  std::string pickle = "ctrain\nPart\n)\x81}"s + text("_parameters") + "}" + text("w") +
                       tensor(storage("0", 1), 0, {1}, {1}) + "ssbq\x01"s;
  for (int level = 1; level < 12; ++level) {
    pickle += "ctrain\nPart\n)\x81}"s + text("_modules") + "}";
    for (int i = 0; i < 10; ++i) pickle += text(std::to_string(i)) + "h"s + static_cast<char>(level) + "s";
    pickle += "sbq"s + static_cast<char>(level + 1);
  }
  const PickledObject object = run(pickle + ".");
  EXPECT_CONTAINS(test::message_of<InputError>([&] { find_state_dict(object, "pickle"); }), "shared parts");
}

TEST(FindStateDict, NetworksThatHoldThemselvesAreBounded) {
  const PickledObject object =
      run("ctrain\nPart\n)\x81q\x01}"s + text("_modules") + "}" + text("a") + "h\x01ssb.");
  EXPECT_CONTAINS(test::message_of<InputError>([&] { find_state_dict(object, "pickle"); }), "nested parts");
}

TEST(PickleMachine, EveryUnderflowIsAnError) {
  for (const std::string pickle :
       {".",     "a.",  "s.",  "u.",       "e.",     "t.",       "\x85.",     "]\x86.",   "]]\x87.",
        "R.",    "]R.", "b.",  "]b.",      "q\x01.", "Q.",       "0.",        "1.",       "\x94.",
        "\x93.", "(.",  "(a.", "K\x01(e.", "(0.",    "}K\x01s.", "}(K\x01u.", "]K\x01s.", "\x8f.x"}) {
    if (pickle == "\x8f.x") {
      EXPECT_EQ(run(pickle).end, 2U);  // what follows the pickle is not its concern
    } else {
      EXPECT_THROW(run(pickle), InputError) << pickle;
    }
  }
}

TEST(PickleMachine, LengthsBeyondTheEndAreRefused) {
  for (const std::string pickle :
       {"X\xFF\xFF\xFF\xFFx", "\x8d\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFFx", "T\xFF\xFF\xFF\x7F",
        "B\xFF\xFF\xFF\xFF", "C\x05", "\x8a\x05\x01", "U\x09x", "G\x01", "J\x01", "M", "K", "cabc",
        "cabc\nxyz", "", "\x80", "]q", "r\x01"}) {
    EXPECT_CONTAINS(refusal(pickle), "truncated");
  }
  EXPECT_CONTAINS(refusal("c"s + std::string(100'000, 'a') + "\nb\n."), "truncated");
}

TEST(PickleMachine, ProtocolsOfTheFutureAreRefused) { EXPECT_CONTAINS(refusal("\x80\x06N."), "protocol"); }

TEST(PickleMachine, MemoIndicesAreBounded) {
  EXPECT_CONTAINS(refusal("]r\xFF\xFF\xFF\xFF."), "memo index");
  EXPECT_CONTAINS(refusal("h\x00."s), "stored before");
  EXPECT_CONTAINS(refusal("]q\x02h\x01."), "stored before");
}

TEST(PickleMachine, NestedSharingTakesNoMoreThanItsBytes) {
  // "Billion laughs": each tuple holds the one before ten times; written out it would have 10^200 leaves.
  std::string pickle = text("ha") + "q"s + "\x00"s;
  for (int level = 0; level < 200; ++level) {
    pickle += "(";
    for (int i = 0; i < 10; ++i) pickle += "h"s + std::string(1, static_cast<char>(level));
    pickle += "tq"s + std::string(1, static_cast<char>(level + 1));
  }
  const PickledObject object = run(pickle + ".");
  EXPECT_EQ(object.values.size(), 201U);
  EXPECT_THROW(find_state_dict(object, "pickle"), InputError);
}

TEST(PickleMachine, DepthDoesNotRecurse) {
  EXPECT_EQ(run("]"s + std::string(1'000'000, '\x85') + ".").values.size(), 1'000'001U);
  EXPECT_CONTAINS(refusal(std::string(1'000'000, '(') + "."), "1 values on the stack");
}

TEST(PickleMachine, TooManyValuesAreRefused) {
  EXPECT_CONTAINS(refusal(std::string(kMostPickledValues + 1, 'N') + "."), "values");
}

TEST(PickleMachine, CopiesOfASharedListAreBounded) {
  std::string pickle =
      "ccollections\nOrderedDict\nq\x01"
      "0(](" +
      std::string();
  for (int i = 0; i < 100'000; ++i) pickle += "NN\x86";
  pickle +=
      "etq\x02"
      "0";
  for (int i = 0; i < 1'000'000; ++i) pickle += "h\x01h\x02R0";
  EXPECT_CONTAINS(refusal(pickle + "N."), "items in all");
}

TEST(FindStateDict, StorageViewsOfTheLegacyFormatShiftTheTensor) {
  const std::string view = "("s + text("view") + integer(4) + integer(6) + "t";
  const PickledObject object =
      run(dict_of_one("w", tensor(storage("root", 10, view), 1, {2, 2}, {2, 1})) + ".");
  const std::vector<TorchTensor> tensors = find_state_dict(object, "pickle").tensors;
  ASSERT_EQ(tensors.size(), 1U);
  EXPECT_EQ(tensors[0].name, "w");
  EXPECT_EQ(tensors[0].offset, 5);
  EXPECT_EQ(object.storages.at(tensors[0].storage).key, "root");
  EXPECT_EQ(object.storages.at(tensors[0].storage).elements, 10);

  EXPECT_THROW(
      find_state_dict(run(dict_of_one("w", tensor(storage("root", 10, view), 3, {2, 2}, {2, 1})) + "."), ""),
      InputError);  // within the root, outside the view
  const std::string outside = "("s + text("view") + integer(5) + integer(6) + "t";
  EXPECT_CONTAINS(refusal(storage("root", 10, outside) + "."), "a view within");
}

TEST(FindStateDict, ViewsThatLeaveTheirStorageAreRefused) {
  const auto find = [](int offset, const std::vector<int>& size, const std::vector<int>& stride) {
    const std::string pickle = dict_of_one("w", tensor(storage("0", 6), offset, size, stride)) + ".";
    return find_state_dict(run(pickle), "pickle");
  };
  EXPECT_NO_THROW(find(0, {2, 3}, {3, 1}));
  EXPECT_NO_THROW(find(5, {}, {}));
  EXPECT_NO_THROW(find(5, {7}, {0}));
  EXPECT_NO_THROW(find(999, {0, 5}, {5, 1}));
  EXPECT_THROW(find(1, {2, 3}, {3, 1}), InputError);
  EXPECT_THROW(find(6, {}, {}), InputError);
  EXPECT_THROW(find(-1, {1}, {1}), InputError);
  EXPECT_THROW(find(0, {-1}, {1}), InputError);
  EXPECT_THROW(find(5, {2}, {-1}), InputError);
  EXPECT_THROW(find(0, {2, 3}, {3}), InputError);
  const int most = std::numeric_limits<int>::max();
  EXPECT_THROW(find(0, {most, most, most}, {0, 0, 0}), InputError);
  EXPECT_THROW(find(most, {most, most}, {most, most}), InputError);
  EXPECT_THROW(find(0, std::vector<int>(100, 1), std::vector<int>(100, 1)), InputError);
}

TEST(FindStateDict, OneStorageHasOneTypeAndSize) {
  EXPECT_NO_THROW(run("("s + storage("0", 6) + storage("0", 6) + "t."));
  EXPECT_CONTAINS(refusal("("s + storage("0", 6) + storage("0", 7) + "t."), "7 of F32");
  EXPECT_CONTAINS(refusal(storage("0", -1) + "."), "element count >= 0");
  EXPECT_CONTAINS(refusal(storage(std::string(1000, 'k'), 1) + "."), "storage key");
}

TEST(FindStateDict, DictsThatHoldThemselvesEndTheSearch) {
  // d = {}; d["model"] = d["state_dict"] = d
  const std::string self = "}q\x01"s + text("model") + "h\x01s" + text("state_dict") + "h\x01s";
  EXPECT_THROW(find_state_dict(run(self + "."), "pickle"), InputError);
  const TorchState found =
      find_state_dict(run(self + text("w") + tensor(storage("0", 1), 0, {1}, {1}) + "s."), "pickle");
  ASSERT_EQ(found.tensors.size(), 1U);
}

TEST(FindStateDict, TheLastOfANameCountsAsInPython) {
  const std::string pickle = "}"s + text("w") + tensor(storage("0", 4), 0, {4}, {1}) + "s" + text("w") +
                             tensor(storage("1", 2), 0, {2}, {1}) + "s.";
  const PickledObject object = run(pickle);
  const std::vector<TorchTensor> tensors = find_state_dict(object, "pickle").tensors;
  ASSERT_EQ(tensors.size(), 1U);
  EXPECT_EQ(tensors[0].shape, std::vector<std::int64_t>{2});
}

TEST(FindStateDict, AWholeNumberAndItsTextAreNotOneName) {
  const std::string one = tensor(storage("0", 1), 0, {1}, {1});
  const PickledObject object = run("}K\x01"s + one + "s" + text("1") + one + "s.");
  EXPECT_CONTAINS(test::message_of<InputError>([&] { find_state_dict(object, "pickle"); }), "both 1 and '1'");
}

TEST(FindStateDict, ElementTypesThatNoNetworkUsesAreLeftOut) {
  const PickledObject object = run("}("s + text("w") + tensor(storage("0", 1), 0, {1}, {1}) + text("q") +
                                   "ctorch._utils\n_rebuild_tensor_v3\n)Ru.");
  const TorchState state = find_state_dict(object, "pickle");
  ASSERT_EQ(state.tensors.size(), 1U);
  EXPECT_EQ(state.tensors[0].name, "w");
  ASSERT_EQ(state.notes.size(), 1U);
  EXPECT_CONTAINS(state.notes[0], "left out: q");
}

TEST(FindStateDict, NamesMustBeShortUtf8) {
  const std::string one = tensor(storage("0", 1), 0, {1}, {1});
  EXPECT_THROW(find_state_dict(run(dict_of_one("\xED\xA0\x80", one) + "."), ""), InputError);
  EXPECT_THROW(find_state_dict(run(dict_of_one(std::string(100'000, 'x'), one) + "."), ""), InputError);
}

}  // namespace
}  // namespace penumbra::weights_tools
