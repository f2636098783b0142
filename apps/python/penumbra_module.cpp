// The Python module: the library's classes, with numpy arrays that are looked at and not copied.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "penumbra/evaluation.h"
#include "penumbra/segmenter.h"
#include "penumbra/slam.h"
#include "penumbra/version.h"

namespace py = pybind11;

namespace {

using Matrix = py::array_t<double, py::array::c_style | py::array::forcecast>;

// A numpy array as the library sees images: (height, width) or (height, width, 3), rows at any distance.
penumbra::ImageRef image_ref(const py::array& array, bool rgb, const char* name) {
  const bool is_bytes = py::isinstance<py::array_t<std::uint8_t>>(array);
  const bool is_colour = array.ndim() == 3 && array.shape(2) == 3;
  penumbra::ImageRef image;
  if (is_bytes && (array.ndim() == 2 || is_colour)) {
    image.format = !is_colour ? penumbra::PixelFormat::grey8
                   : rgb      ? penumbra::PixelFormat::rgb8
                              : penumbra::PixelFormat::bgr8;
  } else if (py::isinstance<py::array_t<std::uint16_t>>(array) && array.ndim() == 2) {
    image.format = penumbra::PixelFormat::depth16;
  } else if (py::isinstance<py::array_t<float>>(array) && array.ndim() == 2) {
    image.format = penumbra::PixelFormat::depth32_metres;
  } else {
    throw py::type_error(
        std::string(name) +
        ": expected uint8 (h, w) or (h, w, 3), or depth as uint16 or float32 (h, w), found " +
        std::string(py::str(array.dtype())) + " with " + std::to_string(array.ndim()) + " dimensions");
  }
  const py::ssize_t pixel = array.itemsize() * (is_colour ? 3 : 1);
  if (array.strides(1) != pixel || (is_colour && array.strides(2) != array.itemsize()))
    throw py::value_error(std::string(name) +
                          ": expected the pixels of a row side by side (numpy.ascontiguousarray)");
  image.pixels = array.data();
  image.height = static_cast<int>(array.shape(0));
  image.width = static_cast<int>(array.shape(1));
  image.row_bytes = array.strides(0);
  return image;
}

constexpr py::ssize_t kNumbers = 16;  // of a pose: 4 x 4, row by row, [R t; 0 1]

void write_pose(const penumbra::Pose& pose, double* matrix) {
  for (std::size_t row = 0; row < 3; ++row) {
    std::copy_n(pose.rotation.begin() + 3 * row, 3, matrix + 4 * row);
    matrix[4 * row + 3] = pose.translation[row];
  }
  const double last[] = {0.0, 0.0, 0.0, 1.0};
  std::copy_n(last, 4, matrix + 12);
}

penumbra::Pose read_pose(const double* matrix) {
  penumbra::Pose pose;
  for (std::size_t row = 0; row < 3; ++row) {
    std::copy_n(matrix + 4 * row, 3, pose.rotation.begin() + 3 * row);
    pose.translation[row] = matrix[4 * row + 3];
  }
  return pose;
}

Matrix matrix_of(const penumbra::Pose& pose) {
  Matrix matrix({4, 4});
  write_pose(pose, matrix.mutable_data());
  return matrix;
}

penumbra::Pose pose_of(const Matrix& matrix) {
  if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 4)
    throw py::value_error("a pose: expected a 4 x 4 matrix [R t; 0 1]");
  return read_pose(matrix.data());
}

// A path in Python: times (n) and poses (n, 4, 4).
py::tuple path_of(const std::vector<penumbra::TimedPose>& poses) {
  const auto count = static_cast<py::ssize_t>(poses.size());
  py::array_t<double> times(count), matrices({count, py::ssize_t{4}, py::ssize_t{4}});
  for (py::ssize_t i = 0; i < count; ++i) {
    const penumbra::TimedPose& pose = poses[static_cast<std::size_t>(i)];
    times.mutable_at(i) = pose.timestamp;
    write_pose(pose.T_world_camera, matrices.mutable_data() + kNumbers * i);
  }
  return py::make_tuple(times, matrices);
}

std::vector<penumbra::TimedPose> poses_of(const py::tuple& path) {
  if (path.size() != 2) throw py::value_error("a path: expected (times, poses)");
  const auto times = path[0].cast<Matrix>();
  const auto matrices = path[1].cast<Matrix>();
  if (times.ndim() != 1 || matrices.ndim() != 3 || matrices.shape(0) != times.shape(0) ||
      matrices.shape(1) != 4 || matrices.shape(2) != 4)
    throw py::value_error("a path: expected times (n) and poses (n, 4, 4)");
  std::vector<penumbra::TimedPose> poses;
  for (py::ssize_t i = 0; i < times.shape(0); ++i)
    poses.push_back({times.at(i), read_pose(matrices.data() + kNumbers * i)});
  return poses;
}

