// penumbra bench slam: every recording of a folder, and synthetic drives, as one table.
#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "apps/bench/benchmark.h"
#include "apps/bench/child_process.h"
#include "apps/common/log.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "slam/sources/euroc.h"
#include "slam/sources/folder_listing.h"
#include "slam/sources/image_folder.h"
#include "slam/sources/kitti.h"

namespace penumbra::apps {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kBenchSlamExamples = R"(Examples:
  penumbra bench slam DATA --out out/bench                              all recordings in DATA, twice below it at most
  penumbra bench slam DATA --out out/bench --streets out/streets        and a block and an eight, made there
  penumbra bench slam --streets out/streets --street-frames 60 --out out/bench --repeats 3 --json

Every run is a process of its own, with a folder of results and a log in --out, at the recording's path below DATA. The
table grows row by row, here and in table.txt and table.json. Times are in milliseconds a frame:
median, 95th percentile, and processor time of all threads from the first frame to the finished map; memory is the largest
that the process held. ATE is over the located frames, after a rigid alignment; drift is KITTI's t_rel, on paths below
200 m over segments of 10 to 50 m. With --repeats every figure is the median of the runs. Leave the machine alone meanwhile.)";

constexpr int kBlockFrames = 470, kEightFrames = 1150;  // once round, and a little more

struct SlamBenchmarkOptions {
  std::string data, out, streets;
  std::optional<int> street_frames;
  int repeats = 1;
  bool deterministic = false, json = false;
};

struct Job {
  std::string name;  // also of its folder in --out: the recording's path below the folder of recordings
  std::vector<std::string> arguments;
};

// A figure of run.json; most are shown in the table, all of them as JSON.
struct Column {
  const char* key;
  const char* title;
  int decimals;
};
constexpr Column kColumns[] = {
    {"frames", "frames", 0},         {"tracked", "located", 0},  {"lost", "lost", 0},
    {"keyframes", "keyframes", 0},   {"loops", "loops", 0},      {"ate_m", "ATE m", 3},
    {"t_rel_percent", "t_rel %", 2}, {"median_ms", "median", 1}, {"p95_ms", "95 %", 1},
    {"cpu_ms_per_frame", "CPU", 1},  {"peak_rss_mb", "MB", 0}};

// Recordings in `folder` or up to `depth` levels below it, in the order of their names. `path` is the
// folder's, as seen from where the search began; empty there, where the folder's own name stands for it.
void find_recordings(const fs::path& folder, const std::string& path, int depth, std::vector<Job>& jobs) {
  const std::string name = path.empty() ? fs::canonical(folder).filename().string() : path;
  const std::vector<std::string> sequences = slam::kitti_sequences(folder);
  for (const std::string& sequence : sequences)
    jobs.push_back({name + "/" + sequence, {folder.string(), "--sequence", sequence}});
  if (!sequences.empty()) return;
  const bool is_tum = slam::is_present(folder / "rgb.txt") && slam::is_present(folder / "depth.txt");
  const bool is_recording = slam::looks_like_kitti(folder) || slam::looks_like_euroc(folder) || is_tum ||
                            slam::looks_like_image_folder(folder);
  if (is_recording) {
    jobs.push_back({name, {folder.string()}});
  } else if (depth > 0) {
    for (const fs::path& entry : slam::list_folder(folder)) {
      const std::string below = (fs::path(path) / entry.filename()).string();
      if (slam::is_folder(entry)) find_recordings(entry, below, depth - 1, jobs);
    }
  }
}

// What a run said went wrong; its last line where it said nothing.
std::string complaint(const fs::path& log) {
  constexpr std::string_view kError = "error: ";
  std::istringstream lines(nn::read_file(log, "the log of a run"));
  std::string last = "no word";
  for (std::string line; std::getline(lines, line); last = line) {
    if (line.starts_with(kError)) return line.substr(kError.size());
  }
  return last;
}

void run_or_throw(const std::vector<std::string>& arguments, const fs::path& log) {
  const ChildResult result = run_penumbra(arguments, log);
  if (result.exit_code == 0) return;
  throw Error(fmt::format("{}: exit code {}: {}", log.string(), result.exit_code, complaint(log)));
}

// A synthetic drive, made where it is not there yet: a whole one, or none.
Job street(const fs::path& folder, const std::string& path, int frames) {
  const std::string name = fmt::format("{}-{}", path, frames);
  const fs::path made = folder / name, unfinished = folder / (name + ".unfinished");
  if (!slam::is_folder(made)) {
    fs::create_directories(folder);
    log_info("making {}", made.string());
    run_or_throw({"synth", "--path", path, "--frames", std::to_string(frames), "--out", unfinished.string(),
                  "--overwrite"},
                 folder / (name + ".log"));
    fs::rename(unfinished, made);
  }
  return {"street-" + name, {made.string()}};
}

// One run's figures, by the keys of kColumns; what it does not have is null.
ordered_json figures(const nlohmann::json& report) {
  const nlohmann::json truth = report.value("ground_truth", nlohmann::json::object());
  ordered_json row;
  for (const Column& column : kColumns) {
    const std::string key = column.key;
    if (key == "loops") {
      row[key] = report.at(key).size();
    } else if (key == "ate_m") {
      row[key] = truth.value("ape_rmse_m", nlohmann::json());
    } else if (key == "t_rel_percent") {
      row[key] = truth.value(key, nlohmann::json());
    } else {
      row[key] = report.value(key, nlohmann::json());
    }
  }
  return row;
}

