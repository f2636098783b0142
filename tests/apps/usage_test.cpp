// The program's outermost behaviour: help, version, exit codes.
#include <gtest/gtest.h>

#include "tests/support/test_data.h"

namespace penumbra::test {
namespace {

TEST(Usage, HelpAndVersionSucceed) {
  EXPECT_EQ(run_penumbra("--help").exit_code, 0);
  EXPECT_EQ(run_penumbra("--version").out, "penumbra 0.1.0\n");
}

TEST(Usage, WrongArgumentsGiveExitCode2) {
  EXPECT_EQ(run_penumbra("").exit_code, 2);
  EXPECT_EQ(run_penumbra("--no-such-option").exit_code, 2);
  EXPECT_EQ(run_penumbra("no-such-command").exit_code, 2);
}

}  // namespace
}  // namespace penumbra::test
