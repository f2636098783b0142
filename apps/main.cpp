// penumbra: stereo visual SLAM that sees half-hidden things. This file parses the command line, picks the
// subcommand and turns exceptions into exit codes: 0 done, 1 failed while running, 2 wrong arguments.

#include <fmt/core.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>

#include "apps/common/command_line.h"
#include "apps/common/commands.h"
#include "apps/common/log.h"
#include "apps/view/embedded_files.h"
#include "nn/base/error.h"

namespace {

constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;

// What was printed may still wait in a buffer, and a full disk shows only when it is written. Who closes a
// pipe early
// (`| head`) has seen what he wanted.
bool standard_output_is_whole() {
  if ((std::fflush(stdout) == 0 && std::ferror(stdout) == 0) || errno == EPIPE) return true;
  penumbra::apps::log_error("standard output: cannot be written: {}", std::strerror(errno));
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  penumbra::apps::remember_command_line(argc, argv);
  // A file that grows beyond the shell's limit is an error like a full disk, not the end of the program.
  std::signal(SIGXFSZ, SIG_IGN);

  CLI::App app{"Penumbra: stereo visual SLAM that sees half-hidden things", "penumbra"};
  app.set_version_flag("--version", std::string("penumbra ") + penumbra::apps::kVersion);
  app.add_flag_callback(
      "--licences",
      [] {
        fmt::print("{}", penumbra::apps::embedded::licences());
        throw CLI::Success();
      },
      "the licences of the libraries in this program and in its report's page");
  app.require_subcommand(1);
  app.footer("Run `penumbra COMMAND --help` for a command's options and examples.");

  penumbra::apps::add_slam_command(app);
  penumbra::apps::add_brain_command(app);
  penumbra::apps::add_segment_command(app);
  penumbra::apps::add_classify_command(app);
  penumbra::apps::add_synth_command(app);
  penumbra::apps::add_report_command(app);
  penumbra::apps::add_export_command(app);
  penumbra::apps::add_merge_command(app);
  penumbra::apps::add_fleet_command(app);
  penumbra::apps::add_ablate_command(app);
  penumbra::apps::add_eval_command(app);
  penumbra::apps::add_match_eval_command(app);
  penumbra::apps::add_eval_loops_command(app);
  penumbra::apps::add_eval_dense_command(app);
  penumbra::apps::add_eval_coco_command(app);
  penumbra::apps::add_eval_masks_command(app);
  penumbra::apps::add_convert_command(app);
  penumbra::apps::add_info_command(app);
  penumbra::apps::add_calibrate_command(app);
  penumbra::apps::add_calibration_command(app);
  penumbra::apps::add_bench_command(app);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kExitUsage;
  } catch (const penumbra::UsageError& error) {
    penumbra::apps::log_error("{}", error.what());
    return kExitUsage;
  } catch (const std::exception& error) {
    penumbra::apps::log_error("{}", error.what());
    return kExitFailed;
  }
  return standard_output_is_whole() ? 0 : kExitFailed;
}
