// A lorry that covers up to 85 % of the view while a bend ends: exact masks must help, whatever the street.
#include "tests/support/lorry_close.h"

namespace penumbra::test {
namespace {

class CloseLorry : public ::testing::TestWithParam<int> {};  // the street's seed

TEST_P(CloseLorry, ExactMasksAreNeverWorseThanNone) {
  const LorryCloseErrors errors = drive_behind_close_lorry(GetParam(), /*frames=*/200);
  EXPECT_LE(errors.truth, errors.none);
  EXPECT_LE(errors.truth, 1.0);
}

INSTANTIATE_TEST_SUITE_P(Streets, CloseLorry, ::testing::Range(140, 145));

}  // namespace
}  // namespace penumbra::test
