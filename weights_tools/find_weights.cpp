#include "weights_tools/find_weights.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "weights_tools/weight_names.h"

namespace penumbra::weights_tools {

namespace {

constexpr std::size_t kDeepestKey = 4, kMostHolders = 1000, kMostVisited = 100'000;
// Averaged weights first, as YOLOv5's and timm's own loaders take them.
constexpr std::array<std::string_view, 7> kAveraged = {
    "model_ema", "state_dict_ema", "ema_state_dict", "ema", "params_ema", "g_ema", "averaged_model"};
constexpr std::array<std::string_view, 14> kUsual = {
    "state_dict",     "model_state_dict", "model_state", "model",   "module", "net",     "network",
    "net_state_dict", "params",           "generator",   "weights", "netG",   "teacher", "student"};
constexpr int kOrdinaryRank = 500;  // of other keys, and of tensors that stand outermost
// Words in the keys of what is not a network.
constexpr std::array<std::string_view, 25> kOther = {
    "optim",      "optimizer", "optimizers", "optimiser", "optimisers", "sched", "scheduler",
    "schedulers", "scaler",    "scalers",    "rng",       "random",     "loss",  "losses",
    "criterion",  "hyper",     "hparams",    "callback",  "callbacks",  "args",  "config",
    "configs",    "cfg",       "metric",     "metrics"};

struct Holder {
  std::vector<std::string> path;  // keys
  const Value* value = nullptr;
  FoundWeights weights;
  bool is_other = false;   // its keys are those of something that is no network
  bool is_known = false;   // its names are those of a network that Penumbra runs
  std::vector<int> ranks;  // of its keys, lower is better

  std::string key() const { return fmt::format("{}", fmt::join(path, ".")); }
};

bool holds(const PickledObject& object, ValueId id) {
  const ValueKind kind = object[id].kind;
  return kind == ValueKind::tensor || kind == ValueKind::unread_tensor;
}

bool holds_tensors(const PickledObject& object, const Value& dict) {
  for (std::size_t i = 1; i < dict.items.size(); i += 2) {
    if (holds(object, dict.items[i])) return true;
  }
  return false;
}

// Whether one of the key's words, as in "lr_scheduler", "loss.fn" and "optimizerG", is that of something
// else.
bool is_of_something_else(std::string_view key) {
  std::string word;
  bool was_small = false;
  for (std::size_t i = 0; i <= key.size(); ++i) {
    const unsigned char c = i < key.size() ? static_cast<unsigned char>(key[i]) : '.';
    const bool begins = std::isalpha(c) == 0 || (std::isupper(c) != 0 && was_small);
    if (begins) {
      if (std::find(kOther.begin(), kOther.end(), word) != kOther.end()) return true;
      word.clear();
    }
    if (std::isalpha(c) != 0) word += lower_case(static_cast<char>(c));
    was_small = std::islower(c) != 0;
  }
  return false;
}

int rank_of(std::string_view key) {
  const auto averaged = std::find(kAveraged.begin(), kAveraged.end(), key);
  if (averaged != kAveraged.end()) return static_cast<int>(averaged - kAveraged.begin());
  const auto usual = std::find(kUsual.begin(), kUsual.end(), key);
  return usual != kUsual.end() ? 100 + static_cast<int>(usual - kUsual.begin()) : kOrdinaryRank;
}

bool is_averaged(const Holder& holder) {
  return std::any_of(holder.ranks.begin(), holder.ranks.end(), [](int rank) { return rank < 100; });
}

// Tensors by name; whole numbers are names, too. The last of a name counts, as in Python.
std::vector<NamedValue> tensors_of(const PickledObject& object, const Value& dict, const std::string& place) {
  struct Entry {
    ValueId id = 0;
    ValueKind key_kind = ValueKind::text;
  };
  std::map<std::string, Entry> entries;
  for (std::size_t i = 0; i + 1 < dict.items.size(); i += 2) {
    const Value& name = object[dict.items[i]];
    // Checked before names are compared, which could take hours with ones of megabytes.
    if (name.kind == ValueKind::text && name.text.size() > kLongestTensorName) {
      throw InputError(place, fmt::format("names of at most {} bytes", kLongestTensorName),
                       fmt::format("{} bytes: \"{}\"", name.text.size(), printable(name.text, 40)));
    }
    if (name.kind == ValueKind::text || name.kind == ValueKind::integer) {
      const std::string text =
          name.kind == ValueKind::text ? std::string(name.text) : fmt::format("{}", name.number);
      const auto [entry, is_new] = entries.try_emplace(text);
      if (!is_new && entry->second.key_kind != name.kind) {
        throw InputError(place, "names that differ",
                         fmt::format("both {} and '{}'", printable(text, 40), printable(text, 40)));
      }
      entry->second = {dict.items[i + 1], name.kind};
    } else if (holds(object, dict.items[i + 1])) {
      throw InputError(place, "tensors named by texts or whole numbers",
                       fmt::format("a tensor under {}", to_string(name.kind)));
    }
  }
  std::vector<NamedValue> tensors;
  for (const auto& [name, entry] : entries) {
    if (holds(object, entry.id)) tensors.push_back({name, entry.id});
  }
  return tensors;
}

class Search {
 public:
  Search(const PickledObject& object, const std::string& place) : object_(object), place_(place) {}

