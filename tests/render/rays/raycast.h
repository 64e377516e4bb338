#pragma once

#include "base/parallel.h"
#include "render/splat/software/splat_constants.h"
#include "render/splat/software/splat_raster.h"
#include "render/volume/volume_model.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

namespace gs::render {

/// Result of casting a ray per pixel of the viewport, rows from the bottom.
struct RayImage {
  int width = 0, height = 0;
  std::vector<glm::vec4> color;  // RGBA 0..1, premultiplied
  std::vector<float> depth;      // along the view axis, camera units; 0 means no hit

  [[nodiscard]] bool empty() const { return color.empty(); }
};

/// Result of casting rays at a surface, rows from the bottom.
struct RaySurface {
  int width = 0, height = 0;
  std::vector<glm::vec4> normal;  // camera space, unit; w is the covered fraction of the pixel's samples
  std::vector<glm::vec4> color;   // RGB 0..1
  std::vector<float> depth;       // along the view axis, camera units, of the nearest sample; 0 means no hit

  [[nodiscard]] bool empty() const { return normal.empty(); }
};

namespace exact {

using glm::dvec2;
using glm::dvec3;

// Shared constants of the splatters, in double precision.
inline constexpr double kCubeMargin = double{splat::kCubeMargin}, kSampleMargin = double{splat::kSampleMargin},
                        kBackMargin = double{splat::kBackMargin}, kCubeBell = double{splat::kCubeBell},
                        kDiscCover = double{splat::kDiscCover}, kDiscBell = double{splat::kDiscBell},
                        kMinReach = double{splat::kMinReach}, kGrazing = double{splat::kGrazing},
                        kSmoothing = double{splat::kSmoothing};

struct Lens {
  glm::dmat4 camera_from_node;
  glm::dmat3 linear, inverse;
  double determinant;
  dvec2 tangents, center;
  int width, height;  // samples

  /// Returns the ray in camera space, at depth 1.
  [[nodiscard]] dvec3 ray(int x, int y) const {
    return {((x + 0.5) / width * 2 - 1) * tangents.x + center.x, ((y + 0.5) / height * 2 - 1) * tangents.y + center.y,
            -1};
  }
};

inline std::optional<Lens> lens_of(const SplatView& view, int supersample) {
  Lens lens{};
  lens.camera_from_node = view.camera_from_node;
  lens.linear = glm::dmat3(lens.camera_from_node);
  lens.determinant = glm::determinant(lens.linear);
  if (!(std::abs(lens.determinant) > 1e-30) || !std::isfinite(lens.determinant)) return std::nullopt;
  if (view.width < 1 || view.height < 1 || !(view.tangents.x > 0 && view.tangents.y > 0)) return std::nullopt;
  lens.inverse = glm::inverse(lens.linear);
  lens.tangents = view.tangents;
  lens.center = view.center;
  lens.width = view.width * supersample;
  lens.height = view.height * supersample;
  return lens;
}

struct Vector {
  dvec3 place;  // camera space
  dvec3 color;
  double alpha, area;
};

/// Returns the vectors in front of the camera, nearest first.
inline std::vector<Vector> vectors_of(const qnv::Volume& geometry, const SplatView& view, const Lens& lens,
                                      const VolumeOptions& options) {
  std::vector<Vector> vectors;
  const VolumeModel model = volume_model(geometry, view.threads);
  const double scale = std::cbrt(std::abs(lens.determinant));
  const double pixels2 = lens.width / (2 * lens.tangents.x) * lens.height / (2 * lens.tangents.y);  // at depth 1
  const glm::dmat3 normal_matrix = glm::transpose(lens.inverse);
  for (std::size_t k = 0; k < model.spacing.size(); ++k) {
    Vector v{};
    v.alpha = static_cast<double>(volume_alpha(geometry, model, options, k));
    v.place = dvec3(lens.camera_from_node * glm::dvec4(geometry.positions[k], 1));
    const double depth = -v.place.z, spacing = static_cast<double>(model.spacing[k]) * scale;
    if (!(v.alpha > 0 && depth > static_cast<double>(view.near_plane) && depth > spacing)) continue;
    if (!std::isfinite(v.place.x) || !std::isfinite(v.place.y) || !std::isfinite(depth)) continue;
    v.area = static_cast<double>(kVolumeFootprint) * spacing * spacing;
    const double least = static_cast<double>(kVolumePixel) * depth * depth / pixels2;
    if (v.area < least) {
      v.alpha *= v.area / least;
      v.area = least;
    }
    if (!(v.area > 0)) continue;
    v.color = volume_shade(options, volume_color(geometry, model, options, k), glm::vec3(v.place),
                           glm::vec3(normal_matrix * dvec3(geometry.normals[k])));
    vectors.push_back(v);
  }
  std::stable_sort(vectors.begin(), vectors.end(),
                   [](const Vector& a, const Vector& b) { return -a.place.z < -b.place.z; });
  return vectors;
}

inline double alpha_at(const Vector& v, const dvec3& ray) {
  const dvec3 away = ray * -v.place.z - v.place;
  const double exponent = glm::dot(away, away) / v.area;
  return exponent > 60 ? 0 : v.alpha * std::exp(-exponent);  // below 1e-26, no float changes
}

struct Disc {
  dvec3 place, normal;  // node space, relative to the camera
  dvec3 clip;           // centre of the cube or of the disc
  double plane, reach, bell;
  bool cube;
  dvec3 color;

