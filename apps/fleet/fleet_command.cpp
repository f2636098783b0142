// penumbra fleet: many recordings to one map, on a cluster that has Slurm or on one machine.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "apps/common/commands.h"
#include "apps/fleet/fleet_report.h"
#include "apps/fleet/plan.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/text.h"

namespace penumbra::apps {

namespace {

struct PlanOptions {
  std::string manifest, out;
  FleetPlan plan;
};

void make_plan(PlanOptions& options) {
  FleetPlan& plan = options.plan;
  plan.recordings = read_fleet_manifest(options.manifest);
  plan.folder = std::filesystem::absolute(options.manifest).parent_path();
  if (plan.program.find('/') != plan.program.npos)
    plan.program = std::filesystem::absolute(plan.program).lexically_normal().string();
  const std::string folder = plan.folder.string();
  if (folder.find_first_of("\t\n") != folder.npos)  // would end a word of jobs.tsv
    throw InputError(printable(folder), "a path without tabs and line ends", "one with them");
  std::error_code none;
  for (const char* file : kFleetPlanFiles) {
    if (std::filesystem::equivalent(std::filesystem::path(options.out) / file, options.manifest, none))
      throw InputError(options.manifest, "a manifest that the plan does not overwrite",
                       fmt::format("{}/{}", options.out, file));
  }
  write_fleet_plan(options.out, plan);
  fmt::print("{0}: {1}. {0}/submit.sh for Slurm, {0}/here.sh for this machine.\n", options.out,
             counted(plan.recordings.size(), "recording"));
}

void make_report(const std::string& folder) {
  const std::vector<FleetRow> rows = read_fleet(folder);
  nn::write_file(std::filesystem::path(folder) / "table.tsv", fleet_table(rows));
  nn::write_file(std::filesystem::path(folder) / "index.html", fleet_page(folder, rows));
  for (const FleetRow& row : rows) {
    if (row.state == FleetState::done) continue;
    fmt::print("{}: {}{}{}\n", row.name, name_of(row.state), row.last_words.empty() ? "" : ": ",
               row.last_words);
  }
  const auto done = static_cast<std::size_t>(std::ranges::count(rows, FleetState::done, &FleetRow::state));
  fmt::print("done: {} of {}; see {}/index.html\n", done, counted(rows.size(), "recording"), folder);
  const std::string unmerged = why_not_merged(folder);
  if (!unmerged.empty()) fmt::print("no merged map: {}\n", unmerged);
  if (done < rows.size()) throw Error(fmt::format("not done: {}", counted(rows.size() - done, "recording")));
  if (!unmerged.empty()) throw Error("the maps are not merged");
}

void add_plan_command(CLI::App& fleet) {
  const auto options = std::make_shared<PlanOptions>();
  FleetPlan& plan = options->plan;
  std::error_code unknown;
  plan.program = std::filesystem::read_symlink("/proc/self/exe", unknown).string();
  if (unknown) plan.program = "penumbra";
  CLI::App* command = fleet.add_subcommand("plan", "Write what Slurm is to do for a manifest of recordings");
  command
      ->add_option("manifest", options->manifest,
                   "a line a recording: name, recording, calibration or -, options of `penumbra slam`")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("--out", options->out, "folder of the plan and of all results, seen by every node")
      ->required();
  command->add_option("--cpus", plan.processors, "processors of a job")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_option("--memory", plan.memory_mb, "of a recording's job, MB")
      ->check(CLI::Range(1, 10'000'000))
      ->capture_default_str();
  command->add_option("--merge-memory", plan.merge_memory_mb, "of the merge, MB")
      ->check(CLI::Range(1, 10'000'000))
      ->capture_default_str();
  command->add_option("--time", plan.time, "of each job at most, as Slurm writes it")->capture_default_str();
  command->add_option("--at-once", plan.at_once, "recordings at the same time at most (default: no bound)")
      ->check(CLI::Range(1, 1'000'000));
  command
      ->add_option(
          "--district", plan.district_size,
          "recordings that are merged first where there are more, 0: all at once (default: up to 40 at "
          "once, of more the square root)")
      ->check(CLI::Range(0, 1'000'000))
      ->type_name("N");
  command
      ->add_option("--sbatch", plan.sbatch, "one more option of sbatch for every job, such as --account=lab")
      ->type_name("OPTION")
      ->take_all();
  command->add_option("--program", plan.program, "penumbra as the nodes see it (default: this one)")
      ->type_name("PATH");
  command->footer(
      "Paths in the manifest are relative to its folder. What a signal, a time limit or a lost node ends is "
      "begun\nagain by submit.sh (a lost node's by Slurm itself); what is done is not done again. Examples:\n"
      "  penumbra fleet plan night/manifest.txt --out out/night --sbatch=--partition=robots\n"
      "  out/night/submit.sh\n"
      "  out/night/here.sh                       the same without Slurm, one after the other");
  command->callback([options] { make_plan(*options); });
}

}  // namespace

void add_fleet_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("fleet", "Make one map of many recordings, on a cluster that has Slurm");
  command->require_subcommand(1);
  add_plan_command(*command);
  const auto folder = std::make_shared<std::string>();
  CLI::App* report = command->add_subcommand("report", "Say what became of a plan's recordings");
  report->add_option("plan", *folder, "the folder that `fleet plan` wrote")
      ->required()
      ->check(CLI::ExistingDirectory);
  report->footer(
      "Writes table.tsv and index.html into it. Exit code 1 where a recording is not done. Example:\n"
      "  penumbra fleet report out/night");
  report->callback([folder] { make_report(*folder); });
}

}  // namespace penumbra::apps