  // In order of depth. Objects may hold themselves and each other, and stand under several keys: each is
  // looked into once.
  std::vector<Holder> run() {
    std::vector<Holder> queue = {{{}, &object_[object_.root], {}, false, false, {}}};
    std::vector<Holder> found;
    std::map<const Value*, bool> has_weights;
    for (std::size_t next = 0; next < queue.size() && found.size() < kMostHolders; ++next) {
      Holder holder = queue[next];
      const auto [known, is_new] = has_weights.try_emplace(holder.value, false);
      if (is_new) {
        const bool is_whole = is_network(object_, *holder.value);
        known->second = is_whole || holds_tensors(object_, *holder.value);
        if (!is_whole && holder.path.size() < kDeepestKey) add_inner(holder, queue);
      }
      if (known->second) found.push_back(std::move(holder));
    }
    return found;
  }

  // Reads the tensors' names of a holder, and what ranks it.
  void describe(Holder& holder) {
    if (is_network(object_, *holder.value)) {
      holder.weights = read_whole_network(object_, *holder.value, place_, budget_);
    } else {
      holder.weights.tensors = tensors_of(object_, *holder.value, place_);
    }
    std::vector<std::string> names;
    for (const NamedValue& tensor : holder.weights.tensors) {
      names.push_back(tensor.name);
    }
    holder.is_known = are_of_a_known_network(names);
    for (const std::string& key : holder.path) holder.ranks.push_back(rank_of(key));
    holder.ranks.resize(kDeepestKey, kOrdinaryRank);
  }

 private:
  // The dicts and objects under the keys of `holder`.
  void add_inner(const Holder& holder, std::vector<Holder>& queue) const {
    const std::vector<ValueId>& items = holder.value->items;
    for (std::size_t i = 0; i + 1 < items.size() && queue.size() < kMostVisited; i += 2) {
      const Value& key = object_[items[i]];
      const Value& value = object_[items[i + 1]];
      if (key.kind != ValueKind::text || key.text.size() > kLongestTensorName) continue;
      if (value.kind != ValueKind::dict && value.kind != ValueKind::object) continue;
      Holder inner{holder.path, &value, {}, false, false, {}};
      inner.path.emplace_back(key.text);
      inner.is_other = holder.is_other || is_of_something_else(key.text);
      queue.push_back(std::move(inner));
    }
  }

