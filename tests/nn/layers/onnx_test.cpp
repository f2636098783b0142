// ONNX's own tests of its operators, from Debian's package libonnx-testdata: data that nobody here has
// written.
#include "tests/support/onnx.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>

#include "nn/base/error.h"
#include "tests/support/bytes.h"
#include "tests/support/onnx_layers.h"
#include "tests/support/tensors.h"

namespace penumbra::test {
namespace {

namespace fs = std::filesystem;

const fs::path kOnnxData = "/usr/share/libonnx-testdata/data";

std::vector<fs::path> case_folders() {
  std::vector<fs::path> folders;
  for (const char* part : {"node", "pytorch-converted", "pytorch-operator"}) {
    if (!fs::is_directory(kOnnxData / part)) continue;
    for (const auto& entry : fs::directory_iterator(kOnnxData / part)) {
      if (fs::exists(entry.path() / "model.onnx")) folders.push_back(entry.path());
    }
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

// Relative to the largest expected value. RoiAlign's inputs and outputs are written with four decimals, each
// rounded by itself: half a unit of the input and half a unit of the output.
float tolerance(const std::string& operation) { return operation == "RoiAlign" ? 1.1e-4F : 1e-5F; }

OnnxTensor read_tensor(const fs::path& path) { return parse_onnx_tensor(read_file(path), path.string()); }

// Runs the data sets of a case and compares; throws NotCovered.
void run_case(const fs::path& folder, const OnnxModel& model) {
  const OnnxNode& node = model.nodes.front();
  int sets = 0;
  for (fs::path set; fs::exists(set = folder / ("test_data_set_" + std::to_string(sets))); ++sets) {
    std::map<std::string, nn::Tensor> known;
    for (const OnnxTensor& tensor : model.initializers) known[tensor.name] = tensor.tensor;
    int file = 0;
    for (const std::string& name : model.inputs) {
      if (known.count(name) == 1) continue;
      const OnnxTensor tensor = read_tensor(set / ("input_" + std::to_string(file++) + ".pb"));
      if (tensor.type == OnnxTensor::u8) throw NotCovered("8-bit values");
      if (tensor.type == OnnxTensor::f64) throw NotCovered("64-bit values");
      known[name] = tensor.tensor;
    }
    std::vector<nn::Tensor> inputs;
    for (const std::string& name : node.inputs) inputs.push_back(known[name]);
    const std::vector<nn::Tensor> outputs = run_onnx_node(node, model.opset, inputs);
    ASSERT_EQ(outputs.size(), node.outputs.size());
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      expect_close(outputs[i], read_tensor(set / ("output_" + std::to_string(i) + ".pb")).tensor,
                   tolerance(node.operation));
    }
  }
  EXPECT_GT(sets, 0);
}

TEST(Onnx, TheLayersPassTheTestsOfTheOperatorsThatTheyCover) {
  if (!fs::is_directory(kOnnxData)) {
    GTEST_SKIP() << "no " << kOnnxData << ": install Debian's package libonnx-testdata";
  }
  std::map<std::string, int> run;
  std::map<std::string, std::string> skipped;
  for (const fs::path& folder : case_folders()) {
    const std::string name = folder.parent_path().filename() / folder.filename();
    OnnxModel model;
    try {
      model = parse_onnx_model(read_file(folder / "model.onnx"), name);
    } catch (const InputError&) {
      continue;  // tensors of a type that the reader does not have, in models of operators that are not ours
    }
    if (model.nodes.size() != 1 || !is_covered(model.nodes.front().operation)) continue;
    SCOPED_TRACE(name);
    try {
      run_case(folder, model);
      ++run[model.nodes.front().operation];
      std::cout << "run     " << name << '\n';
    } catch (const NotCovered& reason) {
      skipped[name] = reason.what();
    }
  }
  int total = 0;
  for (const auto& [operation, count] : run) total += count;
  for (const auto& [name, reason] : skipped) std::cout << "skipped " << name << ": " << reason << '\n';
  std::cout << total << " cases of " << run.size() << " operators run, " << skipped.size() << " skipped\n";
  EXPECT_GT(total, 60);
  for (const char* operation : {"Conv", "ConvTranspose", "MaxPool", "AveragePool", "Resize", "RoiAlign",
                                "NonMaxSuppression", "Softmax", "Concat", "Split", "BatchNormalization"}) {
    EXPECT_GT(run[operation], 0) << operation;
  }
}

TEST(Onnx, TruncatedFilesAreInputErrorsOrShorterMessages) {
  const fs::path folder = kOnnxData / "node/test_roialign_aligned_true";
  if (!fs::is_directory(folder))
    GTEST_SKIP() << "no " << folder << ": install Debian's package libonnx-testdata";
  const std::string model = read_file(folder / "model.onnx");
  const std::string tensor = read_file(folder / "test_data_set_0/input_0.pb");
  for (std::size_t length = 0; length < tensor.size(); ++length) {
    EXPECT_THROW(parse_onnx_tensor(std::string_view(tensor).substr(0, length), "tensor"), InputError)
        << length;
  }
  for (std::size_t length = 0; length < model.size(); ++length) {
    try {
      parse_onnx_model(std::string_view(model).substr(0, length), "model");
    } catch (const InputError&) {
    }
  }
}

}  // namespace
}  // namespace penumbra::test
