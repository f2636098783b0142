#include "tests/bench/compare_peers.h"

#include <fmt/format.h>
#include <unistd.h>

#include <ctime>
#include <filesystem>
#include <memory>

#include "nn/base/quantile.h"
#include "tests/bench/child.h"
#include "tests/bench/peer.h"

namespace penumbra {

namespace {

using nlohmann::ordered_json;

// The first of the Pythons in which the script does not miss a module, running; else what each of them
// misses.
std::unique_ptr<Peer> start(const PeerComparison& comparison, const std::vector<std::string>& arguments,
                            ordered_json& missing) {
  for (const std::string& python : comparison.pythons) {
    std::vector<std::string> command{python, PENUMBRA_PEERS};
    command.insert(command.end(), arguments.begin(), arguments.end());
    auto peer = std::make_unique<Peer>(command);
    if (!peer->facts().contains("missing")) return peer;
    missing.push_back(fmt::format("{}: {}", python, peer->facts()["missing"].get<std::string>()));
  }
  return nullptr;
}

ordered_json take_turns(const PeerComparison& comparison, Peer& peer) {
  constexpr int kWarmUp = 1;
  ordered_json result = peer.facts();
  for (const auto& [what, work] :
       {std::pair{"backbone", &comparison.backbone}, std::pair{"full", &comparison.full}}) {
    if (!peer.runs(what)) continue;
    std::vector<double> ours, theirs;
    for (int repeat = -kWarmUp; repeat < comparison.repeats; ++repeat) {
      const std::clock_t before = std::clock();
      (*work)();
      const double own = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC,
                   other = peer.seconds(what);
      if (repeat < 0) continue;
      ours.push_back(own);
      theirs.push_back(other);
    }
    const double own = quantile_of(ours, 0.5), other = quantile_of(theirs, 0.5);
    result[what] = {{"ours_ms", 1e3 * own}, {"theirs_ms", 1e3 * other}, {"ratio", own / other}};
  }
  return result;
}

}  // namespace

ordered_json compare_peers(const PeerComparison& comparison) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("bench_peers_{}", getpid());
  std::filesystem::create_directories(folder);
  const std::string threads = fmt::format("{}", comparison.threads),
                    model = (folder / "mask_rcnn.onnx").string();
  ordered_json result;

  ordered_json missing = ordered_json::array();
  const bool exported = start(comparison, {"export", folder.string()}, missing) != nullptr;
  if (auto torch = start(comparison, {"torch", "--threads", threads}, missing)) {
    result["torch"] = take_turns(comparison, *torch);
  } else {
    result["torch"] = {{"skipped", missing}};
  }
  if (exported) {
    for (const std::string& python : comparison.pythons) {
      try {
        const Child child = run_child(fmt::format("'{}' '{}' first '{}' --threads {}", python, PENUMBRA_PEERS,
                                                  folder.string(), threads));
        result["torch"]["first_image_seconds"] = child.processor_seconds;
        result["torch"]["start_ratio"] = comparison.first_image_seconds / child.processor_seconds;
        break;
      } catch (const std::exception&) {  // this one does not have it
      }
    }
  }

  missing = ordered_json::array();
  std::vector<std::string> arguments{"onnxruntime", "--threads", threads};
  if (exported) arguments.insert(arguments.end(), {"--model", model});
  if (auto runtime = start(comparison, arguments, missing)) {
    result["onnxruntime"] = take_turns(comparison, *runtime);
    if (!exported)
      result["onnxruntime"]["full"] = {{"skipped", "the model is exported by PyTorch, see torch"}};
  } else {
    result["onnxruntime"] = {{"skipped", missing}};
  }
  std::filesystem::remove_all(folder);
  return result;
}

}  // namespace penumbra
