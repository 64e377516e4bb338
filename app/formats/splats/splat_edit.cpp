#include "app/formats/splats/splat_edit.h"

#include "app/formats/common/local_places.h"
#include "app/formats/common/ranges.h"
#include "app/formats/splats/splat_transform.h"
#include "base/parallel.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kEditedRange = 16384;  // splats per task
// Exponent of the display. The exposure multiplies linear light, but colours are stored with this exponent.
constexpr double kDisplayGamma = 2.2;

enum class SplatFate : std::uint8_t { kept, cropped, faint, large, far };

bool is_inside(const SplatBox& box, const glm::dvec3& place) {
  return glm::all(glm::greaterThanEqual(place, box.lower)) && glm::all(glm::lessThanEqual(place, box.upper));
}
bool is_inside(const SplatBall& ball, const glm::dvec3& place) {
  return glm::distance(place, ball.center) <= ball.radius;
}

bool is_cropped(const SplatEdit& edit, const glm::dvec3& place) {
  bool is_kept = false, some_keep = false;
  for (const SplatCrop& crop : edit.crops) {
    const bool inside = std::visit([&](const auto& shape) { return is_inside(shape, place); }, crop.shape);
    if (inside && crop.removes) return true;
    is_kept = is_kept || inside;
    some_keep = some_keep || !crop.removes;
  }
  return some_keep && !is_kept;
}

bool edited_in_range(const glm::dvec3& v) {
  return std::abs(v.x) <= kMaxCoordinate && std::abs(v.y) <= kMaxCoordinate && std::abs(v.z) <= kMaxCoordinate;
}

SplatFate fate_of(const SplatEdit& edit, const glm::dmat4& matrix, const qnv::Gaussians& splats, std::size_t i) {
  const glm::dvec3 place = splats.description.origin + glm::dvec3(splats.positions[i]);
  if (is_cropped(edit, place)) return SplatFate::cropped;
  if (static_cast<double>(splats.opacities[i]) < edit.least_opacity) return SplatFate::faint;
  const glm::vec3& scales = splats.scales[i];
  const double size = static_cast<double>(std::max({scales.x, scales.y, scales.z}));
  if (edit.most_size > 0 && size > edit.most_size) return SplatFate::large;
  const double area = static_cast<double>(splats.weights[i]) * edit.scale * edit.scale;
  const bool fits = edited_in_range(glm::dvec3(matrix * glm::dvec4(place, 1))) && size * edit.scale <= kMaxCoordinate &&
                    area <= static_cast<double>(std::numeric_limits<float>::max());
  return fits ? SplatFate::kept : SplatFate::far;
}

/// Calls `work` with each range of indices below `count`, on several threads.
void for_ranges(std::size_t count, const std::function<void(std::size_t, std::size_t)>& work) {
  parallel_for((count + kEditedRange - 1) / kEditedRange,
               [&](std::size_t range) { work(range * kEditedRange, std::min(count, (range + 1) * kEditedRange)); });
}

template <class Value>
void keep_splats(std::vector<Value>& values, std::span<const std::uint32_t> kept, std::size_t per = 1) {
  if (values.empty()) return;
  std::size_t to = 0;
  for (const std::uint32_t i : kept)
    for (std::size_t k = 0; k < per; ++k) values[to++] = values[i * per + k];
  values.resize(to);
}

void keep_splats(qnv::Gaussians& splats, std::span<const std::uint32_t> kept) {
  keep_splats(splats.positions, kept);
  keep_splats(splats.normals, kept);
  keep_splats(splats.weights, kept);
  keep_splats(splats.colors, kept);
  keep_splats(splats.cells, kept);
  keep_splats(splats.scales, kept);
  keep_splats(splats.rotations, kept);
  keep_splats(splats.opacities, kept);
  keep_splats(splats.bases, kept);
  keep_splats(splats.harmonics, kept, qnv::harmonic_count(splats.degree));
}

SplatsRemoved remove_splats(qnv::Gaussians& splats, const SplatEdit& edit, const glm::dmat4& matrix) {
  SplatsRemoved removed;
  removed.before = splats.size();
  std::vector<SplatFate> fates(splats.size());
  for_ranges(splats.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) fates[i] = fate_of(edit, matrix, splats, i);
  });
  std::vector<std::uint32_t> kept;
  kept.reserve(splats.size());
  for (std::size_t i = 0; i < fates.size(); ++i) {
    if (fates[i] == SplatFate::kept) kept.push_back(static_cast<std::uint32_t>(i));
    if (fates[i] == SplatFate::cropped) ++removed.cropped;
    if (fates[i] == SplatFate::faint) ++removed.faint;
    if (fates[i] == SplatFate::large) ++removed.large;
    if (fates[i] == SplatFate::far) ++removed.far;
  }
  if (removed.all() > 0) keep_splats(splats, kept);
  return removed;
}

