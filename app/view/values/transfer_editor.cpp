#include "app/view/values/transfer_editor.h"

#include "qnv/sampling/volume/gradients.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gs::app {
namespace {

constexpr std::size_t kSample = 65536;  // max vectors in the sample of magnitudes
constexpr float kAligned = 0.99999f;    // min cosine between the normal of a plane and an axis that count as parallel

/// Clamps to 0..1; NaN becomes 0.
float unit(float v) { return v > 0 ? std::min(v, 1.0f) : 0.0f; }

std::uint8_t mix(std::uint8_t from, std::uint8_t to, float part) {
  return static_cast<std::uint8_t>(std::lround(static_cast<float>(from) + part * (static_cast<float>(to) - from)));
}

/// Converter from Hounsfield units (water is 0, air -1000) to 0..1 of a range of values.
class Hounsfield {
 public:
  explicit Hounsfield(std::pair<float, float> range) {
    const auto [least, most] = range;
    const bool units = least <= -500 && most >= 500, above = least >= -50 && most >= 1500 && most <= 8000;
    if (units || above) {
      start_ = least - (units ? 0.0f : 1000.0f);
      width_ = most - least;
    }
  }
  [[nodiscard]] float operator()(float value) const { return unit((value - start_) / width_); }

 private:
  float start_ = -1000, width_ = 3000;
};

Transfer at_units(std::pair<float, float> range, std::initializer_list<qnv::TransferPoint> points) {
  const Hounsfield place(range);
  Transfer transfer(points);
  for (qnv::TransferPoint& point : transfer) point.value = place(point.value);
  return sound_transfer(std::move(transfer));
}

Transfer bone(std::pair<float, float> range) {
  return at_units(range, {{-1000, {70, 40, 30}, 0},
                          {120, {150, 80, 55}, 0},
                          {280, {214, 160, 110}, 0.25f},
                          {600, {240, 220, 180}, 0.85f},
                          {2000, {255, 252, 244}, 0.98f}});
}

Transfer soft_tissue(std::pair<float, float> range) {
  return at_units(range, {{-1000, {60, 30, 20}, 0},
                          {-600, {140, 80, 60}, 0},
                          {-250, {222, 158, 126}, 0.3f},
                          {100, {226, 150, 118}, 0.45f},
                          {220, {205, 120, 90}, 0.05f},
                          {500, {245, 232, 205}, 0.12f},
                          {2000, {255, 255, 255}, 0.5f}});
}

Transfer lung(std::pair<float, float> range) {
  return at_units(range, {{-1000, {40, 20, 60}, 0},
                          {-940, {90, 40, 110}, 0},
                          {-800, {200, 110, 140}, 0.3f},
                          {-500, {250, 190, 180}, 0.5f},
                          {-250, {230, 160, 140}, 0.05f},
                          {200, {240, 225, 200}, 0},
                          {700, {255, 250, 240}, 0.2f}});
}

Transfer grey(std::pair<float, float>) { return {{0, {0, 0, 0}, 0}, {1, {255, 255, 255}, 0.9f}}; }

Transfer rainbow(std::pair<float, float>) {
  return {{0, {20, 20, 160}, 0},        {0.2f, {0, 90, 255}, 0.05f}, {0.4f, {0, 220, 210}, 0.15f},
          {0.6f, {70, 220, 50}, 0.35f}, {0.8f, {255, 210, 0}, 0.6f}, {1, {255, 40, 20}, 0.9f}};
}

constexpr std::array<TransferPreset, 5> kPresets{{
    {"CT bone", "Bones in computed tomography; skin and air are transparent", &bone},
    {"CT soft tissue", "Skin and muscle in computed tomography, with faint bones", &soft_tissue},
    {"CT lung", "Lungs and airways in computed tomography, with faint bones", &lung},
    {"Grey", "Transparent black to opaque white", &grey},
    {"Rainbow", "Transparent blue to opaque red", &rainbow},
}};

/// Returns the minimum and maximum of the bounds along a direction.
std::pair<double, double> extent(const glm::dvec3& direction, const WideBox& bounds) {
  if (bounds.empty()) return {-1.0, 1.0};
  double least = 0, most = 0;
  for (int i = 0; i < 3; ++i) {
    const double a = direction[i] * bounds.lower[i], b = direction[i] * bounds.upper[i];
    least += std::min(a, b);
    most += std::max(a, b);
  }
  return {least, most};
}

glm::vec3 direction_of(const ClipChoice& choice) {
  if (choice.axis == ClipAxis::view) {
    const float length = std::sqrt(glm::dot(choice.view, choice.view));
    return length > 0 && std::isfinite(length) ? choice.view / length : glm::vec3(0, 0, -1);
  }
  glm::vec3 direction(0);
  direction[static_cast<int>(choice.axis)] = choice.flip ? -1.0f : 1.0f;
  return direction;
}

}  // namespace

