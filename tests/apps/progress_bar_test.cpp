#include "apps/common/progress_bar.h"

#include <gtest/gtest.h>

namespace penumbra::apps {
namespace {

// Where stderr is no terminal, as under ctest, a line is due from time to time instead of a bar.
TEST(ProgressBar, TellsALogLineByLine) {
  using std::chrono::milliseconds;
  testing::internal::CaptureStderr();
  {
    ProgressBar progress("Tracking", 40, "frames", milliseconds(0));
    progress.update(10);
    progress.update(20);
  }
  const std::string lines = testing::internal::GetCapturedStderr();
  EXPECT_EQ(lines.find("Tracking 10/40  "), 0U) << lines;
  EXPECT_NE(lines.find("\nTracking 20/40  "), std::string::npos) << lines;
  EXPECT_NE(lines.find(" left\n"), std::string::npos) << lines;
  EXPECT_EQ(lines.find('\r'), std::string::npos);

  testing::internal::CaptureStderr();
  ProgressBar patient("Tracking", 40);
  patient.update(40);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "ten seconds have not passed";
}

}  // namespace
}  // namespace penumbra::apps