penumbra::TrackResult track(penumbra::Slam& slam, double timestamp, const py::array& left,
                            const std::optional<py::array>& right, const std::optional<py::array>& depth,
                            const std::optional<Matrix>& motion, bool rgb) {
  penumbra::Frame frame;
  frame.timestamp = timestamp;
  frame.left = image_ref(left, rgb, "left");
  if (right) frame.right = image_ref(*right, rgb, "right");
  if (depth) frame.depth = image_ref(*depth, rgb, "depth");
  if (motion) frame.motion = pose_of(*motion);
  const py::gil_scoped_release others_may_run;
  return slam.track(frame);
}

void add_slam(py::module_& m) {
  py::class_<penumbra::Rig>(m, "Rig", "The cameras: two side by side, or one with depth.")
      .def_static("read", &penumbra::Rig::read, py::arg("path"), "A calibration.yaml.")
      .def_static(
          "stereo",
          [](double fx, double fy, double cx, double cy, int width, int height, double baseline) {
            return penumbra::Rig::stereo({fx, fy, cx, cy, width, height}, baseline);
          },
          py::kw_only(), py::arg("fx"), py::arg("fy"), py::arg("cx"), py::arg("cy"), py::arg("width"),
          py::arg("height"), py::arg("baseline"), "Rectified pairs.")
      .def_static(
          "rgbd",
          [](double fx, double fy, double cx, double cy, int width, int height, double depth_factor) {
            return penumbra::Rig::rgbd({fx, fy, cx, cy, width, height}, depth_factor);
          },
          py::kw_only(), py::arg("fx"), py::arg("fy"), py::arg("cx"), py::arg("cy"), py::arg("width"),
          py::arg("height"), py::arg("depth_factor") = 1000.0, "Images with depth.")
      .def_property_readonly("has_depth", &penumbra::Rig::has_depth)
      .def_property_readonly("baseline", &penumbra::Rig::baseline)
      .def_property_readonly(
          "size", [](const penumbra::Rig& rig) { return py::make_tuple(rig.raw_width(), rig.raw_height()); });

  py::enum_<penumbra::State>(m, "State")
      .value("initialising", penumbra::State::initialising)
      .value("tracking", penumbra::State::tracking)
      .value("lost", penumbra::State::lost)
      .value("occluded", penumbra::State::occluded);

  py::class_<penumbra::TrackResult>(m, "TrackResult")
      .def_readonly("frame", &penumbra::TrackResult::frame)
      .def_readonly("timestamp", &penumbra::TrackResult::timestamp)
      .def_readonly("state", &penumbra::TrackResult::state)
      .def_property_readonly("T_world_camera",
                             [](const penumbra::TrackResult& r) { return matrix_of(r.T_world_camera); })
      .def_property_readonly("covariance",
                             [](const penumbra::TrackResult& r) -> py::object {
                               if (!r.covariance) return py::none();
                               Matrix matrix({6, 6});
                               std::copy(r.covariance->begin(), r.covariance->end(), matrix.mutable_data());
                               return matrix;
                             })
      .def_readonly("inliers", &penumbra::TrackResult::inliers)
      .def_readonly("keyframe", &penumbra::TrackResult::keyframe)
      .def_readonly("recovered", &penumbra::TrackResult::recovered)
      .def_readonly("new_piece", &penumbra::TrackResult::new_piece)
      .def_readonly("why_lost", &penumbra::TrackResult::why_lost)
      .def_readonly("warnings", &penumbra::TrackResult::warnings);

  py::class_<penumbra::Slam>(m, "Slam", "Images go in, poses and a map come out.")
      .def(py::init([](const penumbra::Rig& rig, const std::string& settings, int threads, bool deterministic,
                       const std::string& weights, const std::string& dynamics, const std::string& map,
                       bool localise) {
             penumbra::SlamOptions options;
             options.settings = settings;
             options.threads = threads;
             options.deterministic = deterministic;
             options.weights = weights;
             options.dynamics = dynamics;
             options.map = map;
             options.localise = localise;
             return penumbra::Slam(rig, options);
           }),
           py::arg("rig"), py::kw_only(), py::arg("settings") = "", py::arg("threads") = 0,
           py::arg("deterministic") = false, py::arg("weights") = "", py::arg("dynamics") = "",
           py::arg("map") = "", py::arg("localise") = false)
      .def("track", &track, py::arg("timestamp"), py::arg("left"), py::arg("right") = py::none(),
           py::kw_only(), py::arg("depth") = py::none(), py::arg("motion") = py::none(),
           py::arg("rgb") = false)
      .def("on_map_changed",
           [](penumbra::Slam& slam, const py::function& told) {
             slam.on_map_changed([told](const penumbra::Pose& T_new_old) {
               const py::gil_scoped_acquire ours;
               told(matrix_of(T_new_old));
             });
           })
      .def("snapshot",
           [](const penumbra::Slam& slam) {
             penumbra::MapSnapshot shown;
             {
               const py::gil_scoped_release others_may_run;
               shown = slam.snapshot();
             }
             const auto count = static_cast<py::ssize_t>(shown.points.size());
             py::array_t<float> points({count, py::ssize_t{3}});
             py::array_t<std::uint8_t> colours({count, py::ssize_t{3}});
             for (py::ssize_t i = 0; i < count; ++i) {
               const penumbra::MapPoint& point = shown.points[static_cast<std::size_t>(i)];
               std::copy(point.position.begin(), point.position.end(), points.mutable_data() + 3 * i);
               std::copy(point.colour.begin(), point.colour.end(), colours.mutable_data() + 3 * i);
             }
             py::dict found;
             found["keyframes"] = path_of(shown.keyframes);
             found["points"] = points;
             found["colours"] = colours;
             found["loops"] = shown.loops;
             return found;
           })
      .def("trajectory", [](const penumbra::Slam& slam) { return path_of(slam.trajectory()); })
      .def("finish", &penumbra::Slam::finish, py::call_guard<py::gil_scoped_release>())
      .def("save_map", &penumbra::Slam::save_map, py::arg("path"), py::call_guard<py::gil_scoped_release>())
      .def("reset", &penumbra::Slam::reset);
}

