#include "slam/backend/block_products.h"

#include <gtest/gtest.h>

#include <random>

namespace penumbra::slam {
namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;

TEST(BlockProducts, AreThoseOfEigenOnEveryProcessor) {
  constexpr int kPoses = 5;
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const Eigen::MatrixXd start = Eigen::MatrixXd::Random(6 * kPoses, 6 * kPoses);
    std::vector<int> slots;
    std::vector<Matrix63> W;
    for (unsigned k = random() % 9; k > 0; --k) {
      slots.push_back(static_cast<int>(random() % (kPoses + 1)) - 1);  // -1: a fixed pose
      W.push_back(i % 5 == 0 ? Matrix63::Zero() : Matrix63(1e3 * Matrix63::Random()));
    }
    const int a = static_cast<int>(random() % kPoses);
    const Matrix63 Y = Matrix63::Random();
    Eigen::MatrixXd naive = start;
    for (std::size_t k = 0; k < slots.size(); ++k) {
      if (slots[k] >= a) naive.block<6, 6>(6 * a, 6 * slots[k]) -= Y * W[k].transpose();
    }
    std::vector<Eigen::MatrixXd> ours;
    for (const bool avx : {false, true}) {
      if (avx && !has_avx()) continue;
      ours.push_back(start);
      subtract_products({ours.back().data(), 6 * kPoses}, a, Y, W.data(), slots, avx);
      EXPECT_LE((ours.back() - naive).norm(), 1e-12 * (1.0 + naive.norm()));
    }
    EXPECT_EQ(ours.front(), ours.back()) << "to the last bit";
  }
}

}  // namespace
}  // namespace penumbra::slam
