#include "qnv/sampling/volume/label_vectors.h"

#include "qnv/sampling/volume/volume_slices.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

namespace gs::qnv {
namespace {

constexpr int kReach = 2;           // voxels around a voxel that determine its normal
constexpr double kSmoothing = 1.0;  // standard deviation of their weights, in voxels
constexpr double kMostMoved = 0.6;  // distance of a vector from the centre of its voxel, in voxels
constexpr std::size_t kRing = 2 * kReach + 1;

/// Weight of a voxel near another one.
struct NearVoxel {
  int x = 0, y = 0, z = 0;
  double weight = 0;
};
const std::vector<NearVoxel>& near_voxels() {
  static const std::vector<NearVoxel> all = [] {
    std::vector<NearVoxel> made;
    for (int z = -kReach; z <= kReach; ++z)
      for (int y = -kReach; y <= kReach; ++y)
        for (int x = -kReach; x <= kReach; ++x)
          made.push_back({x, y, z, std::exp(-(x * x + y * y + z * z) / (2 * kSmoothing * kSmoothing))});
    double sum = 0;
    for (const NearVoxel& one : made) sum += one.weight;
    for (NearVoxel& one : made) one.weight /= sum;
    return made;
  }();
  return all;
}

/// Pseudo-random number of a voxel (MurmurHash3's finaliser).
std::uint32_t rank_of(std::uint64_t voxel) {
  voxel = (voxel ^ voxel >> 33) * 0xff51afd7ed558ccdull;
  voxel = (voxel ^ voxel >> 33) * 0xc4ceb9fe1a85ec53ull;
  return static_cast<std::uint32_t>(voxel >> 32);
}

/// Vector of a voxel at a surface.
struct LabelVector {
  std::uint32_t rank = 0;
  glm::vec3 position{0}, normal{0};
  double number = 0;
};

/// Computes the vectors of one volume.
class LabelSurveyor {
 public:
  LabelSurveyor(const VolumeSource& source, const GradientOptions& options, Progress* progress)
      : source_(source), layout_(source.layout), options_(options), progress_(progress) {
    to_world_ = glm::transpose(glm::inverse(glm::dmat3(layout_.axes[0], layout_.axes[1], layout_.axes[2])));
    for (const glm::vec3& axis : layout_.axes) spacing_ = std::min(spacing_, static_cast<double>(glm::length(axis)));
  }

  std::variant<Volume, VolumeError> run() {
    if (const auto problem = count_labels()) return *problem;
    if (labels_.empty()) return VolumeError{"every voxel of the volume is missing; expected labels"};
    background_ = background_of(labels_)->number;
    const double share = std::round(options_.fraction * static_cast<double>(voxel_count(layout_)));
    wanted_ = std::min<std::uint64_t>(options_.vectors, static_cast<std::uint64_t>(share));
    if (const auto problem = collect()) return *problem;
    return volume();
  }

 private:
  void start(const char* stage) {
    if (!progress_) return;
    progress_->stage = stage;
    progress_->done = 0;
    progress_->total = layout_.dimensions[2];
  }
  bool read(std::uint32_t z, std::vector<double>& numbers) {
    stored_.resize(slice_voxels(layout_) * size_of(layout_.type));
    numbers.resize(slice_voxels(layout_));
    if (!source_.read(z, stored_)) return false;
    stored_numbers(layout_, stored_, numbers);
    return true;
  }

  std::optional<VolumeError> count_labels() {
    start("measuring");
    std::map<double, std::uint64_t> counts;
    std::vector<double> numbers;
    for (std::uint32_t z = 0; z < layout_.dimensions[2]; ++z) {
      if (is_cancelled(progress_)) return VolumeError{"cancelled"};
      if (!read(z, numbers)) return VolumeError{"slice " + std::to_string(z) + " cannot be read"};
      for (std::size_t i = 0; i < numbers.size();) {
        std::size_t end = i + 1;
        while (end < numbers.size() && numbers[end] == numbers[i]) ++end;
        if (numbers[i] == numbers[i]) counts[numbers[i]] += end - i;
        i = end;
      }
      if (progress_) progress_->done = z + 1;
    }
    for (const auto& [number, count] : counts) labels_.push_back({number, count});
    return std::nullopt;
  }

