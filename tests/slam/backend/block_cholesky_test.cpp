#include "slam/backend/block_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <random>

namespace penumbra::slam {
namespace {

// A symmetric positive definite matrix of 6 x 6 blocks, as points that a few poses see leave it.
struct Problem {
  std::vector<std::vector<int>> columns;
  std::vector<Matrix6d> blocks;
  Eigen::MatrixXd dense;
  Eigen::VectorXd right;
};

Problem problem_of(int poses, const std::vector<std::vector<int>>& seen_by, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&](int rows, int columns) {
    Eigen::MatrixXd m(rows, columns);
    for (double& value : m.reshaped()) value = normal(random);
    return m;
  };
  Problem problem;
  problem.dense = Eigen::MatrixXd::Identity(6 * poses, 6 * poses) * 0.1;
  std::vector<std::vector<char>> has(poses, std::vector<char>(poses, 0));
  for (const std::vector<int>& point : seen_by) {
    const Eigen::MatrixXd J = draw(3, 6 * static_cast<int>(point.size()));
    const Eigen::MatrixXd JJ = J.transpose() * J;
    for (std::size_t a = 0; a < point.size(); ++a) {
      for (std::size_t b = 0; b < point.size(); ++b) {
        problem.dense.block<6, 6>(6 * point[a], 6 * point[b]) += JJ.block<6, 6>(6 * a, 6 * b);
        has[point[a]][point[b]] = 1;
      }
    }
  }
  for (int a = 0; a < poses; ++a) {
    problem.columns.push_back({a});
    for (int b = a + 1; b < poses; ++b) {
      if (has[a][b]) problem.columns.back().push_back(b);
    }
    for (const int b : problem.columns.back())
      problem.blocks.push_back(problem.dense.block<6, 6>(6 * a, 6 * b));
    // Below its diagonal nobody looks.
    Matrix6d& own = problem.blocks[problem.blocks.size() - problem.columns.back().size()];
    for (int r = 1; r < 6; ++r) own.row(r).head(r).setConstant(std::nan(""));
  }
  problem.right = draw(6 * poses, 1);
  return problem;
}

// Along a drive a point is seen by some neighbours; now and then by poses far apart, where a loop closed.
std::vector<std::vector<int>> drive(int poses, int band, int loops, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::vector<int>> seen_by;
  for (int a = 0; a + 1 < poses; ++a) {
    std::vector<int> point;
    for (int b = a; b < std::min(poses, a + band); ++b) {
      if (b == a || random() % 3 != 0) point.push_back(b);
    }
    seen_by.push_back(point);
  }
  for (int i = 0; i < loops; ++i) {
    const int a = static_cast<int>(random() % poses), b = static_cast<int>(random() % poses);
    if (a != b) seen_by.push_back({a, b});
  }
  return seen_by;
}

void expect_solved(const Problem& problem) {
  BlockCholesky cholesky(problem.columns);
  ASSERT_TRUE(cholesky.factorise(problem.blocks));
  const Eigen::VectorXd x = cholesky.solve(problem.right);
  const Eigen::VectorXd expected = problem.dense.ldlt().solve(problem.right);
  EXPECT_LT((x - expected).norm(), 1e-9 * expected.norm());
  BlockCholesky plain(problem.columns);
  ASSERT_TRUE(plain.factorise(problem.blocks, false));
  EXPECT_EQ(plain.solve(problem.right), x) << "AVX or not, the same bits";
}

TEST(BlockCholesky, SolvesWhatDenseCholeskySolves) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const int poses = 1 + static_cast<int>(seed * 7 % 60);
    expect_solved(
        problem_of(poses, drive(poses, 2 + static_cast<int>(seed % 9), static_cast<int>(seed), seed), seed));
  }
}

TEST(BlockCholesky, SolvesWhatEigensSparseCholeskySolvesWithAsFewBlocks) {
  constexpr int kPoses = 400;
  const Problem problem = problem_of(kPoses, drive(kPoses, 10, 40, 1), 2);
  BlockCholesky ours(problem.columns);
  const Eigen::SparseMatrix<double> matrix = problem.dense.sparseView();
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> eigens(matrix);
  ASSERT_TRUE(ours.factorise(problem.blocks));
  ASSERT_EQ(eigens.info(), Eigen::Success);
  const Eigen::VectorXd expected = eigens.solve(problem.right);
  EXPECT_LT((ours.solve(problem.right) - expected).norm(), 1e-9 * expected.norm());
  const auto numbers = static_cast<double>(eigens.matrixL().nestedExpression().nonZeros());
  EXPECT_LT(36.0 * static_cast<double>(ours.factor_blocks()), 1.3 * numbers);
}

TEST(BlockCholesky, TakesPosesThatShareNothingAndPosesThatShareAll) {
  expect_solved(problem_of(1, {}, 1));
  expect_solved(problem_of(9, {}, 2));
  std::vector<int> all(12);
  for (int a = 0; a < 12; ++a) all[static_cast<std::size_t>(a)] = a;
  expect_solved(problem_of(12, {all, all}, 3));
  // A star: in the wrong order its factor would be full.
  std::vector<std::vector<int>> star;
  for (int a = 1; a < 50; ++a) star.push_back({0, a});
  expect_solved(problem_of(50, star, 4));
  EXPECT_EQ(BlockCholesky(problem_of(50, star, 4).columns).factor_blocks(), 99U);
}

TEST(BlockCholesky, SaysThatAMatrixIsNotPositiveDefiniteAndGoesOnWithTheNext) {
  const Problem good = problem_of(30, drive(30, 4, 3, 5), 6);
  BlockCholesky cholesky(good.columns);
  Problem bad = good;
  bad.blocks[bad.blocks.size() / 2](0, 0) = std::nan("");
  EXPECT_FALSE(cholesky.factorise(bad.blocks));
  bad = good;
  std::size_t block = 0;
  for (std::size_t a = 0; a < 17; ++a) block += bad.columns[a].size();
  bad.blocks[block] = -Matrix6d::Identity();
  EXPECT_FALSE(cholesky.factorise(bad.blocks));
  EXPECT_TRUE(cholesky.factorise(good.blocks));
  EXPECT_LT((good.dense * cholesky.solve(good.right) - good.right).norm(), 1e-9);
}

}  // namespace
}  // namespace penumbra::slam