void add_segmenter(py::module_& m) {
  py::class_<penumbra::Instance>(m, "Instance")
      .def_readonly("class_id", &penumbra::Instance::class_id)
      .def_readonly("class_name", &penumbra::Instance::class_name)
      .def_readonly("score", &penumbra::Instance::score)
      .def_property_readonly(
          "box", [](const penumbra::Instance& i) { return py::make_tuple(i.x1, i.y1, i.x2, i.y2); })
      .def_property_readonly("mask_at",
                             [](const penumbra::Instance& i) { return py::make_tuple(i.mask_x, i.mask_y); })
      .def_property_readonly("mask", [](const py::object& self) {
        // The instance's own bytes, alive as long as the array.
        const auto& i = self.cast<const penumbra::Instance&>();
        return py::array_t<std::uint8_t>({i.mask_height, i.mask_width}, i.mask.data(), self);
      });
  py::class_<penumbra::Segmenter>(m, "Segmenter", "Finds things in images.")
      .def(py::init([](const std::string& weights, float least_score, const std::string& classes) {
             return penumbra::Segmenter(weights, {least_score, classes});
           }),
           py::arg("weights"), py::kw_only(), py::arg("least_score") = 0.5F, py::arg("classes") = "")
      .def_property_readonly("network", &penumbra::Segmenter::network)
      .def_property_readonly("has_masks", &penumbra::Segmenter::has_masks)
      .def(
          "find",
          [](penumbra::Segmenter& segmenter, const py::array& image, bool rgb) {
            const penumbra::ImageRef ref = image_ref(image, rgb, "image");
            const py::gil_scoped_release others_may_run;
            return segmenter.find(ref);
          },
          py::arg("image"), py::kw_only(), py::arg("rgb") = false);
}

}  // namespace

PYBIND11_MODULE(_penumbra, m) {
  m.attr("__version__") = penumbra::version();
  add_slam(m);
  add_segmenter(m);
  m.def(
      "evaluate",
      [](const py::tuple& truth, const py::tuple& estimate) {
        const penumbra::PathError error = penumbra::evaluate(poses_of(truth), poses_of(estimate));
        py::dict found;
        found["poses"] = error.poses;
        found["rmse"] = error.rmse;
        found["mean"] = error.mean;
        found["median"] = error.median;
        found["max"] = error.max;
        return found;
      },
      py::arg("truth"), py::arg("estimate"));
  m.def(
      "read_trajectory", [](const std::string& path) { return path_of(penumbra::read_trajectory(path)); },
      py::arg("path"));
}