void transform_splats(qnv::Gaussians& splats, const SplatEdit& edit, const glm::dmat4& matrix) {
  const SplatTransform transform{glm::mat3(glm::dmat3(matrix))};
  const glm::mat3 turn(glm::dmat3(matrix) / edit.scale);
  const std::size_t per = qnv::harmonic_count(splats.degree);
  const bool turns = edit.turn != glm::dvec3(0);
  const auto area = static_cast<float>(edit.scale * edit.scale);
  std::vector<glm::dvec3> places(splats.size());
  for_ranges(splats.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const glm::dvec3 place = splats.description.origin + glm::dvec3(splats.positions[i]);
      places[i] = glm::dvec3(matrix * glm::dvec4(place, 1));
      splats.weights[i] = std::max(splats.weights[i] * area, std::numeric_limits<float>::min());
      splats.normals[i] = glm::normalize(turn * splats.normals[i]);
      transform.apply(splats.scales[i], splats.rotations[i]);
      if (turns && per > 0) transform.apply(std::span(splats.harmonics).subspan(i * per, per));
    }
  });
  for (qnv::Cell& cell : splats.cells) {
    cell.edge *= static_cast<float>(edit.scale);
    cell.offset *= static_cast<float>(edit.scale);
  }
  splats.positions.clear();
  splats.description.box = {};
  set_places(splats, places);
}

void expose_splats(qnv::Gaussians& splats, double exposure) {
  const auto factor = static_cast<float>(std::exp2(exposure / kDisplayGamma));
  for (glm::vec3& base : splats.bases) base *= factor;
  for (glm::vec3& coefficient : splats.harmonics) coefficient *= factor;
  if (splats.colors.empty()) splats.colors.resize(splats.size(), splats.color);
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const glm::vec3& base = splats.bases[i];
    splats.colors[i] = {byte_of(base.x), byte_of(base.y), byte_of(base.z)};
  }
}

/// Returns the shortest text that parses to the same number.
std::string option_text(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value == 0 ? 0.0 : value);
  return {text, end.ptr};
}

std::string option_text(const glm::dvec3& v) {
  return option_text(v.x) + "," + option_text(v.y) + "," + option_text(v.z);
}

}  // namespace

glm::dmat4 matrix_of(const SplatEdit& edit) {
  glm::dmat4 matrix = glm::translate(glm::dmat4(1), edit.move);
  matrix = glm::rotate(matrix, glm::radians(edit.turn.z), glm::dvec3(0, 0, 1));
  matrix = glm::rotate(matrix, glm::radians(edit.turn.y), glm::dvec3(0, 1, 0));
  matrix = glm::rotate(matrix, glm::radians(edit.turn.x), glm::dvec3(1, 0, 0));
  return glm::scale(matrix, glm::dvec3(edit.scale));
}

SplatsRemoved edit_splats(qnv::Gaussians& splats, const SplatEdit& edit) {
  const glm::dmat4 matrix = matrix_of(edit);
  const SplatsRemoved removed = remove_splats(splats, edit, matrix);
  if (edit.scale != 1 || edit.turn != glm::dvec3(0) || edit.move != glm::dvec3(0)) {
    transform_splats(splats, edit, matrix);
  } else if (removed.all() > 0) {
    splats.description.box = {};
    for (const glm::vec3& position : splats.positions) splats.description.box.add(position);
  }
  if (edit.exposure != 0) expose_splats(splats, edit.exposure);
  splats.description.total = 0;
  for (const float area : splats.weights) splats.description.total += static_cast<double>(area);
  return removed;
}

std::vector<std::string> messages_of(const SplatsRemoved& removed) {
  std::vector<std::string> messages;
  const std::string of = " of " + std::to_string(removed.before) + " splats ";
  const auto add = [&](std::size_t count, const char* reason) {
    if (count > 0) messages.push_back(std::to_string(count) + of + reason);
  };
  add(removed.cropped, "are cropped");
  add(removed.faint, "have less than the minimum opacity and are removed");
  add(removed.large, "exceed the maximum size and are removed");
  add(removed.far, "leave the range of coordinates and are removed");
  return messages;
}

std::vector<std::string> options_of(const SplatEdit& edit) {
  std::vector<std::string> options;
  const auto add = [&](const char* name, std::string value) {
    options.insert(options.end(), {name, std::move(value)});
  };
  for (const SplatCrop& crop : edit.crops) {
    if (const auto* const box = std::get_if<SplatBox>(&crop.shape))
      add(crop.removes ? "--remove-box" : "--crop-box", option_text(box->lower) + "," + option_text(box->upper));
    else if (const auto* const ball = std::get_if<SplatBall>(&crop.shape))
      add(crop.removes ? "--remove-sphere" : "--crop-sphere",
          option_text(ball->center) + "," + option_text(ball->radius));
  }
  if (edit.least_opacity > 0) add("--min-opacity", option_text(edit.least_opacity));
  if (edit.most_size > 0) add("--max-splat-size", option_text(edit.most_size));
  if (edit.scale != 1) add("--scale", option_text(edit.scale));
  if (edit.turn != glm::dvec3(0)) add("--turn", option_text(edit.turn));
  if (edit.move != glm::dvec3(0)) add("--move", option_text(edit.move));
  if (edit.exposure != 0) add("--exposure", option_text(edit.exposure));
  return options;
}

}  // namespace gs::app
