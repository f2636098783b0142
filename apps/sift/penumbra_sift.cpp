// penumbra-sift: `match-eval` with OpenCV's SIFT beside our features. A target of its own, built on request
// where OpenCV is, for `penumbra` does without OpenCV.
#include "apps/common/log.h"
#include "apps/evaluate/match_eval_command.h"
#include "apps/sift/sift_baseline.h"

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  CLI::App app{"Penumbra's match-eval, with SIFT beside it", "penumbra-sift"};
  app.require_subcommand(1);
  penumbra::apps::add_match_eval_command(app,
                                         [] { return std::make_unique<penumbra::apps::SiftBaseline>(); });
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    penumbra::apps::log_error("{}", error.what());
    return 1;
  }
  return 0;
}