  /// Returns the label of a voxel; `background_` outside of the volume.
  [[nodiscard]] double at(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const auto [nx, ny, nz] = layout_.dimensions;
    if (x < 0 || y < 0 || z < 0 || x >= nx || y >= ny || z >= nz) return background_;
    return ring_[static_cast<std::size_t>(z) % kRing][static_cast<std::size_t>(y * nx + x)];
  }

  std::optional<VolumeError> collect() {
    start("collecting");
    const std::uint32_t ny = layout_.dimensions[1], nz = layout_.dimensions[2];
    std::vector<std::vector<LabelVector>> rows(ny);
    std::uint32_t loaded = 0;
    for (std::uint32_t z = 0; z < nz; ++z) {
      if (is_cancelled(progress_)) return VolumeError{"cancelled"};
      for (; loaded < std::min<std::uint64_t>(std::uint64_t{z} + kReach + 1, nz); ++loaded)
        if (!read(loaded, ring_[loaded % kRing]))
          return VolumeError{"slice " + std::to_string(loaded) + " cannot be read"};
      parallel_for(
          ny,
          [&](std::size_t y) {
            rows[y].clear();
            survey_row(static_cast<std::uint32_t>(y), z, rows[y]);
          },
          options_.threads);
      for (const auto& row : rows) found_.insert(found_.end(), row.begin(), row.end());
      thin();
      if (progress_) progress_->done = z + 1;
    }
    return std::nullopt;
  }

  // Drops vectors with high ranks while there are twice as many as wanted.
  void thin() {
    while (found_.size() > 2 * wanted_ + 65536) {
      highest_ /= 2;
      std::erase_if(found_, [this](const LabelVector& one) { return one.rank > highest_; });
    }
  }

  void survey_row(std::uint32_t y, std::uint32_t z, std::vector<LabelVector>& to) const {
    const std::uint32_t nx = layout_.dimensions[0];
    const double* row = &ring_[z % kRing][std::size_t{y} * nx];
    for (std::uint32_t x = 0; x < nx; ++x) {
      const double here = row[x];
      if (here == background_ || here != here) continue;
      const std::int64_t i = x, j = y, k = z;
      if (at(i - 1, j, k) == here && at(i + 1, j, k) == here && at(i, j - 1, k) == here && at(i, j + 1, k) == here &&
          at(i, j, k - 1) == here && at(i, j, k + 1) == here)
        continue;
      const std::uint32_t rank = rank_of((std::uint64_t{z} * layout_.dimensions[1] + y) * nx + x);
      if (rank <= highest_) to.push_back(vector_at(x, y, z, here, rank));
    }
  }

  [[nodiscard]] LabelVector vector_at(std::uint32_t x, std::uint32_t y, std::uint32_t z, double here,
                                      std::uint32_t rank) const {
    glm::dvec3 inwards(0);
    double share = 0;  // of the label around the voxel
    for (const NearVoxel& near : near_voxels()) {
      if (at(std::int64_t{x} + near.x, std::int64_t{y} + near.y, std::int64_t{z} + near.z) != here) continue;
      share += near.weight;
      inwards += near.weight * glm::dvec3(near.x, near.y, near.z);
    }
    LabelVector made;
    made.rank = rank;
    made.number = here;
    const double length = glm::length(inwards);
    glm::dvec3 place(x, y, z);
    if (length > 1e-6) {
      // Across a plane, the share is the normal distribution of the distance, with half of it at the plane.
      const double distance = std::clamp((share - 0.5) * kSmoothing * 2.5, -kMostMoved, kMostMoved);
      place -= inwards / length * distance;
    } else {
      inwards = glm::dvec3(0, 0, 1);
    }
    made.normal = glm::vec3(glm::normalize(to_world_ * inwards));
    made.position = voxel_position(layout_, place.x, place.y, place.z);
    return made;
  }

