// Maps of a street whose houses and lamps are all equal: nothing can tell where one is in another.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include "tests/support/test_data.h"

namespace penumbra {
namespace {

TEST(MergedStreets, ThatLookAlikeEverywhereStayApart) {
  const test::TemporaryDirectory folder;
  const std::string at = folder.path().string();
  const auto run = [&](const std::string& arguments) {
    const test::ProgramResult result = test::run_penumbra(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  };
  run(fmt::format("synth --preset alike --frames 260 --size 620x188 --out '{}/street'", at));
  for (int i = 0; i < 2; ++i) {
    run(
        fmt::format("slam '{0}/street' --frames {1}:{2} --deterministic --segmentation off --save-map "
                    "'{0}/{3}.map' --out "
                    "'{0}/out'",
                    at, 130 * i, 130 * (i + 1), i));
  }
  const std::string said = run(fmt::format("merge '{0}/0.map' '{0}/1.map' -o '{0}/both.map'", at));
  EXPECT_NE(said.find("2 pieces"), std::string::npos) << said;
}

}  // namespace
}  // namespace penumbra