Transfer sound_transfer(Transfer points) {
  std::erase_if(points,
                [](const qnv::TransferPoint& p) { return !std::isfinite(p.value) || !std::isfinite(p.opacity); });
  for (qnv::TransferPoint& point : points) {
    point.value = unit(point.value);
    point.opacity = unit(point.opacity);
  }
  std::stable_sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  if (points.empty()) points.push_back({});
  if (points.size() <= kMaxTransferPoints) return points;
  Transfer some;
  for (std::size_t i = 0; i < kMaxTransferPoints; ++i) {
    const auto value = static_cast<float>(i) / static_cast<float>(kMaxTransferPoints - 1);
    some.push_back(transfer_at(points, value));
  }
  return some;
}

Transfer own_transfer(const qnv::Description& volume) {
  return sound_transfer(volume.transfer.empty()
                            ? qnv::default_transfer(volume.value_range.first, volume.value_range.second)
                            : volume.transfer);
}

qnv::TransferPoint transfer_at(const Transfer& transfer, float value) {
  value = unit(value);
  if (transfer.empty()) return {value, {}, 0};
  std::size_t next = 0;
  while (next < transfer.size() && transfer[next].value < value) ++next;
  qnv::TransferPoint at = transfer[std::min(next, transfer.size() - 1)];
  if (next > 0 && next < transfer.size()) {
    const qnv::TransferPoint &from = transfer[next - 1], &to = transfer[next];
    const float width = to.value - from.value, part = width > 0 ? (value - from.value) / width : 1;
    at.opacity = from.opacity + part * (to.opacity - from.opacity);
    at.color = {mix(from.color.r, to.color.r, part), mix(from.color.g, to.color.g, part),
                mix(from.color.b, to.color.b, part)};
  }
  at.value = value;
  return at;
}

std::optional<std::size_t> add_point(Transfer& transfer, float value, float opacity) {
  if (transfer.size() >= kMaxTransferPoints) return std::nullopt;
  qnv::TransferPoint point = transfer_at(transfer, value);
  point.opacity = unit(opacity);
  const auto place = std::upper_bound(transfer.begin(), transfer.end(), point.value,
                                      [](float v, const qnv::TransferPoint& p) { return v < p.value; });
  const auto index = static_cast<std::size_t>(place - transfer.begin());
  transfer.insert(place, point);
  return index;
}

void move_point(Transfer& transfer, std::size_t index, float value, float opacity) {
  if (index >= transfer.size()) return;
  const float least = index > 0 ? transfer[index - 1].value : 0.0f;
  const float most = index + 1 < transfer.size() ? transfer[index + 1].value : 1.0f;
  transfer[index].value = std::clamp(unit(value), least, most);
  transfer[index].opacity = unit(opacity);
}

bool stretch(Transfer& transfer, float first, float last) {
  if (transfer.empty() || !(transfer.back().value > transfer.front().value) || !(first < last)) return false;
  const float from = transfer.front().value, scale = (last - first) / (transfer.back().value - from);
  for (qnv::TransferPoint& point : transfer) point.value = unit(first + (point.value - from) * scale);
  transfer.back().value = unit(last);
  return true;
}

