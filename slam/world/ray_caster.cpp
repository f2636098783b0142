#include "slam/world/ray_caster.h"

#include <algorithm>
#include <cmath>

#include "nn/base/parallel.h"
#include "slam/world/materials.h"

namespace penumbra::slam::synthetic {

void RayCaster::render(const StereoCamera& camera, const SE3& T_wc, double time, RenderedView& view) {
  geometry_.prepare(world_, camera, T_wc, time);
  render_tiles(0, geometry_.tiles(), view);
}

void RayCaster::render_band(const StereoCamera& camera, const SE3& T_wc, double time, int band,
                            RenderedView& view) {
  geometry_.prepare(world_, camera, T_wc, time);
  render_tiles(band * geometry_.tiles_x(), (band + 1) * geometry_.tiles_x(), view);
}

void RayCaster::render_tiles(int first, int end, RenderedView& view) {
  const StereoCamera& camera = geometry_.camera();
  const Rect last = geometry_.tile_pixels(end - 1);
  first_row_ = geometry_.tile_pixels(first).y;
  end_row_ = last.y + last.height;
  pixel_ = static_cast<float>(1.0 / camera.fx);
  view.radiance.create(camera.width, camera.height);
  view.depth.create(camera.width, camera.height);
  view.instance.create(camera.width, camera.height);
  surfaces_.create(camera.width, camera.height);
  if (view.wants_reflectance) view.reflectance.create(camera.width, camera.height);
  if (view.wants_objects) view.object.create(camera.width, camera.height);
  parallel_for(end - first, 1, [&](int i) { find_surfaces(first + i, view); });
  parallel_for(end - first, 1, [&](int i) { colour(first + i, view); });
}

void RayCaster::find_surfaces(int tile, RenderedView& view) {
  const StereoCamera& camera = geometry_.camera();
  const Rect pixels = geometry_.tile_pixels(tile);
  RayBatch batch;
  for (int row = pixels.y; row < pixels.y + pixels.height; ++row) {
    const float y = static_cast<float>((row - camera.cy) / camera.fy);
    for (int i = 0; i < pixels.width; ++i) {
      batch.x[i] = static_cast<float>((pixels.x + i - camera.cx) / camera.fx);
      batch.y[i] = y;
    }
    geometry_.cast(tile, batch, pixels.width);
    for (int i = 0; i < pixels.width; ++i) {
      const int column = pixels.x + i;
      const std::int32_t surface = batch.surface[i];
      surfaces_.at(column, row) = surface;
      view.depth.at(column, row) = surface == kSky ? 0.0F : batch.depth[i];
      const std::int32_t object = surface < 0 ? -1 : geometry_.object(geometry_.body(surface)).object;
      view.instance.at(column, row) =
          object < 0 ? std::uint16_t{0} : world_.objects[static_cast<std::size_t>(object)].instance;
      if (view.wants_objects) view.object.at(column, row) = object;
    }
  }
}

// Whether a neighbour shows another surface. The crowns of one tree count as one.
bool RayCaster::is_edge(int column, int row) const {
  const std::int32_t here = surfaces_.at(column, row);
  const auto same = [&](int c, int r) {
    if (c < 0 || r < first_row_ || c >= surfaces_.width() || r >= end_row_) return true;
    const std::int32_t there = surfaces_.at(c, r);
    if (there == here) return true;
    if (there < 0 || here < 0) return false;
    const FrameBody& a = geometry_.body(here);
    const FrameBody& b = geometry_.body(there);
    return a.frame_object == b.frame_object && world_.bodies[static_cast<std::size_t>(a.body)].ragged &&
           world_.bodies[static_cast<std::size_t>(b.body)].ragged;
  };
  return !same(column - 1, row) || !same(column + 1, row) || !same(column, row - 1) || !same(column, row + 1);
}

void RayCaster::colour(int tile, RenderedView& view) const {
  const StereoCamera& camera = geometry_.camera();
  const Rect pixels = geometry_.tile_pixels(tile);
  RayBatch samples;
  for (int row = pixels.y; row < pixels.y + pixels.height; ++row) {
    for (int column = pixels.x; column < pixels.x + pixels.width; ++column) {
      Colour sum = Colour::Zero();
      Reflectance* reflectance = view.wants_reflectance ? &view.reflectance.at(column, row) : nullptr;
      if (!is_edge(column, row)) {
        const float x = static_cast<float>((column - camera.cx) / camera.fx);
        const float y = static_cast<float>((row - camera.cy) / camera.fy);
        sum = shade(x, y, view.depth.at(column, row), surfaces_.at(column, row), tile, reflectance);
      } else {
        constexpr int kSamples = 4;
        constexpr double kOffsets[kSamples][2] = {
            {-0.375, -0.125}, {0.125, -0.375}, {-0.125, 0.375}, {0.375, 0.125}};
        for (int i = 0; i < kSamples; ++i) {
          samples.x[i] = static_cast<float>((column + kOffsets[i][0] - camera.cx) / camera.fx);
          samples.y[i] = static_cast<float>((row + kOffsets[i][1] - camera.cy) / camera.fy);
        }
        geometry_.cast(tile, samples, kSamples);
        // Rays that met one surface share one look-up of its colour.
        for (int i = 0; i < kSamples; ++i) {
          int first = 0;
          while (samples.surface[first] != samples.surface[i]) ++first;
          if (first < i) continue;
          int weight = 0;
          for (int k = i; k < kSamples; ++k) weight += samples.surface[k] == samples.surface[i] ? 1 : 0;
          sum += shade(samples.x[i], samples.y[i], samples.depth[i], samples.surface[i], tile, reflectance) *
                 (static_cast<float>(weight) / kSamples);
        }
      }
      view.radiance.at(column, row) = sum;
    }
  }
}

// Share of the sun at a point of the ground (camera frame); `ambient` is lowered beside cars and other
// casters.
float RayCaster::ground_light(const Eigen::Vector3f& camera_point, int tile, float& ambient) const {
  float sun = 1.0F;
  for (const int number : geometry_.shadows(tile)) {
    const FrameObject& placed = geometry_.frame_object(number);
    const Object& object = world_.objects[static_cast<std::size_t>(placed.object)];
    const Eigen::Vector3f p = placed.local_from_camera * camera_point + placed.camera_in_local;
    // Contact: the nearer to the object's outline on the ground, the less sky is seen.
    const float out_x = std::max({object.lower.x() - p.x(), p.x() - object.upper.x(), 0.0F});
    const float out_z = std::max({object.lower.z() - p.z(), p.z() - object.upper.z(), 0.0F});
    if (object.object_class == ObjectClass::car || object.object_class == ObjectClass::truck) {
      const float distance = std::sqrt(out_x * out_x + out_z * out_z);
      const float inside = std::min(std::min(p.x() - object.lower.x(), object.upper.x() - p.x()),
                                    std::min(p.z() - object.lower.z(), object.upper.z() - p.z()));
      ambient *= distance > 0.0F ? 0.45F + 0.55F * smooth_step(0.0F, 0.6F, distance)
                                 : 0.45F - 0.35F * clamp01(inside / 0.35F);
    }
    if (sun <= 0.0F) continue;
    // Outside the box swept along the sun's rays there is nothing to test.
    float enter = 0.0F, leave = 1e9F;
    for (int axis = 0; axis < 3; ++axis) {
      const float slope = placed.sun_in_local[axis];
      const float inverse = 1.0F / (std::abs(slope) > 1e-6F ? slope : 1e-6F);
      const float t0 = (object.lower[axis] - p[axis]) * inverse,
                  t1 = (object.upper[axis] - p[axis]) * inverse;
      enter = std::max(enter, std::min(t0, t1));
      leave = std::min(leave, std::max(t0, t1));
    }
    if (enter >= leave) continue;
    for (int b = object.first_body; b < object.first_body + object.body_count; ++b) {
      const Body& body = world_.bodies[static_cast<std::size_t>(b)];
      if (!body.casts_shadow) continue;
      // The light fades in with the length of its way through the body: soft edges at no cost.
      const float length = chord(body, p, placed.sun_in_local);
      if (length > 0.0F) {
        const float softness = std::min(0.25F, 0.7F / (1e-3F + body.inverse_radii.maxCoeff()));
        const float opacity = body.ragged ? 0.75F : 1.0F;
        sun *= 1.0F - opacity * clamp01(length / (body.ragged ? 1.2F : softness));
      }
    }
  }
  return sun;
}

Colour RayCaster::shade(float x, float y, float depth, std::int32_t surface, int tile,
                        Reflectance* reflectance) const {
  const Eigen::Vector3f ray(x, y, 1.0F);
  const float ray_length = ray.norm();
  const Eigen::Matrix3f& world_from_camera = geometry_.world_from_camera();
  const Eigen::Vector3f view = world_from_camera * ray * (1.0F / ray_length);
  if (reflectance != nullptr) *reflectance = {0.0F, 0.0F, 0.0F};
  if (surface == kSky) return sky_light(world_, view, pixel_);

  SurfacePoint point;
  point.texture = world_.texture;
  Appearance look;
  Eigen::Vector3f normal;  // world frame
  float sun = 1.0F, ambient = 1.0F;
  const Eigen::Vector3f camera_point = ray * depth;
  // How far the surface point moves per pixel: dP/du = Z/f (e_x - ray n_x / (n . ray)), likewise for v.
  const auto footprint = [&](const Eigen::Matrix3f& to_frame,
                             const Eigen::Vector3f& n_camera) -> Eigen::Vector3f {
    const float slope = n_camera.dot(ray);
    const float safe = std::min(slope, -0.03F * ray_length);
    const Eigen::Vector3f du = Eigen::Vector3f::UnitX() - ray * (n_camera.x() / safe);
    const Eigen::Vector3f dv = Eigen::Vector3f::UnitY() - ray * (n_camera.y() / safe);
    return ((to_frame * du).cwiseAbs() + (to_frame * dv).cwiseAbs()) * (depth * pixel_);
  };

  if (surface == kGround) {
    normal = -Eigen::Vector3f::UnitY();
    const Eigen::Vector3f offset = world_from_camera * camera_point;
    point.position = {static_cast<float>(geometry_.camera_position().x() + static_cast<double>(offset.x())),
                      0.0F,
                      static_cast<float>(geometry_.camera_position().z() + static_cast<double>(offset.z()))};
    point.normal = normal;
    point.footprint = footprint(world_from_camera, world_from_camera.transpose() * normal);
    look = ground_appearance(world_, point);
    sun = ground_light(camera_point, tile, ambient);
  } else {
    const FrameBody& in_frame = geometry_.body(surface);
    const FrameObject& placed = geometry_.object(in_frame);
    const Body& body = world_.bodies[static_cast<std::size_t>(in_frame.body)];
    const Object& object = world_.objects[static_cast<std::size_t>(placed.object)];
    const Material& material = world_.materials[static_cast<std::size_t>(body.material)];
    const int face = surface & 15;
    point.position = placed.local_from_camera * camera_point + placed.camera_in_local;
    point.normal =
        face == kRoundFace
            ? Eigen::Vector3f(body.inverse_radii.cwiseAbs2().cwiseProduct(point.position - body.centre))
                  .normalized()
            : body.planes[static_cast<std::size_t>(face)].normal;
    const Eigen::Vector3f normal_camera = placed.local_from_camera.transpose() * point.normal;
    point.footprint = footprint(placed.local_from_camera, normal_camera);
    normal = world_from_camera * normal_camera;
    sun = object.sunlight;
    const float height = -point.position.y();
    switch (material.surface) {
      case Surface::facade:
        look = facade_appearance(material, body, point);
        break;
      case Surface::roof:
        look = roof_appearance(material, point);
        break;
      case Surface::car_body:
      case Surface::car_cabin:
        look = car_appearance(material, body, face, point);
        break;
      case Surface::lorry:
        look = lorry_appearance(material, body, point);
        break;
      case Surface::wheel:
        look = wheel_appearance(material, body, face, point);
        break;
      default:
        look = material.surface >= Surface::painted_wall ? office_appearance(material, body, face, point)
                                                         : plain_appearance(material, point);
    }
    if (world_.room) {
      if (reflectance != nullptr) *reflectance = {look.albedo.mean(), look.gloss, 0.0F};
      const Eigen::Vector3f place =
          (geometry_.camera_position() + (world_from_camera * camera_point).cast<double>()).cast<float>();
      return room_light(world_, look, place, normal, view,
                        reflectance != nullptr ? &(*reflectance)[2] : nullptr);
    }
    if (material.surface == Surface::leaves && body.round) {
      // Crowns are bright above and dark below and inside; a rough surface scatters light round its edges.
      ambient = 0.55F + 0.45F * clamp01(0.5F - 0.8F * point.normal.y());
      normal = (0.6F * normal + 0.4F * world_.to_sun).normalized();
    } else {
      ambient = 0.55F + 0.45F * clamp01(height / (material.surface == Surface::facade ? 2.0F : 0.7F));
    }
  }
  const float lambert = std::max(0.0F, normal.dot(world_.to_sun)) * sun;
  // Sky from above, light thrown back by the ground from below.
  const float up = 0.5F - 0.5F * normal.y();
  const Colour around = world_.sky_colour * (0.45F + 0.55F * up) + Colour(0.13F, 0.12F, 0.10F) * (1.0F - up);
  Colour light = look.albedo.cwiseProduct(around * ambient + world_.sun_colour * lambert);
  if (reflectance != nullptr) {
    (*reflectance)[0] = look.albedo.mean();
    (*reflectance)[2] = lambert;
  }
  if (look.gloss > 0.0F) {
    const float facing = clamp01(-normal.dot(view));
    const float grazing = 1.0F - facing;
    // Schlick's approximation, with `gloss` at normal incidence.
    const float g2 = grazing * grazing;
    const float fresnel = look.gloss + 0.6F * (1.0F - look.gloss) * g2 * g2 * grazing;
    if (reflectance != nullptr) (*reflectance)[1] = fresnel;
    const Eigen::Vector3f mirrored = view + 2.0F * facing * normal;
    // Above the horizon the sky, towards it houses, below it the road.
    const float height = -mirrored.y();
    const Colour above =
        blend(Colour(0.22F, 0.21F, 0.20F), Colour(0.62F, 0.70F, 0.82F), smooth_step(0.15F, 0.55F, height));
    const Colour seen =
        height > 0.0F ? above : blend(above, Colour(0.12F, 0.12F, 0.12F), clamp01(-4.0F * height));
    light += seen * fresnel * (0.5F + 0.5F * ambient);
    const float glint = std::max(0.0F, mirrored.dot(world_.to_sun));
    light += world_.sun_colour * (4.0F * look.gloss * std::pow(glint, 64.0F) * sun);
  }
  // Haze.
  const float haze = 1.0F - std::exp(-depth * ray_length * (1.0F / 900.0F));
  return blend(light, Colour(0.72F, 0.77F, 0.82F), haze);
}

}  // namespace penumbra::slam::synthetic
