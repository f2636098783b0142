// Every command that README, docs and `--help` show is run, in a folder that has what they speak of
// (tests/documents/sandbox.sh), shortened by shorter.sed; left_out.txt names those that are not, and why.
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "nn/io/safetensors.h"
#include "tests/support/bag_files.h"
#include "tests/support/random_models.h"
#include "tests/support/test_data.h"

namespace penumbra::test {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

struct Example {
  std::string document;   // "docs/evaluation.md", "slam --help"
  std::string place;      // the same with the line
  std::string variables;  // lines NAME="..." that stand before it in the document
  std::string command;    // "penumbra ..."
};

// Indented lines that begin with penumbra, with the lines that a backslash joins to them.
std::vector<Example> examples_in(const fs::path& document, const std::string& name) {
  const std::regex call("^    (build/)?(penumbra .*)$"), variable("^    [A-Za-z]+=\".*$");
  std::vector<Example> examples;
  std::string variables;
  const std::vector<std::string> lines = lines_of(text_of(document));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t first = i;
    std::string line = lines[i];
    const auto goes_on = [&] {
      const std::size_t last = line.find_last_not_of(' ');
      return last != line.npos && line[last] == '\\' && i + 1 < lines.size();
    };
    if (!std::regex_match(line, call) && !std::regex_match(line, variable)) continue;
    while (goes_on()) line = line.substr(0, line.rfind('\\')) + lines[++i];
    std::smatch match;
    if (std::regex_match(line, match, call)) {
      examples.push_back({name, fmt::format("{}:{}", name, first + 1), variables, match[2]});
    } else {
      variables += line + "\n";
    }
  }
  return examples;
}

// Lines of a command's help that begin with penumbra; what stands behind three blanks explains them.
std::vector<Example> examples_of_help(const std::string& command) {
  const ProgramResult help = run_penumbra(command + " --help");
  EXPECT_EQ(help.exit_code, 0) << command;
  std::vector<Example> examples;
  for (const std::string& line : lines_of(help.out)) {
    if (line.rfind("  penumbra ", 0) != 0) continue;
    const std::string call = line.substr(2, line.find("   ", 2) - 2);
    examples.push_back({command + " --help", command + " --help", "", call});
  }
  return examples;
}

std::vector<Example> all_examples() {
  std::vector<fs::path> documents = {source_path("README.md")};
  for (const auto& entry : fs::recursive_directory_iterator(source_path("docs"))) {
    if (entry.path().extension() == ".md") documents.push_back(entry.path());
  }
  std::sort(documents.begin() + 1, documents.end());
  std::vector<Example> all;
  const auto add = [&](const std::vector<Example>& more) { all.insert(all.end(), more.begin(), more.end()); };
  for (const fs::path& document : documents)
    add(examples_in(document, fs::relative(document, source_path("")).string()));
  for (const char* command : {"slam",        "segment",    "classify",        "synth",
                              "report",      "export",     "ablate",          "eval",
                              "match-eval",  "eval-loops", "eval-coco",       "convert",
                              "info",        "calibrate",  "bench slam",      "bench network",
                              "bench conv",  "brain",      "brain landmarks", "brain train-grid",
                              "bench brain", "fleet plan", "fleet report",    "merge"}) {
    add(examples_of_help(command));
  }
  return all;
}

// The reason why an example is left out; empty where it is run.
std::string reason_to_leave_out(const std::string& command) {
  for (const std::string& line : lines_of(text_of(source_path("tests/documents/left_out.txt")))) {
    const std::size_t tab = line.find('\t');
    if (line.empty() || line[0] == '#' || tab == line.npos) continue;
    if (std::regex_search(command, std::regex(line.substr(0, tab)))) return line.substr(tab + 1);
  }
  return {};
}