// Figure by figure, over those runs that have it.
ordered_json median_of(const std::vector<ordered_json>& runs) {
  ordered_json median;
  for (const Column& column : kColumns) {
    std::vector<double> values;
    for (const ordered_json& run : runs) {
      if (run[column.key].is_number()) values.push_back(run[column.key].get<double>());
    }
    std::sort(values.begin(), values.end());
    median[column.key] = values.empty() ? ordered_json() : ordered_json(values[(values.size() - 1) / 2]);
  }
  return median;
}

ordered_json run_job(const Job& job, const SlamBenchmarkOptions& options) {
  ordered_json row = {{"name", job.name}};
  std::vector<ordered_json> runs;
  try {
    for (int i = 0; i < options.repeats; ++i) {
      const fs::path out = fs::path(options.out) / job.name;
      fs::create_directories(out);
      std::vector<std::string> arguments = {"slam"};
      arguments.insert(arguments.end(), job.arguments.begin(), job.arguments.end());
      arguments.insert(arguments.end(), {"--out", out.string()});
      if (options.deterministic) arguments.push_back("--deterministic");
      log_info("{}, run {} of {}", job.name, i + 1, options.repeats);
      run_or_throw(arguments, out / "log.txt");
      runs.push_back(figures(nlohmann::json::parse(nn::read_file(out / "run.json", "a run's report"))));
    }
    row.update(median_of(runs));
  } catch (const Error& error) {
    log_error("{}", error.what());
    row["error"] = error.what();
  }
  return row;
}

// The table grows row by row, on standard output and in table.txt, so that what has been measured is there
// whatever happens to the rest.
class Table {
 public:
  Table(const std::vector<Job>& jobs, const fs::path& folder, bool shown)
      : file_(folder / "table.txt"), shown_(shown) {
    if (!file_) throw Error(fmt::format("{}: cannot be written", (folder / "table.txt").string()));
    for (const Job& job : jobs) width_ = std::max(width_, job.name.size());
    std::string titles = fmt::format("{:<{}}", "data", width_);
    for (const Column& column : kColumns) titles += fmt::format(" {:>9}", column.title);
    add_line(titles);
  }
  void add(const ordered_json& row) {
    std::string line = fmt::format("{:<{}}", row["name"].get<std::string>(), width_);
    if (row.contains("error")) return add_line(line + " failed");
    for (const Column& column : kColumns) {
      const ordered_json& value = row[column.key];
      line += fmt::format(
          " {:>9}", value.is_number() ? fmt::format("{:.{}f}", value.get<double>(), column.decimals) : "-");
    }
    add_line(line);
  }

 private:
  void add_line(const std::string& line) {
    file_ << line << std::endl;
    if (!shown_) return;
    fmt::print("{}\n", line);
    std::fflush(stdout);
  }
  std::ofstream file_;
  bool shown_;
  std::size_t width_ = 4;
};

void run_benchmark(const SlamBenchmarkOptions& options) {
  if (options.data.empty() && options.streets.empty()) {
    throw UsageError("a folder of recordings, --streets, or both");
  }
  std::vector<Job> jobs;
  if (!options.data.empty()) {
    slam::require_dataset_folder(options.data);
    find_recordings(options.data, "", 2, jobs);
    if (jobs.empty()) throw InputError(options.data, "recordings, at most two folders down", "none");
  }
  if (!options.streets.empty()) {
    jobs.push_back(street(options.streets, "block", options.street_frames.value_or(kBlockFrames)));
    jobs.push_back(street(options.streets, "eight", options.street_frames.value_or(kEightFrames)));
  }
  nn::make_writable_folder(options.out);
  Table table(jobs, options.out, !options.json);
  ordered_json result = {{"deterministic", options.deterministic},
                         {"repeats", options.repeats},
                         {"runs", ordered_json::array()}};
  ordered_json& rows = result["runs"];
  for (const Job& job : jobs) {
    rows.push_back(run_job(job, options));
    table.add(rows.back());
    nn::write_file(fs::path(options.out) / "table.json", result.dump(2) + "\n");
  }
  if (options.json) fmt::print("{}\n", result.dump(2));
  const auto failed =
      std::count_if(rows.begin(), rows.end(), [](const auto& row) { return row.contains("error"); });
  if (failed > 0) throw Error(fmt::format("{} of {} failed", failed, counted(rows.size(), "run")));
}

}  // namespace

void add_slam_benchmark(CLI::App& bench) {
  const auto options = std::make_shared<SlamBenchmarkOptions>();
  CLI::App* command =
      bench.add_subcommand("slam", "Accuracy, time and memory of the SLAM, over many recordings");
  command->footer(kBenchSlamExamples);
  command->add_option("data", options->data, "folder with recordings, at most two folders down")
      ->type_name("DIR");
  command->add_option("--out", options->out, "folder for the runs' results")->required()->type_name("DIR");
  command->add_option("--streets", options->streets, "also two synthetic drives, made in this folder once")
      ->type_name("DIR");
  command
      ->add_option("--street-frames", options->street_frames,
                   fmt::format("their length (default: {} and {}, a loop each)", kBlockFrames, kEightFrames))
      ->check(CLI::Range(2, 20000))
      ->type_name("N");
  command->add_option("--repeats", options->repeats, "runs of each, of which the medians count")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_flag("--deterministic", options->deterministic, "mapping in line with tracking");
  command->add_flag("--json", options->json, "one JSON object on standard output");
  command->callback([options] { run_benchmark(*options); });
}

}  // namespace penumbra::apps