  [[nodiscard]] bool covers(const dvec3& p) const {
    const dvec3 d = p - clip;
    if (cube) return std::abs(d.x) < reach && std::abs(d.y) < reach && std::abs(d.z) < reach;
    return glm::dot(d, d) < reach * reach;
  }
};

inline std::vector<Disc> discs_of(const qnv::Splats& geometry, const Lens& lens, const dvec3& eye) {
  std::vector<Disc> discs;
  const double step = 2 * std::max(lens.tangents.x / lens.width, lens.tangents.y / lens.height);
  double scale = 0;
  for (int i = 0; i < 3; ++i) scale = std::max(scale, glm::length(lens.linear[i]));
  for (std::size_t k = 0; k < geometry.size(); ++k) {
    Disc d{};
    d.place = dvec3(geometry.positions[k]) - eye;
    d.normal = geometry.normals[k];
    d.plane = glm::dot(d.normal, d.place);
    if (d.plane > 0 && !geometry.description.two_sided) continue;
    if (!(d.plane * d.plane > kGrazing * kGrazing * glm::dot(d.place, d.place))) continue;
    const double depth = -(lens.linear * d.place).z, sample = depth * step / scale;
    const double radius = std::sqrt(static_cast<double>(geometry.weights[k]) / std::numbers::pi);
    d.cube = !geometry.cells.empty() && geometry.cells[k].edge > 0;
    if (d.cube) {
      const auto edge = static_cast<double>(geometry.cells[k].edge);
      d.clip = d.place - d.normal * static_cast<double>(geometry.cells[k].offset);
      const double margin = d.plane > 0 ? edge * kBackMargin : std::max(edge * kCubeMargin, sample * kSampleMargin);
      d.reach = std::max(edge * 0.5 + margin, sample * kMinReach);
      d.bell = std::max({radius * kCubeBell, 0.5 * edge, sample * kMinReach});
    } else {
      d.clip = d.place;
      d.reach = std::max(radius * kDiscCover, sample * kMinReach);
      d.bell = std::max(radius * kDiscBell, sample * kMinReach);
      d.cube = !geometry.cells.empty();
    }
    const qnv::Rgb8& c = geometry.colors.empty() ? geometry.color : geometry.colors[k];
    d.color = dvec3(c.r, c.g, c.b) / 255.0;
    if (std::isfinite(d.bell) && d.bell > 0) discs.push_back(d);
  }
  return discs;
}

struct Sample {
  double depth = 0;  // 0 means no hit
  dvec3 normal{0}, color{0};
};

/// `ray` is in node space.
inline Sample sample_of(const std::vector<Disc>& discs, const dvec3& ray, double near_plane, bool smooth) {
  Sample sample;
  double side = 0;
  for (const Disc& d : discs) {
    const double depth = d.plane / glm::dot(d.normal, ray);
    if (!(depth > near_plane) || (sample.depth > 0 && !(depth < sample.depth)) || !d.covers(ray * depth)) continue;
    sample.depth = depth;
    side = d.plane;
  }
  if (!(sample.depth > 0)) return sample;
  double weight = 0, height = 0;
  dvec3 normal(0), slope(0), tilt(0);
  for (const Disc& d : discs) {
    const dvec3 away = ray * sample.depth - d.place;
    const double base = 1 - glm::dot(away, away) / (4 * d.bell * d.bell);
    if (!(base > 0) || !(d.plane * side > 0)) continue;
    const double bell = std::pow(base, 4), above = glm::dot(away, d.normal);
    const dvec3 bell_slope = away * (-2 * std::pow(base, 3) / (d.bell * d.bell));
    weight += bell;
    normal += bell * d.normal;
    sample.color += bell * d.color;
    height += bell * above;
    slope += bell_slope;
    tilt += bell_slope * above;
  }
  if (!(weight > 0)) return {};
  if (smooth) normal += kSmoothing * (tilt - slope * (height / weight));
  sample.normal = side > 0 ? -normal : normal;
  sample.color /= weight;
  return sample;
}

}  // namespace exact

/// Evaluates equation (1) of the paper for a volume, exactly and slowly. For each pixel's ray it sums over all vectors
/// in double precision, for the model of volume_model.h. Footprints are unbounded, and only vectors that the model
/// excludes are skipped. This is the reference for rasterize_volumes(). The depth is that of the vector at which the
/// opacity from the front reaches 0.5; 0 if it never does.
///
/// Takes time proportional to pixels times vectors. Thread-safe; accepts any numbers. Empty if nothing is in view.
inline RayImage raycast_volume(const qnv::Volume& geometry, const SplatView& view, const VolumeOptions& options) {
  RayImage image;
  const auto lens = exact::lens_of(view, 1);
  if (!lens) return image;
  const std::vector<exact::Vector> vectors = exact::vectors_of(geometry, view, *lens, options);
  if (vectors.empty()) return image;
  image.width = view.width;
  image.height = view.height;
  const auto columns = static_cast<std::size_t>(view.width), rows = static_cast<std::size_t>(view.height);
  image.color.assign(columns * rows, glm::vec4(0));
  image.depth.assign(columns * rows, 0);
  const auto cast_row = [&](std::size_t row) {
    for (std::size_t column = 0; column < columns; ++column) {
      const glm::dvec3 ray = lens->ray(static_cast<int>(column), static_cast<int>(row));
      // In equation (1), k = 0 is the farthest; here the nearest comes first, and `clear` is the product.
      double clear = 1, depth = 0;
      glm::dvec3 color(0);
      for (const exact::Vector& v : vectors) {
        const double alpha = exact::alpha_at(v, ray);
        color += v.color * (alpha * clear);
        if (clear > 0.5 && clear * (1 - alpha) <= 0.5) depth = -v.place.z;
        clear *= 1 - alpha;
      }
      image.color[row * columns + column] = glm::vec4(color, 1 - clear);
      image.depth[row * columns + column] = static_cast<float>(depth);
    }
  };
  parallel_for(rows, cast_row, view.threads);
  return image;
}

/// Implements the definition of rasterize_surface, exactly and slowly, in double precision.
///
/// For each sample's ray, it finds the nearest splat that covers the ray's intersection with its plane. A splat from an
/// octree covers its cube plus a margin on each side: kCubeMargin of the edge (kBackMargin if its back is visible), or
/// kSampleMargin samples. Any other splat covers kDiscCover times its radius; if the splats have cubes, it covers a
/// cube of that half edge. All splats cover at least kMinReach samples. Back-facing splats count only if the splats are
/// two-sided. Splats seen edge-on, up to a cosine of kGrazing, never count. splat_constants.h defines the constants.
///
/// At that point p, normals and colours are weighted means over all splats that show the same side. The weights are
/// bells (1 - |p - x_k|^2 / (4 R_k^2))^4. These approximate the paper's exp(-|p - x_k|^2 / A_k) with A_k = 0.83 R_k^2
/// and are zero beyond two R_k. R_k is kDiscBell times the splat's radius; for cubes it is kCubeBell times the radius,
/// at least half the edge; for both at least kMinReach samples.
///
/// With `smooth`, kSmoothing times the slope of the blended surface is added to the normal. That surface is the zero
/// set of the weighted mean height over the splats' planes. rasterize_surface does so if measure_surface says so.
///
/// Takes time proportional to samples times splats. Thread-safe; accepts any numbers. The result is empty if the splats
/// or the view are.
inline RaySurface raycast_surface(const qnv::Splats& geometry, const SplatView& view, bool smooth) {
  RaySurface image;
  const int s = std::max(view.supersample, 1);
  const auto lens = exact::lens_of(view, s);
  if (!lens || geometry.empty()) return image;
  const glm::dvec3 eye = -(lens->inverse * glm::dvec3(lens->camera_from_node[3]));
  const std::vector<exact::Disc> discs = exact::discs_of(geometry, *lens, eye);
  image.width = view.width;
  image.height = view.height;
  const auto columns = static_cast<std::size_t>(view.width), rows = static_cast<std::size_t>(view.height);
  image.normal.assign(columns * rows, glm::vec4(0));
  image.color.assign(columns * rows, glm::vec4(0));
  image.depth.assign(columns * rows, 0);
  const glm::dmat3 normal_matrix = glm::transpose(lens->inverse);
  const auto cast = [&](int x, int y) {
    double depth = 0;
    int covered = 0;
    glm::dvec3 normal(0), color(0);
    for (int i = 0; i < s * s; ++i) {
      const glm::dvec3 ray = lens->inverse * lens->ray(x * s + i % s, y * s + i / s);
      const exact::Sample sample = exact::sample_of(discs, ray, static_cast<double>(view.near_plane), smooth);
      if (!(sample.depth > 0)) continue;
      depth = covered == 0 ? sample.depth : std::min(depth, sample.depth);
      ++covered;
      color += sample.color;
      const glm::dvec3 n = normal_matrix * sample.normal;
      const double length = glm::length(n);
      if (length > 0) normal += n / length;
    }
    if (covered == 0) return;
    const std::size_t at = static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x);
    const double length = glm::length(normal);
    image.normal[at] =
        glm::vec4(length > 0 ? normal / length : glm::dvec3(0, 0, 1), static_cast<double>(covered) / (s * s));
    image.color[at] = glm::vec4(color / static_cast<double>(covered), 1);
    image.depth[at] = static_cast<float>(depth);
  };
  parallel_for(
      rows,
      [&](std::size_t row) {
        for (int x = 0; x < view.width; ++x) cast(x, static_cast<int>(row));
      },
      view.threads);
  return image;
}

}  // namespace gs::render