int run_shell(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// Recordings of robots with the frames of the folder monday: run.bag, run.mcap, whose cameras stand on
// base_link, and rig.yaml.
void write_recordings(const fs::path& sandbox) {
  constexpr std::int64_t kStep = 100'000'000;  // nanoseconds
  constexpr double kFocal = 179.8, kBaseline = 0.537;
  std::vector<BagMessage> bag, mcap;
  for (int i = 0; i < 8; ++i) {
    const std::int64_t time = 1'000'000'000 + i * kStep;
    for (const bool is_right : {false, true}) {
      const std::string side = is_right ? "right" : "left";
      const std::string png = text_of(sandbox / "monday" / side / fmt::format("{:06}.png", i));
      CameraParts camera = pinhole(310, 94, kFocal, is_right ? -kFocal * kBaseline : 0.0);
      camera.P[2] = camera.K[2] = 151.34;
      camera.P[6] = camera.K[5] = 46.28;
      bag.push_back({"/" + side + "/image_raw/compressed", "sensor_msgs/CompressedImage", time,
                     compressed_message(Wire::ros1, time, "mono8; png compressed", png)});
      bag.push_back(
          {"/" + side + "/camera_info", "sensor_msgs/CameraInfo", time, camera_message(Wire::ros1, camera)});
      const std::string name = is_right ? "/cam1" : "/cam0";
      mcap.push_back({name + "/image_raw", "sensor_msgs/CompressedImage", time,
                      compressed_message(Wire::cdr, time, "mono8; png compressed", png)});
      mcap.push_back(
          {name + "/camera_info", "sensor_msgs/CameraInfo", time, camera_message(Wire::cdr, camera)});
    }
  }
  mcap.push_back({"/tf_static", "tf2_msgs/TFMessage", 1'000'000'000,
                  transforms_message(Wire::cdr, {{"base_link", "camera", {0.3, 0.0, 1.0}}})});
  write_file(sandbox / "run.bag", ros1_bag(bag));
  write_file(sandbox / "run.mcap", mcap_file(mcap, "cdr"));
  fs::copy(sandbox / "monday" / "calibration.yaml", sandbox / "rig.yaml");
}

TEST(Documents, EveryCommandThatTheyShowRuns) {
  const std::vector<Example> examples = all_examples();
  ASSERT_GT(examples.size(), 80U);
  const TemporaryDirectory folder;
  const fs::path sandbox = folder / "sandbox", script = folder / "script", output = folder / "output";
  fs::create_directories(sandbox);
  nn::write_safetensors(sandbox / "resnet18.safetensors", random_resnet(18, 8));
  std::ofstream classes(sandbox / "imagenet_classes.txt");
  for (int i = 0; i < 10; ++i) classes << "bird " << i << '\n';
  classes.close();
  ASSERT_EQ(run_shell(fmt::format("cd '{}' && bash '{}' '{}' '{}' >'{}' 2>&1", sandbox.string(),
                                  source_path("tests/documents/sandbox.sh").string(), PENUMBRA_BINARY,
                                  source_path("").string(), output.string())),
            0)
      << text_of(output);
  write_recordings(sandbox);
  int run = 0;
  std::string document;
  for (const Example& example : examples) {
    if (example.document != document) {
      document = example.document;
      ASSERT_EQ(run_shell(fmt::format("cd '{}' && rm -rf out && cp -r out.fresh out", sandbox.string())), 0);
    }
    if (!reason_to_leave_out(example.command).empty()) continue;
    ++run;
    std::ofstream(script) << example.variables << example.command << '\n';
    const int code =
        run_shell(fmt::format("cd '{}' && sed -E -i -f '{}' '{}' && {{ echo 'penumbra() {{ build/penumbra "
                              "\"$@\"; }}'; cat '{}'; }} | "
                              "timeout 100 bash -eu >'{}' 2>&1",
                              sandbox.string(), source_path("tests/documents/shorter.sed").string(),
                              script.string(), script.string(), output.string()));
    EXPECT_EQ(code, 0) << example.place << ": " << text_of(script) << text_of(output);
  }
  EXPECT_GT(run, 70);
}

// A pattern that no example needs is a leftover.
TEST(Documents, LeaveNothingOutWithoutNeed) {
  const std::vector<Example> examples = all_examples();
  for (const std::string& line : lines_of(text_of(source_path("tests/documents/left_out.txt")))) {
    const std::size_t tab = line.find('\t');
    if (line.empty() || line[0] == '#') continue;
    ASSERT_NE(tab, line.npos) << line;
    const std::regex pattern(line.substr(0, tab));
    EXPECT_TRUE(std::any_of(examples.begin(), examples.end(), [&](const Example& e) {
      return std::regex_search(e.command, pattern);
    })) << line;
  }
}

}  // namespace
}  // namespace penumbra::test
