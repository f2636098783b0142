// The bend that ends behind a lorry; the whole drive, over five streets: tests/long_run/close_lorry_test.cpp.
#include "tests/support/lorry_close.h"

namespace penumbra::test {
namespace {

TEST(CloseLorry, ExactMasksSeeTheBendEndBehindIt) {
  const LorryCloseErrors errors = drive_behind_close_lorry(/*seed=*/141, /*frames=*/76);
  EXPECT_LT(errors.truth, 0.5);
  EXPECT_LE(errors.truth, errors.none);
}

}  // namespace
}  // namespace penumbra::test
