#include "app/formats/splats/splat_join.h"

#include <algorithm>
#include <vector>

namespace gs::app {
namespace {

/// Enlarges the harmonics to a higher degree; new coefficients are 0.
void raise_degree(qnv::Gaussians& splats, int degree) {
  if (degree <= splats.degree) return;
  const std::size_t before = qnv::harmonic_count(splats.degree), after = qnv::harmonic_count(degree);
  std::vector<glm::vec3> harmonics(splats.size() * after, glm::vec3(0));
  for (std::size_t i = 0; i < splats.size(); ++i)
    std::copy_n(splats.harmonics.begin() + static_cast<std::ptrdiff_t>(i * before), before,
                harmonics.begin() + static_cast<std::ptrdiff_t>(i * after));
  splats.harmonics = std::move(harmonics);
  splats.degree = degree;
}

template <class Value>
void join(std::vector<Value>& to, const std::vector<Value>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

template <class Value>
void copy_range(std::vector<Value>& to, const std::vector<Value>& from, std::size_t first, std::size_t count) {
  const auto begin = from.begin() + static_cast<std::ptrdiff_t>(first);
  to.assign(begin, begin + static_cast<std::ptrdiff_t>(count));
}

}  // namespace

qnv::Gaussians range_of_splats(const qnv::Gaussians& from, std::size_t first, std::size_t count) {
  qnv::Gaussians to;
  to.description = from.description;
  to.description.box = {};
  to.description.total = 0;
  to.color = from.color;
  to.degree = from.degree;
  to.antialiased = from.antialiased;
  copy_range(to.positions, from.positions, first, count);
  copy_range(to.normals, from.normals, first, count);
  copy_range(to.weights, from.weights, first, count);
  copy_range(to.colors, from.colors, first, count);
  copy_range(to.scales, from.scales, first, count);
  copy_range(to.rotations, from.rotations, first, count);
  copy_range(to.opacities, from.opacities, first, count);
  copy_range(to.bases, from.bases, first, count);
  const std::size_t per = qnv::harmonic_count(from.degree);
  copy_range(to.harmonics, from.harmonics, first * per, count * per);
  for (const glm::vec3& position : to.positions) to.description.box.add(position);
  for (const float area : to.weights) to.description.total += static_cast<double>(area);
  return to;
}

void reserve_splats(qnv::Gaussians& to, std::size_t count, int degree) {
  to.degree = degree;
  to.positions.reserve(count);
  to.normals.reserve(count);
  to.weights.reserve(count);
  to.colors.reserve(count);
  to.scales.reserve(count);
  to.rotations.reserve(count);
  to.opacities.reserve(count);
  to.bases.reserve(count);
  to.harmonics.reserve(count * qnv::harmonic_count(degree));
}

void append_splats(qnv::Gaussians& to, const qnv::Gaussians& from) {
  if (from.empty()) return;
  qnv::Description& description = to.description;
  if (to.empty()) {
    const double total = description.total;
    description = from.description;
    description.box = {};
    description.total = total;
    to.antialiased = from.antialiased;
  }
  raise_degree(to, from.degree);
  const glm::dvec3 offset = from.description.origin - description.origin;
  for (const glm::vec3& position : from.positions) {
    to.positions.push_back(offset == glm::dvec3(0) ? position : glm::vec3(glm::dvec3(position) + offset));
    description.box.add(to.positions.back());
  }
  join(to.normals, from.normals);
  join(to.weights, from.weights);
  join(to.colors, from.colors);
  join(to.scales, from.scales);
  join(to.rotations, from.rotations);
  join(to.opacities, from.opacities);
  join(to.bases, from.bases);
  const std::size_t held = qnv::harmonic_count(from.degree), per = qnv::harmonic_count(to.degree);
  if (held == per) {
    join(to.harmonics, from.harmonics);
  } else {
    for (std::size_t i = 0; i < from.size(); ++i) {
      const auto first = from.harmonics.begin() + static_cast<std::ptrdiff_t>(i * held);
      to.harmonics.insert(to.harmonics.end(), first, first + static_cast<std::ptrdiff_t>(held));
      to.harmonics.resize(to.harmonics.size() + per - held, glm::vec3(0));
    }
  }
  description.total += from.description.total;
}

}  // namespace gs::app
