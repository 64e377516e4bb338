#include "app/formats/splats/splats.h"
#include "app/formats/common/local_places.h"
#include "app/formats/common/ranges.h"
#include "app/formats/splats/splat_axes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace gs::app {
namespace {

// Max ratio of the smallest to the middle standard deviation for a splat that was written as a disc across its z axis.
constexpr float kFlatDisc = 1.0f / 50;

bool usable(const glm::dvec3& v) {
  return std::abs(v.x) <= kMaxCoordinate && std::abs(v.y) <= kMaxCoordinate && std::abs(v.z) <= kMaxCoordinate;
}

/// Returns the indices of the smallest, middle and largest axis. Among equal axes, z comes first.
std::array<int, 3> ordered_axes(const glm::vec3& scale) {
  std::array<int, 3> order = {2, 1, 0};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return scale[a] < scale[b]; });
  return order;
}

/// Returns column `axis` of the rotation matrix of a unit quaternion.
glm::vec3 rotated_axis(const glm::vec4& q, int axis) {
  const float x = q.x, y = q.y, z = q.z, w = q.w;
  if (axis == 0) return {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
  if (axis == 1) return {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
  return {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
}

float dot(const glm::vec3& a, const glm::vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

qnv::Rgb8 color_of(const glm::vec3& dc) {
  const auto part = [](float c) { return byte_of(std::isfinite(c) ? 0.5f + kSphericalHarmonic0 * c : 0.5f); };
  return {part(dc.x), part(dc.y), part(dc.z)};
}

/// Returns a quaternion of length 1. Returns nullopt for 0, and for numbers that are not finite.
std::optional<glm::vec4> unit_of(const glm::vec4& q) {
  const float square = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  constexpr float kLeast = 1e-20f, kMost = 1e20f;  // beyond, squares of floats lose digits or overflow
  if (square > kLeast && square < kMost) return q / std::sqrt(square);
  const glm::dvec4 wide(q);
  const double length = std::sqrt(wide.x * wide.x + wide.y * wide.y + wide.z * wide.z + wide.w * wide.w);
  if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
  return glm::vec4(wide / length);
}

/// Splat converted to a disc, or the reason why there is no disc.
struct Disc {
  enum class Fate { kept, faint, broken } fate = Fate::broken;
  glm::dvec3 place{0};
  glm::vec3 normal{0};
  glm::vec4 rotation{0};  // of length 1
  float area = 0;
  bool thick = false, flat_across_z = false;
};

Disc disc_of(const SplatModel& model, std::size_t i) {
  Disc disc;
  const glm::vec3 scale = model.scales[i];
  const std::optional<glm::vec4> rotation = unit_of(model.rotations[i]);
  if (!usable(model.positions[i]) || !usable(glm::dvec3(scale)) || !(scale.x >= 0 && scale.y >= 0 && scale.z >= 0))
    return disc;
  if (!rotation || !std::isfinite(model.opacities[i])) return disc;
  disc.rotation = *rotation;
  if (model.opacities[i] < kMinOpacity) {
    disc.fate = Disc::Fate::faint;
    return disc;
  }
  const auto [least, middle, most] = ordered_axes(scale);
  disc.area = std::numbers::pi_v<float> * scale[middle] * scale[most] / (kSigmaOfRadius * kSigmaOfRadius);
  if (!(scale[most] > 0)) return disc;
  // A line has no area, but is visible.
  disc.area = std::max(disc.area, std::numeric_limits<float>::min());
  const glm::vec3 normal = rotated_axis(disc.rotation, least);
  const float normal_length = std::sqrt(dot(normal, normal));
  if (!std::isfinite(disc.area) || !(normal_length > 0.5f)) return disc;
  disc.place = model.positions[i] * glm::dvec3(model.axes);
  disc.normal = normal * model.axes / normal_length;
  disc.thick = scale[least] > kMaxDiscThickness * scale[middle];
  disc.flat_across_z = least == 2 && scale[least] <= kFlatDisc * scale[middle];
  disc.fate = Disc::Fate::kept;
  return disc;
}

/// Returns a coefficient, or 0 if it is not finite.
glm::vec3 coefficient_of(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) ? v : glm::vec3(0);
}

/// Returns metadata text about lost opacity or spherical harmonics. Empty if the splats lose nothing.
std::string drawn_as(bool translucent, int harmonics) {
  std::string lost = translucent ? "opacity" : "";
  if (harmonics > 0)
    lost += std::string(translucent ? " and " : "") + "spherical harmonics up to degree " + std::to_string(harmonics);
  return lost.empty() ? lost : "opaque surface splats, without their " + lost;
}

void add_count(qnv::Description& description, const char* name, std::size_t count) {
  if (count > 0) description.metadata.emplace_back(name, std::to_string(count));
}

}  // namespace

std::optional<std::string> SplatModel::draw(const WorldBudget& budget, std::uint64_t count) {
  if (share.amount() == 0) share = Share(budget, Resource::vectors);
  constexpr std::uint64_t kMax = std::uint64_t{1} << 48;
  const std::uint64_t bytes =
      std::min(count, kMax) * (kSplatMemory + 2 * sizeof(glm::vec3) * qnv::harmonic_count(degree));
  if (share.grow(bytes)) return std::nullopt;
  return std::to_string(count) + " splats take " + budget->refusal(Resource::vectors);
}

void SplatModel::resize(std::size_t count) {
  positions.resize(count);
  scales.resize(count);
  rotations.resize(count);
  opacities.resize(count);
  dc.resize(count);
  coefficients.resize(count * qnv::harmonic_count(degree));
}

std::optional<std::string> SplatModel::append(const SplatModel& part, std::size_t first, std::size_t count,
                                              const WorldBudget& budget) {
  if (size() == 0 && part.harmonics > harmonics) set_degree(part.harmonics);
  if (part.degree > degree) {
    const std::size_t before = qnv::harmonic_count(degree), after = qnv::harmonic_count(part.degree);
    if (!share.grow(2 * sizeof(glm::vec3) * (after - before) * size()))
      return std::to_string(size()) + " splats take " + budget->refusal(Resource::vectors);
    std::vector<glm::vec3> wider(size() * after, glm::vec3(0));
    for (std::size_t i = 0; i < size(); ++i)
      std::copy_n(coefficients.begin() + static_cast<std::ptrdiff_t>(i * before), before,
                  wider.begin() + static_cast<std::ptrdiff_t>(i * after));
    coefficients = std::move(wider);
    set_degree(part.harmonics);
  }
  if (auto problem = draw(budget, count)) return problem;
  const std::size_t start = size();
  resize(start + count);
  antialiased = part.antialiased;
  const std::size_t per = qnv::harmonic_count(degree), held = qnv::harmonic_count(part.degree);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t from = first + i, to = start + i;
    positions[to] = part.positions[from];
    scales[to] = part.scales[from];
    rotations[to] = part.rotations[from];
    opacities[to] = part.opacities[from];
    dc[to] = part.dc[from];
    std::copy_n(part.coefficients.begin() + static_cast<std::ptrdiff_t>(from * held), held,
                coefficients.begin() + static_cast<std::ptrdiff_t>(to * per));
  }
  return std::nullopt;
}

qnv::Gaussians vectors_of_splats(const SplatModel& model) {
  qnv::Gaussians splats;
  qnv::Description& description = splats.description;
  description.two_sided = true;
  std::size_t faint = 0, broken = 0, thick = 0;
  bool all_flat = true, translucent = false;
  std::vector<bool> sided;  // true for vectors with a known outside
  std::vector<glm::dvec3> places;
  places.reserve(model.size());
  splats.normals.reserve(model.size());
  splats.weights.reserve(model.size());
  splats.colors.reserve(model.size());
  splats.scales.reserve(model.size());
  splats.rotations.reserve(model.size());
  splats.opacities.reserve(model.size());
  splats.bases.reserve(model.size());
  splats.degree = model.degree;
  splats.antialiased = model.antialiased;
  const std::size_t per = qnv::harmonic_count(model.degree);
  splats.harmonics.reserve(per * model.size());
  const std::array<float, 15> signs = harmonic_signs(model.axes);
  double area = 0;  // total of the current run
  for (std::size_t i = 0; i < model.size(); ++i) {
    if (i % kSplatRun == 0) description.total += std::exchange(area, 0.0);
    Disc disc = disc_of(model, i);
    if (disc.fate != Disc::Fate::kept) {
      ++(disc.fate == Disc::Fate::faint ? faint : broken);
      continue;
    }
    const float side = model.normals.empty() ? 0.0f : dot(model.normals[i] * model.axes, disc.normal);
    if (side < 0) disc.normal = -disc.normal;
    sided.push_back(side < 0 || side > 0);
    all_flat = all_flat && disc.flat_across_z;
    thick += disc.thick ? 1 : 0;
    translucent = translucent || model.opacities[i] < kOpaque;
    places.push_back(disc.place);
    splats.normals.push_back(disc.normal);
    splats.weights.push_back(disc.area);
    splats.colors.push_back(color_of(model.dc[i]));
    splats.scales.push_back(model.scales[i]);
    splats.rotations.push_back(turned(disc.rotation, model.axes));
    splats.opacities.push_back(std::min(model.opacities[i], 1.0f));
    splats.bases.push_back(0.5f + kSphericalHarmonic0 * coefficient_of(model.dc[i]));
    for (std::size_t k = 0; k < per; ++k)
      splats.harmonics.push_back(coefficient_of(model.coefficients[i * per + k]) * signs[k]);
    area += static_cast<double>(disc.area);
  }
  description.total += area;
  set_places(splats, places);
  if (!all_flat && !splats.empty()) {
    const glm::vec3 middle = description.box.lower + description.box.size() * 0.5f;
    for (std::size_t i = 0; i < splats.size(); ++i)
      if (!sided[i] && dot(splats.normals[i], splats.positions[i] - middle) < 0) splats.normals[i] = -splats.normals[i];
  }
  description.metadata.emplace_back("source", model.format);
  if (!splats.empty())
    if (std::string text = drawn_as(translucent, model.harmonics); !text.empty())
      description.metadata.emplace_back(kSplatsAsDiscs, std::move(text));
  add_count(description, kThickSplats, thick);
  add_count(description, "splats too faint", faint);
  add_count(description, "splats broken", broken);
  add_count(description, "splats missing", model.announced > model.size() ? model.announced - model.size() : 0);
  return splats;
}

ImportedVectors import_result(const SplatModel& model) {
  qnv::Gaussians splats = vectors_of_splats(model);
  if (splats.empty())
    return model.format + ": no visible splat (" + std::to_string(model.size()) + " read, all too faint or not finite)";
  const bool discs =
      std::ranges::none_of(splats.description.metadata,
                           [](const auto& pair) { return pair.first == kSplatsAsDiscs; }) &&
      std::ranges::all_of(splats.scales, [](const glm::vec3& s) { return s.z <= kFlatDisc * std::min(s.x, s.y); });
  if (discs) return static_cast<qnv::Splats&&>(splats);
  return splats;
}

ImportedVectors import_rows(const OpenedSplatRows& opened, const WorldBudget& budget) {
  if (const auto* const problem = std::get_if<std::string>(&opened)) return *problem;
  const SplatRows& rows = std::get<SplatRows>(opened);
  SplatModel model;
  if (auto problem = rows.read(0, rows.count, budget, model)) return std::move(*problem);
  model.announced = static_cast<std::size_t>(std::min<std::uint64_t>(rows.announced, SIZE_MAX));
  return import_result(model);
}

}  // namespace gs::app
