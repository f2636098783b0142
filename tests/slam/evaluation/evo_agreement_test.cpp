// Agreement with evo on published trajectories of ORB-SLAM2 and S-PTAM: every number within 1e-6 (relative).
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "slam/evaluation/evaluation.h"
#include "slam/geometry/association.h"
#include "slam/geometry/trajectory_io.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

void expect_agreement(const ErrorStatistics& ours, const nlohmann::json& evo, const std::string& name) {
  const std::pair<const char*, double> values[] = {
      {"rmse", ours.rmse}, {"mean", ours.mean}, {"median", ours.median}, {"std", ours.std},
      {"min", ours.min},   {"max", ours.max},   {"sse", ours.sse}};
  for (const auto& [key, value] : values) {
    const double expected = evo.at(name).at(key).get<double>();
    EXPECT_NEAR(value, expected, 1e-6 * expected) << name << " " << key;
  }
}

void expect_agreement(const TrajectoryPair& pair, const nlohmann::json& evo) {
  EvaluationOptions options;
  for (const Alignment alignment : {Alignment::sim3, Alignment::se3, Alignment::none}) {
    options.alignment = alignment;
    const Evaluation result = evaluate_trajectory(pair.reference, pair.estimate, options);
    EXPECT_TRUE(result.alignment.is_unique);
    expect_agreement(result.ape, evo, std::string("ape_trans_") + to_string(alignment));
    if (alignment == Alignment::sim3) continue;  // rescales the relative motion; evo's RPE is without
    expect_agreement(result.rpe_frames, evo, "rpe_trans_1f");
    expect_agreement(result.rpe_frames_rotation, evo, "rpe_rotdeg_1f");
    if (!evo.contains("rpe_trans_100m")) continue;
    expect_agreement(result.rpe_metres, evo, "rpe_trans_100m");
    expect_agreement(result.rpe_metres_rotation, evo, "rpe_rotdeg_100m");
  }
}

TEST(EvoAgreement, KittiTrajectories) {
  PENUMBRA_REAL_DATA(folder, "trajectories");
  PENUMBRA_REAL_DATA(reference, "kitti/poses/00.txt");
  const nlohmann::json evo = nlohmann::json::parse(std::ifstream(folder / "expected_evo.json"));
  for (const std::string name : {"KITTI_00_ORB", "KITTI_00_SPTAM"}) {
    SCOPED_TRACE(name);
    expect_agreement({read_kitti_trajectory(reference), read_kitti_trajectory(folder / (name + ".txt"))},
                     evo.at(name));
  }
}

TEST(EvoAgreement, TumTrajectoriesPairedByTime) {
  PENUMBRA_REAL_DATA(folder, "trajectories");
  const nlohmann::json evo =
      nlohmann::json::parse(std::ifstream(folder / "expected_evo.json")).at("fr2_desk_ORB");
  const TrajectoryPair pair = associate_by_time(read_tum_trajectory(folder / "fr2_desk_groundtruth.txt"),
                                                read_tum_trajectory(folder / "fr2_desk_ORB.txt"));
  EXPECT_EQ(pair.reference.size(), evo.at("pairs").get<std::size_t>());
  expect_agreement(pair, evo);
}

}  // namespace
}  // namespace penumbra::slam
