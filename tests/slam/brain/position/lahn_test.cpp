#include "slam/brain/position/lahn.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "nn/base/error.h"
#include "slam/brain/position/random_stream.h"

namespace penumbra::slam::brain {
namespace {

// (5) to (7) and the two rules, number by number.
struct NaiveLahn {
  LahnSettings settings;
  std::vector<std::vector<double>> q, w;
  std::vector<double> xi;

  explicit NaiveLahn(const Eigen::MatrixXf& forward, const LahnSettings& of)
      : settings(of),
        q(static_cast<std::size_t>(forward.rows())),
        w(q.size(), std::vector<double>(q.size(), 0.0)),
        xi(q.size(), 0.0) {
    for (std::size_t i = 0; i < q.size(); ++i) {
      for (Eigen::Index j = 0; j < forward.cols(); ++j)
        q[i].push_back(forward(static_cast<Eigen::Index>(i), j));
    }
  }

  void step_and_learn(const std::vector<float>& chi) {
    const std::vector<double> before = xi;
    for (std::size_t i = 0; i < q.size(); ++i) {
      double a = -settings.threshold;
      for (std::size_t j = 0; j < chi.size(); ++j) a += q[i][j] * chi[j];
      for (std::size_t k = 0; k < q.size(); ++k) a += w[i][k] * before[k];
      xi[i] = settings.bipolar ? std::tanh(a) : std::clamp(a, 0.0, 1.0);
    }
    double largest = 0.0;
    for (std::size_t i = 0; i < q.size(); ++i) {
      for (std::size_t j = 0; j < chi.size(); ++j) {
        q[i][j] += settings.forward_rate * (chi[j] * xi[i] - q[i][j] * xi[i] * xi[i]);
        largest = std::max(largest, std::abs(q[i][j]));
      }
      for (std::size_t k = 0; k < q.size(); ++k) {
        if (settings.lateral == LateralRule::none) continue;
        const double p = settings.lateral == LateralRule::paper ? 0.0 : settings.sparseness;
        w[i][k] -= settings.lateral_rate * (xi[i] * before[k] - p * p);
        if (settings.lateral == LateralRule::foeldiak) w[i][k] = i == k ? 0.0 : std::min(w[i][k], 0.0);
        largest = std::max(largest, std::abs(w[i][k]));
      }
    }
    const double scale = std::min(1.0, settings.bound / largest);
    for (auto* all : {&q, &w}) {
      for (auto& row : *all) {
        for (double& weight : row) weight *= scale;
      }
    }
  }
};

void expect_as_naive(const LahnSettings& settings, int steps, double tolerance) {
  Lahn network(8, settings, 5);
  NaiveLahn naive(network.forward(), settings);
  RandomStream random(6);
  std::vector<float> chi(8);
  for (int t = 0; t < steps; ++t) {
    for (float& x : chi) x = static_cast<float>(random.uniform(-1.0, 1.0));
    network.step(chi);
    network.learn(chi);
    naive.step_and_learn(chi);
  }
  for (std::size_t i = 0; i < naive.q.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    EXPECT_NEAR(network.activity()[i], naive.xi[i], tolerance);
    for (std::size_t j = 0; j < chi.size(); ++j)
      ASSERT_NEAR(network.forward()(row, static_cast<Eigen::Index>(j)), naive.q[i][j], tolerance);
    for (std::size_t k = 0; k < naive.q.size(); ++k)
      ASSERT_NEAR(network.lateral()(row, static_cast<Eigen::Index>(k)), naive.w[i][k], tolerance);
  }
}

TEST(Lahn, IsAsANaiveOne) {
  LahnSettings settings = LahnSettings::of_rule("rectified");
  settings.cells = 4;
  settings.forward_rate = settings.lateral_rate = 0.05F;  // quick, so that something is learned
  settings.threshold = 0.0F;
  expect_as_naive(settings, 200, 1e-4);
  settings.lateral = LateralRule::none;
  expect_as_naive(settings, 200, 1e-4);
  LahnSettings paper = LahnSettings::of_rule("paper");
  paper.cells = 4;
  expect_as_naive(paper, 10, 1e-4);
  paper.forward_rate = paper.lateral_rate = 0.02F;
  paper.bound = 0.2F;  // rescales
  expect_as_naive(paper, 100, 1e-4);
}

// The letter: 0.9 of the weights are replaced at every step, so all cells are the present input up to sign.
TEST(Lahn, ThePapersRatesKeepThePresentInputAlone) {
  Lahn network(24, LahnSettings::of_rule("paper"), 7);
  RandomStream random(8);
  std::vector<float> chi(24);
  for (int t = 0; t < 500; ++t) {
    const double phase = 0.02 * t;
    for (std::size_t j = 0; j < chi.size(); ++j)
      chi[j] = static_cast<float>(
          std::cos(phase * (1.0 + 0.1 * static_cast<double>(j)) + 2.4 * static_cast<double>(j)));
    network.step(chi);
    network.learn(chi);
  }
  const Eigen::Map<const Eigen::VectorXf> input(chi.data(), 24);
  for (Eigen::Index i = 0; i < network.forward().rows(); ++i) {
    const Eigen::VectorXf row = network.forward().row(i);
    EXPECT_GT(std::abs(row.normalized().dot(input.normalized())), 0.98F) << i;
  }
}

TEST(Lahn, OutputsAreCutOrBipolar) {
  const LahnSettings rectified = LahnSettings::of_rule("rectified"), paper = LahnSettings::of_rule("paper");
  EXPECT_EQ(grid_cell_output(0.1F, rectified), 0.0F);
  EXPECT_NEAR(grid_cell_output(0.7F, rectified), 0.5F, 1e-6);
  EXPECT_EQ(grid_cell_output(5.0F, rectified), 1.0F);
  EXPECT_NEAR(grid_cell_output(-0.5F, paper), std::tanh(-0.5), 1e-6);
  EXPECT_THROW(LahnSettings::of_rule("hebb"), UsageError);
}

TEST(Lahn, IsReadWithoutTheLateralWeightsThatServedLearning) {
  LahnSettings settings;
  settings.forward_rate = settings.lateral_rate = 0.05F;
  settings.threshold = 0.0F;
  Lahn network(8, settings, 9);
  const std::vector<float> chi(8, 0.7F);
  for (int t = 0; t < 50; ++t) network.step(chi), network.learn(chi);
  ASSERT_LT(network.lateral().minCoeff(), 0.0F);
  Lahn reader = network.reader();
  reader.step(chi);
  const std::vector<float> once(reader.activity().begin(), reader.activity().end());
  reader.step(chi);
  EXPECT_TRUE(std::equal(once.begin(), once.end(), reader.activity().begin()));
}

TEST(Lahn, TellsNumbersThatAreNotFinite) {
  Eigen::MatrixXf forward = Eigen::MatrixXf::Constant(2, 4, 0.1F);
  EXPECT_TRUE(Lahn(forward, LahnSettings{}).finite());
  forward(1, 2) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(Lahn(forward, LahnSettings{}).finite());
}

}  // namespace
}  // namespace penumbra::slam::brain