  std::variant<Volume, VolumeError> volume() {
    const std::size_t total = found_.size(), count = std::min<std::size_t>(total, wanted_);
    std::ranges::stable_sort(found_, {}, &LabelVector::rank);
    found_.resize(count);
    std::vector<double> numbers;
    for (const VolumeLabel& label : labels_) numbers.push_back(label.number);
    const auto value_of = [&](double number) { return number * layout_.slope + layout_.intercept; };
    Volume volume;
    volume.description = volume_description(layout_);
    Description& about = volume.description;
    const auto first = static_cast<float>(value_of(numbers.front())),
               last = static_cast<float>(value_of(numbers.back()));
    about.value_range = options_.range.value_or(std::pair(std::min(first, last), std::max(first, last)));
    about.total = static_cast<double>(total) / spacing_;
    about.transfer = label_transfer(numbers);
    if (layout_.slope < 0) {
      for (TransferPoint& point : about.transfer) point.value = 1 - point.value;
      std::ranges::reverse(about.transfer);
    }
    const bool own_colors = !has_label_classes(numbers);
    const auto [low, high] = about.value_range;
    const double scale = high > low ? 255 / (static_cast<double>(high) - static_cast<double>(low)) : 0;
    for (const LabelVector& one : found_) {
      volume.positions.push_back(one.position);
      volume.normals.push_back(one.normal);
      volume.weights.push_back(static_cast<float>(1 / spacing_));
      const double part = (value_of(one.number) - static_cast<double>(low)) * scale;
      volume.classes.push_back(static_cast<std::uint8_t>(std::clamp(part, 0.0, 255.0) + 0.5));
      if (own_colors) volume.colors.push_back(label_color(one.number));
    }
    return volume;
  }

  const VolumeSource& source_;
  const VolumeLayout& layout_;
  const GradientOptions& options_;
  Progress* progress_;
  glm::dmat3 to_world_{1};
  double spacing_ = std::numeric_limits<double>::infinity();
  std::vector<std::byte> stored_;
  std::vector<VolumeLabel> labels_;  // ascending
  double background_ = 0;
  std::uint64_t wanted_ = 0;
  std::array<std::vector<double>, kRing> ring_;
  std::vector<LabelVector> found_;
  std::uint32_t highest_ = 0xffffffff;  // rank
};

std::uint8_t channel(double part) { return static_cast<std::uint8_t>(std::lround(std::clamp(part, 0.0, 1.0) * 255)); }

}  // namespace

const VolumeLabel* background_of(std::span<const VolumeLabel> labels) {
  const VolumeLabel* best = nullptr;
  for (const VolumeLabel& label : labels) {
    if (label.number == 0) return &label;
    if (!best || label.count > best->count) best = &label;
  }
  return best;
}

Rgb8 label_color(double number) {
  constexpr double kGoldenRatio = 0.6180339887498949;
  if (number == 0) return {90, 90, 90};
  const double turn = std::abs(number) * kGoldenRatio;
  const double hue = 6 * (turn - std::floor(turn));
  const auto steps = static_cast<int>(std::fmod(std::abs(number), 3));
  const double value = steps == 1 ? 0.95 : steps == 2 ? 0.8 : 0.9, saturation = steps == 0 ? 0.45 : 0.7;
  const auto part = [&](double shift) {
    const double around = std::fmod(hue + shift, 6);
    return value * (1 - saturation * std::clamp(std::min(around, 4 - around), 0.0, 1.0));
  };
  return {channel(part(5)), channel(part(3)), channel(part(1))};
}

bool has_label_classes(std::span<const double> numbers) {
  if (numbers.size() > 256) return false;
  const double scale = numbers.size() > 1 ? 255 / (numbers.back() - numbers.front()) : 0;
  for (std::size_t i = 1; i < numbers.size(); ++i)
    if (std::lround((numbers[i] - numbers.front()) * scale) == std::lround((numbers[i - 1] - numbers.front()) * scale))
      return false;
  return true;
}

std::vector<TransferPoint> label_transfer(std::span<const double> numbers) {
  constexpr float kOpacity = 0.95f;
  if (!has_label_classes(numbers)) return {{0, {200, 200, 200}, kOpacity}, {1, {200, 200, 200}, kOpacity}};
  std::vector<TransferPoint> points;
  const double range = numbers.size() > 1 ? numbers.back() - numbers.front() : 0;
  for (const double number : numbers) {
    // Classes are rounded to steps of 1/255, at which the function has the exact colours.
    const double place = range > 0 ? std::round((number - numbers.front()) / range * 255) / 255 : 0;
    points.push_back({static_cast<float>(place), label_color(number), kOpacity});
  }
  if (points.size() == 1) points.push_back({1, points.front().color, kOpacity});
  return points;
}

std::variant<Volume, VolumeError> label_vectors(const VolumeSource& source, const GradientOptions& options,
                                                Progress* progress) {
  return LabelSurveyor(source, options, progress).run();
}

}  // namespace gs::qnv
