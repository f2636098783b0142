// A lorry that covers up to 85 % of the view while a bend ends: exact masks must help, whatever the street.
#include "tests/support/lorry_close.h"

namespace penumbra::test {
namespace {

TEST(CloseLorry, ExactMasksAreNeverWorseThanNone) {
  int within_a_metre = 0;
  for (const int seed : {140, 141, 142, 143, 144}) {
    const LorryCloseErrors errors = drive_behind_close_lorry(seed, 200);
    EXPECT_LE(errors.truth, errors.none) << seed;
    within_a_metre += errors.truth <= 1.0;
  }
  EXPECT_GE(within_a_metre, 4);
}

}  // namespace
}  // namespace penumbra::test