bool remove_point(Transfer& transfer, std::size_t index) {
  if (index >= transfer.size() || transfer.size() == 1) return false;
  transfer.erase(transfer.begin() + static_cast<std::ptrdiff_t>(index));
  return true;
}

std::span<const TransferPreset> transfer_presets() { return kPresets; }

VolumeSummary summarize(std::span<const std::shared_ptr<const qnv::Volume>> volumes) {
  VolumeSummary summary;
  std::array<double, 256> sums{};
  std::size_t all = 0;
  for (const auto& volume : volumes) all += volume ? volume->weights.size() : 0;
  const std::size_t step = all / kSample + 1;
  std::size_t next = 0;
  for (const auto& volume : volumes) {
    if (!volume) continue;
    const bool classed = volume->classes.size() == volume->weights.size();
    for (std::size_t i = 0; i < volume->weights.size(); ++i) {
      const float weight = volume->weights[i];
      const bool chosen = next++ % step == 0;
      if (!(weight > 0) || !std::isfinite(weight)) continue;
      sums[classed ? volume->classes[i] : 255u] += static_cast<double>(weight);
      if (chosen) summary.magnitudes.push_back(weight);
    }
  }
  std::sort(summary.magnitudes.begin(), summary.magnitudes.end());
  const double most = *std::max_element(sums.begin(), sums.end());
  if (most > 0)
    for (std::size_t i = 0; i < sums.size(); ++i) summary.classes[i] = static_cast<float>(sums[i] / most);
  return summary;
}

float share_left(const VolumeSummary& summary, float least_magnitude) {
  const auto& all = summary.magnitudes;
  if (all.empty()) return 0;
  const auto first = std::lower_bound(all.begin(), all.end(), least_magnitude);
  return static_cast<float>(all.end() - first) / static_cast<float>(all.size());
}

float LogScale::value_at(float place) const {
  if (zero && !(place > 0)) return 0;
  return least * std::pow(largest / least, unit(place));
}

float LogScale::place_of(float value) const {
  if (!(value > least)) return 0;
  return unit(std::log(value / least) / std::log(largest / least));
}

LogScale opacity_scale() { return {0.05f, 80, false}; }

LogScale magnitude_scale(const VolumeSummary& summary) {
  LogScale scale{summary.least(), summary.largest(), true};
  if (!(scale.largest > 0)) scale.largest = 1;
  // Keep some range if all magnitudes are equal. Limit a very wide range, because the smallest magnitudes do not
  // matter.
  scale.least = std::clamp(scale.least, scale.largest * 1e-4f, scale.largest * 0.5f);
  return scale;
}

glm::dvec4 clip_plane(const ClipChoice& choice, const WideBox& bounds) {
  const glm::vec3 direction = direction_of(choice);
  const auto [least, most] = extent(direction, bounds);
  return {direction, -(least + static_cast<double>(unit(choice.place)) * (most - least))};
}

ClipChoice clip_choice(const glm::dvec4& plane, const WideBox& bounds) {
  ClipChoice choice;
  const glm::vec3 normal(plane);
  const float length = std::sqrt(glm::dot(normal, normal));
  if (!(length > 0) || !std::isfinite(length)) return choice;
  choice.view = normal / length;
  choice.axis = ClipAxis::view;
  for (int i = 0; i < 3; ++i) {
    if (!(std::abs(choice.view[i]) > kAligned)) continue;
    choice.axis = static_cast<ClipAxis>(i);
    choice.flip = choice.view[i] < 0;
  }
  const auto [least, most] = extent(direction_of(choice), bounds);
  choice.place =
      most > least ? unit(static_cast<float>((-plane.w / static_cast<double>(length) - least) / (most - least))) : 0.0f;
  return choice;
}

ClipChoice flipped(ClipChoice choice) {
  choice.flip = !choice.flip;
  choice.view = -choice.view;
  choice.place = 1 - choice.place;
  return choice;
}

}  // namespace gs::app
