// penumbra brain train-grid.
#include <gtest/gtest.h>

#include "slam/brain/position/grid_file.h"
#include "tests/support/bytes.h"
#include "tests/support/test_data.h"

namespace penumbra::test {
namespace {

TEST(TrainGrid, WritesTheFileItsPicturesAndTheTable) {
  const TemporaryDirectory folder;
  const std::string out = (folder / "new" / "grid.safetensors").string();
  const ProgramResult run =
      run_penumbra("brain train-grid --room L --seconds 20 --seed 3 --modules 3 --out '" + out + "'");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* part : {"rectified", "with R_p", "no lateral", "untrained", "paper", "frozen maps",
                           "live maps", "30 % noise", "stretched", "head directions uneven by 0."}) {
    EXPECT_NE(run.out.find(part), std::string::npos) << part << '\n' << run.out;
  }
  const slam::brain::StoredGridCode stored = slam::brain::read_grid_code(out);
  EXPECT_EQ(stored.code.modules.size(), 3U);
  EXPECT_EQ(stored.history.at("room"), "L");
  EXPECT_EQ(stored.history.at("seed"), "3");
  for (const char* name : {"grid-maps.jpg", "grid-growth.svg", "grid-ring.svg"})
    EXPECT_TRUE(std::filesystem::is_regular_file(folder / "new" / name)) << name;
}

TEST(TrainGrid, GivesTheSameFileOnAnyNumberOfThreads) {
  const TemporaryDirectory folder;
  for (const char* threads : {"1", "2"}) {
    // This command has no --threads.
    ::setenv("OMP_NUM_THREADS", threads, 1);
    const ProgramResult run = run_penumbra("brain train-grid --seconds 50 --modules 2 --seeds 0 --out '" +
                                           (folder / threads).string() + "'");
    EXPECT_EQ(run.exit_code, 0) << run.err;
  }
  ::unsetenv("OMP_NUM_THREADS");
  EXPECT_EQ(read_file(folder / "1"), read_file(folder / "2"));
}

TEST(TrainGrid, RefusesWhatItCannotDo) {
  const TemporaryDirectory folder;
  const std::string out = " --seeds 0 --out '" + (folder / "grid").string() + "'";
  for (const char* wrong : {"--room round", "--seconds 0", "--seconds nan", "--rule hebb", "--modules 0"})
    EXPECT_EQ(run_penumbra("brain train-grid " + std::string(wrong) + out).exit_code, 2) << wrong;
  EXPECT_EQ(run_penumbra("brain train-grid").exit_code, 2);
  EXPECT_EQ(run_penumbra("brain train-grid --seconds 1 --seeds 0 --out /proc/none/grid").exit_code, 1);
}

}  // namespace
}  // namespace penumbra::test
