// Checkpoints as training scripts leave them (weights_tools/reference/make_wild_checkpoint_fixtures.py): the
// same small network in many wrappings, beside all kinds of values.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/io/safetensors.h"
#include "tests/support/bytes.h"
#include "tests/support/test_data.h"
#include "weights_tools/load_weights.h"
#include "weights_tools/pickle_machine.h"
#include "weights_tools/torch_state_dict.h"
#include "weights_tools/weight_names.h"

namespace penumbra::weights_tools {
namespace {

std::filesystem::path wild(const std::string& name) {
  return test::fixture("checkpoints/wild_" + name + ".pth");
}

std::string refusal_of(const std::string& name, const std::string& key = {}) {
  return test::message_of<InputError>([&] { load_weights(wild(name), key); });
}

std::string notes_of(const nn::StateDict& state) {
  std::string all;
  for (const std::string& note : state.notes) all += note + "\n";
  return all;
}

void expect_the_network(const nn::StateDict& state) {
  EXPECT_EQ(state.tensors.size(), 7U);
  ASSERT_TRUE(state.tensors.contains("0.weight"));
  EXPECT_EQ(state.tensors.at("0.weight").to_f32(), (std::vector<float>{0, 1}));
  EXPECT_EQ(state.tensors.at("1.running_var").to_f32(), (std::vector<float>{5, 6}));
  EXPECT_EQ(state.tensors.at("1.num_batches_tracked").to_f32(), std::vector<float>{6});
}

TEST(WildCheckpoint, ValuesBesideTheWeightsAreReadAsDataAndLeftOut) {
  for (const char* name : {"inert_2", "inert_4", "inert_5", "inert_legacy", "sparse_beside"}) {
    SCOPED_TRACE(name);
    const nn::StateDict state = load_weights(wild(name));
    expect_the_network(state);
    EXPECT_CONTAINS(notes_of(state), "weights under 'model' taken");
  }
}

TEST(WildCheckpoint, WholeNetworksGiveTheirStateDict) {
  for (const char* name :
       {"whole_2", "whole_4", "whole_5", "whole_legacy", "whole_parallel", "whole_compiled"}) {
    SCOPED_TRACE(name);
    const nn::StateDict state = load_weights(wild(name));
    expect_the_network(state);
    EXPECT_EQ(state.metadata.at("batch_norm_eps"), "1e-05");
    EXPECT_EQ(state.metadata.at("activations"), "SiLU");
  }
  const nn::StateDict named = load_weights(wild("whole_named"));
  expect_the_network(named);
  EXPECT_EQ(named.metadata.at("classes"), "cat\ndog, small");
  EXPECT_EQ(named.metadata.at("stride"), "8,16,32");
  // What PyTorch 1.13 wrote.
  for (const char* name : {"module.pth", "module_legacy.pth"}) {
    const nn::StateDict state = load_weights(test::fixture(std::string("checkpoints/") + name));
    EXPECT_EQ(state.tensors.size(), 2U);
    EXPECT_EQ(state.tensors.at("weight").shape, (std::vector<std::int64_t>{2, 2}));
  }
}

TEST(WildCheckpoint, PrefixesOfWrappersAreTakenOffInBothFormats) {
  const test::TemporaryDirectory folder;
  for (const char* name :
       {"prefix_lightning", "prefix_twice", "prefix_compiled", "prefix_mixed", "averaged"}) {
    SCOPED_TRACE(name);
    const nn::StateDict state = load_weights(wild(name));
    expect_the_network(state);
    EXPECT_CONTAINS(notes_of(state), "without their wrappers' prefixes");
  }
  nn::StateDict wrapped = load_weights(wild("prefix_twice")), other;
  for (auto& [name, tensor] : wrapped.tensors) other.tensors["model._orig_mod." + name] = tensor;
  other.owners = wrapped.owners;
  other.file = wrapped.file;
  nn::write_safetensors(folder / "wrapped.safetensors", other);
  expect_the_network(load_weights(folder / "wrapped.safetensors"));
  // Not of all names, and not YOLOv5's own.
  nn::StateDict own;
  const std::vector<float> one = {1.0F};
  const nn::StoredTensor tensor{nn::DataType::f32, {1}, std::as_bytes(std::span(one))};
  own.tensors = {{"module.a", tensor}, {"b", tensor}};
  nn::write_safetensors(folder / "some.safetensors", own);
  EXPECT_TRUE(load_weights(folder / "some.safetensors").tensors.contains("module.a"));
  own.tensors = {{"model.0.conv.weight", tensor}, {"model.24.m.0.bias", tensor}};
  nn::write_safetensors(folder / "yolov5.safetensors", own);
  EXPECT_TRUE(load_weights(folder / "yolov5.safetensors").tensors.contains("model.24.m.0.bias"));
  own.tensors = {{"module.model.0.conv.weight", tensor}, {"module.model.24.m.0.bias", tensor}};
  nn::write_safetensors(folder / "parallel.safetensors", own);
  EXPECT_TRUE(load_weights(folder / "parallel.safetensors").tensors.contains("model.24.m.0.bias"));
}

TEST(WildCheckpoint, TheKeyThatFitsIsTakenAndSaid) {
  for (const char* key : {"net", "model_ema", "params", "generator", "my_network"}) {
    SCOPED_TRACE(key);
    const nn::StateDict state = load_weights(wild(std::string("key_") + key));
    expect_the_network(state);
    EXPECT_CONTAINS(notes_of(state), fmt::format("weights under '{}' taken", key));
  }
  const nn::StateDict averaged = load_weights(wild("two"));
  EXPECT_EQ(averaged.tensors.at("0.weight").to_f32(), (std::vector<float>{0, 0}));
  EXPECT_CONTAINS(notes_of(averaged), "weights under 'ema' taken (others: 'model'; --key chooses)");
  expect_the_network(load_weights(wild("two"), "model"));
  // Averages of a part of the tensors are no network.
  expect_the_network(load_weights(wild("two_partial")));
  EXPECT_EQ(load_weights(wild("two_partial"), "ema").tensors.size(), 1U);
  EXPECT_CONTAINS(refusal_of("two_equal"), "several: 'netA', 'netB'");
  expect_the_network(load_weights(wild("two_equal"), "netB"));
  EXPECT_CONTAINS(refusal_of("two", "generator"), "weights under the key 'generator'");
}

TEST(WildCheckpoint, ForeignEntriesBesideAKnownNetworkAreLeftOut) {
  const std::vector<float> one = {1.0F};
  const nn::StoredTensor tensor{nn::DataType::f32, {1}, std::as_bytes(std::span(one))};
  const auto unwrapped = [&](const std::string& prefix, const std::vector<std::string>& own,
                             const std::vector<std::string>& foreign) {
    nn::StateDict state;
    for (const std::string& name : own) state.tensors.emplace(prefix + name, tensor);
    for (const std::string& name : foreign) state.tensors.emplace(name, tensor);
    unwrap_names(state);
    return state;
  };
  const std::vector<std::string> resnet = {"conv1.weight", "layer1.0.conv1.weight", "layer1.0.bn1.weight",
                                           "fc.weight", "fc.bias"};
  const std::vector<std::string> yolov5 = {"model.0.conv.weight", "model.1.conv.weight",
                                           "model.2.conv.weight", "model.24.m.0.weight"};
  const std::vector<std::string> mask_rcnn = {"backbone.body.layer1.0.conv1.weight",
                                              "backbone.body.conv1.weight", "rpn.head.weight",
                                              "roi_heads.box_predictor.cls_score.weight"};
  for (const auto& own : {resnet, yolov5, mask_rcnn}) {
    for (const std::string prefix : {"model.", "net.", "detector.", "module.model.", "model.module."}) {
      for (const std::string foreign : {"criterion.weight", "val_map.x"}) {
        SCOPED_TRACE(prefix + own.front());
        const nn::StateDict state = unwrapped(prefix, own, {foreign});
        EXPECT_EQ(state.tensors.size(), own.size());
        EXPECT_TRUE(state.tensors.contains(own.front()));
        EXPECT_CONTAINS(notes_of(state), "left out: " + foreign);
      }
    }
  }
  EXPECT_EQ(unwrapped("module.", resnet, {"steps"}).tensors.size(), 5U);
  EXPECT_EQ(unwrapped("module.", {"a", "b"}, {"steps"}).tensors.count("a"), 1U);
  // A network that only holds one of ours, and two of ours, stay as they are.
  EXPECT_EQ(unwrapped("encoder.", resnet, {"decoder.a", "decoder.b"}).tensors.size(), 7U);
  EXPECT_EQ(unwrapped("backbone.", {"layer1.0.conv1.weight", "conv1.weight", "x", "y"}, {"neck.a"})
                .tensors.count("neck.a"),
            1U);
}

TEST(WildCheckpoint, KeysAreReadInWordsAndWhatFitsGoesFirst) {
  const auto pickled = [](const std::string& key, const std::string& name) {
    const auto text = [](const std::string& value) {
      return "X" + test::little_endian(static_cast<std::uint32_t>(value.size())) + value;
    };
    std::string tensor = "ctorch._utils\n_rebuild_tensor\n((" + text("storage") + "ctorch\nFloatStorage\n" +
                         text("0") + text("cpu") + "K\x01tQK";
    tensor += std::string(1, '\0') + "K\x01\x85K\x01\x85tR";
    return text(key) + "}" + text(name) + tensor + "s";
  };
  const auto taken = [&](const std::string& entries) {
    const std::string pickle = "}(" + entries + "u.";
    const PickledObject object = run_pickle(test::as_bytes(pickle), 0, "pickle");
    return fmt::format("{}", fmt::join(find_state_dict(object, "pickle").notes, "; "));
  };
  for (const std::string key : {"metric_net", "hyperspectral_model", "lossless_net", "targs_model", "loss"}) {
    EXPECT_CONTAINS(taken(pickled("other", "w") + pickled(key, "model.0.conv.weight")),
                    fmt::format("'{}' taken (others: 'other'", key));
  }
  EXPECT_CONTAINS(taken(pickled("lossless_net", "w") + pickled("lr_scheduler", "w")),
                  "'lossless_net' taken (others: 'lr_scheduler'");
  EXPECT_CONTAINS(taken(pickled("optimizerG", "w") + pickled("anything", "w")), "'anything' taken");
  EXPECT_CONTAINS(taken(pickled("model", "model.0.conv.weight") + pickled("loss", "model.0.conv.weight")),
                  "'model' taken");
}

TEST(WildCheckpoint, NamesMayBeWholeNumbersAndTypesOthers) {
  const nn::StateDict numbers = load_weights(wild("whole_numbers"));
  EXPECT_EQ(numbers.tensors.size(), 2U);
  EXPECT_EQ(numbers.tensors.at("1").shape, std::vector<std::int64_t>{3});
  const nn::StateDict complex = load_weights(wild("complex"));
  EXPECT_EQ(complex.tensors.at("freqs").type, nn::DataType::c64);
  EXPECT_EQ(complex.tensors.at("freqs").bytes.size(), 24U);
  EXPECT_THROW(complex.tensors.at("freqs").to_f32(), InputError);
}

TEST(WildCheckpoint, WhatWouldBeReadWronglyOrIsNothingIsRefused) {
  EXPECT_CONTAINS(refusal_of("neg"), "\"weight\": expected elements as they are stored");
  EXPECT_CONTAINS(refusal_of("conj"), "conjugated");
  EXPECT_CONTAINS(refusal_of("none"), "\"state_dict\", \"epoch\"");
}

TEST(WildCheckpoint, AttacksAreNamedAndNothingIsExecuted) {
  EXPECT_CONTAINS(refusal_of("attack_system"), "posix.system (nothing was executed");
  EXPECT_CONTAINS(refusal_of("attack_eval"), "__builtin__.eval (nothing was executed");
  EXPECT_CONTAINS(refusal_of("attack_getattr"), "getattr of '__init__' (nothing was executed");
  EXPECT_FALSE(std::filesystem::exists("penumbra_was_here"));
}

}  // namespace
}  // namespace penumbra::weights_tools
