#include "tests/slam/world/synthetic.h"

#include <opencv2/imgproc.hpp>
#include <random>

namespace penumbra::test {

using namespace slam;

cv::Mat textured_image(int width, int height, int seed) {
  cv::RNG random(static_cast<std::uint64_t>(seed) + 1);
  cv::Mat sum = cv::Mat::zeros(height, width, CV_32F);
  for (const int cell : {3, 6, 12, 24}) {
    cv::Mat noise(height / cell + 2, width / cell + 2, CV_32F), grown;
    random.fill(noise, cv::RNG::UNIFORM, -1.0, 1.0);
    cv::resize(noise, grown, {width, height}, 0.0, 0.0, cv::INTER_NEAREST);
    sum += grown;
  }
  cv::Mat image;
  cv::normalize(sum, sum, 0.0, 255.0, cv::NORM_MINMAX);
  sum.convertTo(image, CV_8U);
  cv::GaussianBlur(image, image, {0, 0}, 0.8);
  return image;
}

StereoCamera test_camera() {
  StereoCamera camera;
  camera.fx = camera.fy = 718.856;
  camera.cx = 607.2;
  camera.cy = 185.2;
  camera.baseline = 0.537;
  camera.width = 1241;
  camera.height = 376;
  return camera;
}

std::vector<Eigen::Vector3d> visible_points(const StereoCamera& camera, int count, int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> u(60.0, camera.width - 10.0), v(10.0, camera.height - 10.0),
      z(4.0, 40.0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double pu = u(random), pv = v(random), pz = z(random);
    points.push_back(camera.back_project(pu, pv, pz));
  }
  return points;
}

SE3 random_motion(int seed, double translation, double angle) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::normal_distribution<double> normal;
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = normal(random);
  xi.head<3>() *= translation / xi.head<3>().norm();
  xi.tail<3>() *= angle / xi.tail<3>().norm();
  return SE3::exp(xi);
}

}  // namespace penumbra::test