  const PickledObject& object_;
  const std::string& place_;
  WalkBudget budget_;
};

std::string list_keys(const PickledObject& object, const Value& dict) {
  std::string list;
  for (std::size_t i = 0; i < std::min<std::size_t>(dict.items.size(), 16); i += 2) {
    const Value& key = object[dict.items[i]];
    if (!list.empty()) list += ", ";
    list +=
        key.kind == ValueKind::text ? fmt::format("\"{}\"", printable(key.text, 40)) : to_string(key.kind);
  }
  if (dict.items.size() > 16) list += ", ...";
  if (list.empty()) return "an empty dict";
  const bool has_arrays = std::any_of(dict.items.begin(), dict.items.end(), [&](ValueId id) {
    return object[id].kind == ValueKind::object && object[id].text == "_reconstruct";  // numpy's
  });
  return fmt::format("{} with {}{}", to_string(dict.kind), list,
                     has_arrays ? " (numpy arrays are not taken for weights: save torch tensors)" : "");
}

std::string list_holders(const std::vector<Holder>& holders) {
  std::string list;
  for (std::size_t i = 0; i < std::min<std::size_t>(holders.size(), 8); ++i) {
    if (!list.empty()) list += ", ";
    list +=
        holders[i].path.empty() ? "the outermost dict" : fmt::format("'{}'", printable(holders[i].key(), 80));
  }
  return list + (holders.size() > 8 ? ", ..." : "");
}

// Averaged weights that lack some of the network's tensors (often the batch norms') rank behind the others.
void rank_incomplete_averages(std::vector<Holder>& holders) {
  std::size_t most = 0;
  for (const Holder& holder : holders) {
    if (!is_averaged(holder) && holder.ranks.front() < kOrdinaryRank) {
      most = std::max(most, holder.weights.tensors.size());
    }
  }
  for (Holder& holder : holders) {
    if (is_averaged(holder) && holder.weights.tensors.size() < most) holder.ranks.front() = kOrdinaryRank + 1;
  }
}

// Lower is better.
bool precedes(const Holder& a, const Holder& b) {
  if (a.is_known != b.is_known) return a.is_known;
  if (a.is_other != b.is_other) return b.is_other;
  if (a.ranks != b.ranks) return a.ranks < b.ranks;
  return a.weights.tensors.size() > b.weights.tensors.size();
}

// Two keys that nothing tells apart: whoever takes the larger one would take the wrong one half of the time.
bool are_equal(const Holder& best, const Holder& other) {
  const bool is_inside = other.path.size() > best.path.size() &&
                         std::equal(best.path.begin(), best.path.end(), other.path.begin());
  return best.is_known == other.is_known && best.is_other == other.is_other && best.ranks == other.ranks &&
         !best.path.empty() && !other.path.empty() && !is_inside && best.value != other.value;
}

}  // namespace

FoundWeights find_weights(const PickledObject& object, const std::string& place, std::string_view key) {
  const std::string_view wanted =
      "a dict of tensors or a network, alone or under a key such as \"state_dict\"";
  const Value& root = object[object.root];
  if (root.kind != ValueKind::dict && root.kind != ValueKind::object) {
    throw InputError(place, wanted, to_string(root.kind));
  }
  Search search(object, place);
  std::vector<Holder> holders = search.run();
  if (holders.empty()) throw InputError(place, wanted, list_keys(object, root));
  std::stable_partition(holders.begin(), holders.end(),
                        [](const Holder& holder) { return !holder.is_other; });
  const bool has_plain_keys = !holders.front().is_other;
  std::vector<Holder> candidates;
  for (Holder holder : holders) {
    const std::string path = holder.key();
    if (!key.empty() && path != key && !path.starts_with(std::string(key) + ".")) continue;
    // What is not a network by its key may be one, but then by what it holds; if not, it may hold anything.
    const bool may_be_dropped = key.empty() && holder.is_other && has_plain_keys;
    try {
      search.describe(holder);
    } catch (const InputError&) {
      if (!may_be_dropped) throw;
      continue;
    }
    if (may_be_dropped && !holder.is_known) continue;
    candidates.push_back(std::move(holder));
  }
  if (candidates.empty()) {
    throw InputError(place, fmt::format("weights under the key '{}'", printable(key)),
                     "them under " + list_holders(holders));
  }
  rank_incomplete_averages(candidates);
  std::stable_sort(candidates.begin(), candidates.end(), precedes);
  if (key.empty() && candidates.size() > 1 && are_equal(candidates[0], candidates[1])) {
    throw InputError(place, "one network, or --key with the one that is wanted",
                     "several: " + list_holders(candidates));
  }
  Holder& best = candidates.front();
  if (!best.path.empty()) {
    std::string note = fmt::format("weights under '{}' taken", printable(best.key()));
    std::erase_if(holders, [&](const Holder& holder) { return holder.path == best.path; });
    if (!holders.empty()) note += fmt::format(" (others: {}; --key chooses)", list_holders(holders));
    best.weights.notes.push_back(std::move(note));
  }
  // What training scripts keep beside the network.
  for (const std::string_view list : {"names", "class_names", "classes", "CLASSES"}) {
    const Value* names = object.find(root, list);
    if (names == nullptr || best.weights.metadata.contains("classes")) continue;
    if (const auto classes = read_class_list(object, *names)) best.weights.metadata["classes"] = *classes;
  }
  return std::move(best.weights);
}

}  // namespace penumbra::weights_tools
