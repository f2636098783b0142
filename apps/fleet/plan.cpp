#include "apps/fleet/plan.h"

#include <fmt/format.h>

#include <cmath>

#include "apps/common/command_line.h"
#include "apps/view/embedded_files.h"
#include "nn/base/file.h"

namespace penumbra::apps {

namespace {

// As many districts as there are recordings in one: the merges of either kind are equally large, and neither
// has more than a few dozen maps.
std::size_t district_size_of(std::size_t recordings) {
  constexpr std::size_t kAllAtOnce = 40;
  if (recordings <= kAllAtOnce) return 0;
  return static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(recordings))));
}

std::string settings_of(const FleetPlan& plan) {
  std::string all;
  for (const std::string& option : plan.sbatch) all += in_shell_quotes(option) + ' ';
  if (!all.empty()) all.pop_back();
  return fmt::format(
      "# Written by `penumbra fleet plan`; what is changed here counts from the next job on, until\n"
      "# the plan is written anew.\n"
      "penumbra={}\n"
      "# Options of sbatch: of every job, of a recording's, of the merge's.\n"
      "all_options=({})\n"
      "recording_options=(--cpus-per-task={} --mem={} --time={})\n"
      "merge_options=(--cpus-per-task={} --mem={} --time={})\n"
      "at_once={} # recordings at the same time; 0: as many as there is place for\n"
      "district_size={} # recordings that are merged first, where there are more; 0: all at once\n",
      in_shell_quotes(plan.program), all, plan.processors, plan.memory_mb, in_shell_quotes(plan.time),
      plan.processors, plan.merge_memory_mb, in_shell_quotes(plan.time), plan.at_once,
      plan.district_size.value_or(district_size_of(plan.recordings.size())));
}

}  // namespace

void write_fleet_plan(const std::filesystem::path& folder, const FleetPlan& plan) {
  nn::make_writable_folder(folder);
  std::string jobs;
  for (const FleetRecording& recording : plan.recordings) {
    jobs += fmt::format("{}\t{}\t", recording.name, plan.folder.string());
    for (const std::string& word : recording.arguments) jobs += in_shell_quotes(word) + ' ';
    jobs.back() = '\n';
  }
  // A map that was merged of other recordings is not this plan's: it is kept, but not reported.
  const std::filesystem::path list = folder / "jobs.tsv";
  if (!std::filesystem::exists(list) || nn::read_file(list, "a plan's jobs") != jobs) {
    std::filesystem::remove(folder / "merged/done");
    std::filesystem::remove(folder / "merged/log.txt");
  }
  nn::write_file(list, jobs);
  nn::write_file(folder / "settings.sh", settings_of(plan));
  const std::pair<const char*, std::string_view> scripts[] = {{"step.sh", embedded::fleet_step_sh()},
                                                              {"submit.sh", embedded::fleet_submit_sh()},
                                                              {"here.sh", embedded::fleet_here_sh()}};
  for (const auto& [name, text] : scripts) {
    nn::write_file(folder / name, text);
    using enum std::filesystem::perms;
    std::filesystem::permissions(folder / name, owner_exec | group_exec | others_exec,
                                 std::filesystem::perm_options::add);
  }
}

}  // namespace penumbra::apps
