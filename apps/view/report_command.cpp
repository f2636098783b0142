// penumbra report: a run as one page to look at.

#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "apps/common/commands.h"
#include "apps/view/report_page.h"
#include "nn/base/file.h"

namespace penumbra::apps {

namespace {

constexpr const char* kReportExamples = R"(Examples:
  penumbra report out/00
  penumbra report out/00 -o street.html

The page holds everything that it shows and opens without a network: summary, path against the ground truth (from
above, and in space with the map), error and time frame by frame, the mismatch filter's histograms, keyframes.)";

struct ReportOptions {
  std::string run, out;
};

void run_report(const ReportOptions& options) {
  const std::filesystem::path folder = options.run;
  const std::filesystem::path out =
      options.out.empty() ? folder / "report.html" : std::filesystem::path(options.out);
  nn::write_file(out, make_report_page(folder));
  fmt::print("{}\n", out.string());
}

}  // namespace

void add_report_command(CLI::App& app) {
  const auto options = std::make_shared<ReportOptions>();
  CLI::App* command = app.add_subcommand("report", "Write a run of `penumbra slam` as one HTML page");
  command->footer(kReportExamples);
  command->add_option("run", options->run, "folder that `penumbra slam --out` wrote")->required();
  command->add_option("-o,--out", options->out, "the page (default: report.html in the run's folder)");
  command->callback([options] { run_report(*options); });
}

}  // namespace penumbra::apps
