#include "qnv/codecs/values/decode/cell_vectors.h"

#include "base/parallel.h"
#include "qnv/sampling/volume/gradient_row.h"
#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <mutex>

namespace gs::qnv::values {

namespace {

// Maximum units of a box per axis, so that its values stay in the processor's cache.
constexpr Extent kMostCells{16, 4, 4};
// Minimum and maximum number of kept vectors, relative to the result. Spare vectors avoid collecting all vectors again
// after a small change of the cut. Above the maximum, the shortest vectors are dropped.
constexpr double kSpare = 1.25, kMostSpare = 2;
constexpr std::size_t kThreadVoxels = std::size_t{1} << 15;

std::size_t voxels_of(std::span<const SampleBox> boxes) {
  std::size_t sum = 0;
  for (const SampleBox& box : boxes) sum += sample_count(box.size);
  return sum;
}

}  // namespace

void SampledGrid::read(const SampleBox& box, std::int32_t* to) const {
  const std::size_t row = box.size[0], slice = row * box.size[1];
  samples.read(box, to, row, slice);
  limits.apply({to, slice * box.size[2]});
  if (!missing) return;
  const auto gap = static_cast<std::int32_t>(layout.missing.value_or(0));
  const Extent& all = samples.extent();
  for (std::uint32_t z = 0; z < box.size[2]; ++z)
    for (std::uint32_t y = 0; y < box.size[1]; ++y) {
      const std::uint8_t* const flags =
          missing->data() + ((box.first[2] + z) * std::size_t{all[1]} + box.first[1] + y) * all[0] + box.first[0];
      for (std::uint32_t x = 0; x < box.size[0]; ++x)
        if (flags[x] != 0) to[z * slice + y * row + x] = gap;
    }
}

/// Values of a box and of the voxels around it.
class CellVectors::Rows {
 public:
  void read(const SampledGrid& grid, const SampleBox& box) {
    all_ = grid.samples.extent();
    for (std::size_t a = 0; a < 3; ++a) {
      box_.first[a] = box.first[a] - std::min(box.first[a], 1u);
      box_.size[a] = std::min(all_[a], box.first[a] + box.size[a] + 1) - box_.first[a];
    }
    stored_.resize(sample_count(box_.size));
    values_.resize(stored_.size());
    grid.read(box_, stored_.data());
    values_of(grid.layout, std::as_bytes(std::span(stored_)), values_);
    lengths_.resize(box_.size[0]);
    gaps_ = grid.missing != nullptr;
  }
  [[nodiscard]] GradientRow row(std::uint32_t y, std::uint32_t z) const {
    const std::size_t nx = box_.size[0], slice = nx * box_.size[1];
    const float* const here = values_.data() + (z - box_.first[2]) * slice + (y - box_.first[1]) * nx;
    GradientRow row;
    row.here = here;
    row.before = {y > 0 ? here - nx : here, z > 0 ? here - slice : here};
    row.after = {y + 1 < all_[1] ? here + nx : here, z + 1 < all_[2] ? here + slice : here};
    row.factor = {y > 0 && y + 1 < all_[1] ? 0.5 : 1.0, z > 0 && z + 1 < all_[2] ? 0.5 : 1.0};
    row.count = box_.size[0];
    return row;
  }
  /// Returns the lengths of the gradients of the row. Those at its ends are wrong unless the volume ends there.
  const float* lengths(const GradientRow& row, const glm::dmat3& to_world) const {
    magnitudes(row, to_world, gaps_, lengths_.data());
    return lengths_.data();
  }
  [[nodiscard]] std::uint32_t first_x() const { return box_.first[0]; }

 private:
  Extent all_{};
  SampleBox box_;
  std::vector<std::int32_t> stored_;
  std::vector<float> values_;
  mutable std::vector<float> lengths_;
  bool gaps_ = false;
};

CellVectors::CellVectors(Extent extent, const glm::dmat3& axes, const CellVectorOptions& options)
    : extent_(extent), to_world_(glm::transpose(glm::inverse(axes))), options_(options), counts_(kKeys) {
  for (std::size_t a = 0; a < 3; ++a) cells_[a] = extent[a] / kCell + (extent[a] % kCell != 0 ? 1 : 0);
  keys_.assign(sample_count(extent), 0);
  all_.resize(sample_count(cells_));
}

void CellVectors::measure_box(const Rows& rows, const SampleBox& box, Counts& counts) {
  for (std::uint32_t z = box.first[2]; z < box.first[2] + box.size[2]; ++z)
    for (std::uint32_t y = box.first[1]; y < box.first[1] + box.size[1]; ++y) {
      const GradientRow row = rows.row(y, z);
      const float* const lengths = rows.lengths(row, to_world_) + (box.first[0] - rows.first_x());
      std::uint16_t* const keys = keys_.data() + (std::size_t{z} * extent_[1] + y) * extent_[0] + box.first[0];
      Cell* cell = all_.data() + cell_of(box.first[0], y, z);
      const bool fresh = y % kCell == 0 && z % kCell == 0;
      for (std::uint32_t x = 0; x < box.size[0]; x += kCell, ++cell) {
        const std::uint32_t end = std::min(x + kCell, box.size[0]);
        float sum = 0;
        for (std::uint32_t i = x; i < end; ++i) {
          sum += lengths[i];
          const auto key = static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(lengths[i]) >> kLowerBits);
          if (key == keys[i]) continue;
          --counts[keys[i]];
          ++counts[key];
          keys[i] = key;
        }
        cell->total = (fresh ? 0 : cell->total) + static_cast<double>(sum);
      }
      if (lowest_ > 0) collect_row(rows, row, lengths, box, y, z);
    }
}

void CellVectors::measure(const SampledGrid& grid, std::span<const SampleBox> boxes) {
  std::mutex mutex;
  std::vector<std::unique_ptr<Counts>> all, free;
  parallel_for(
      boxes.size(),
      [&](std::size_t i) {
        thread_local Rows rows;
        Counts* counts = nullptr;
        {
          const std::lock_guard lock(mutex);
          if (free.empty()) free.push_back(std::make_unique<Counts>(kKeys));
          counts = free.back().release();
          free.pop_back();
        }
        rows.read(grid, boxes[i]);
        measure_box(rows, boxes[i], *counts);
        const std::lock_guard lock(mutex);
        free.emplace_back(counts);
      },
      voxels_of(boxes) < kThreadVoxels ? 1 : 0);
  for (const auto& counts : free)
    for (std::size_t key = 0; key < kKeys; ++key) counts_[key] += (*counts)[key];
  counts_[0] = 0;  // all other voxels; their number does not matter
}

void CellVectors::collect_row(const Rows& rows, const GradientRow& row, const float* lengths, const SampleBox& box,
                              std::uint32_t y, std::uint32_t z) {
  const std::uint16_t* const keys = keys_.data() + (std::size_t{z} * extent_[1] + y) * extent_[0] + box.first[0];
  const std::uint32_t shift = box.first[0] - rows.first_x();
  const bool any = std::any_of(keys, keys + box.size[0], [this](std::uint16_t key) { return key >= lowest_; });
  if (any && !lengths) lengths = rows.lengths(row, to_world_) + shift;
  Cell* cell = all_.data() + cell_of(box.first[0], y, z);
  const std::uint32_t place = (z % kCell * kCell + y % kCell) * kCell;
  for (std::uint32_t x = 0; x < box.size[0]; x += kCell, ++cell) {
    if (place == 0) cell->vectors.clear();
    if (!any) continue;
    for (std::uint32_t i = x; i < std::min(x + kCell, box.size[0]); ++i) {
      if (keys[i] < lowest_) continue;
      cell->vectors.push_back({static_cast<std::uint16_t>(place + i % kCell), std::bit_cast<std::uint32_t>(lengths[i]),
                               row.here[i + shift], glm::vec3(glm::normalize(gradient_at(row, i + shift, to_world_)))});
    }
  }
}

void CellVectors::collect(const SampledGrid& grid, std::span<const SampleBox> boxes) {
  parallel_for(
      boxes.size(),
      [&](std::size_t i) {
        thread_local Rows rows;
        rows.read(grid, boxes[i]);
        for (std::uint32_t z = boxes[i].first[2]; z < boxes[i].first[2] + boxes[i].size[2]; ++z)
          for (std::uint32_t y = boxes[i].first[1]; y < boxes[i].first[1] + boxes[i].size[1]; ++y)
            collect_row(rows, rows.row(y, z), nullptr, boxes[i], y, z);
      },
      voxels_of(boxes) < kThreadVoxels ? 1 : 0);
}

std::uint64_t CellVectors::wanted() const {
  std::uint64_t vectors = 0;
  for (const std::int64_t count : counts_) vectors += static_cast<std::uint64_t>(count);
  const double share = std::round(options_.fraction * static_cast<double>(sample_count(extent_)));
  return std::min({vectors, options_.most, static_cast<std::uint64_t>(share)});
}

std::uint32_t CellVectors::key_of(std::uint64_t count) const {
  std::uint64_t above = 0;
  std::size_t key = kKeys;
  while (key > 1 && above < count) above += static_cast<std::uint64_t>(counts_[--key]);
  return static_cast<std::uint32_t>(std::min(key, kKeys - 1));
}

void CellVectors::update(const SampledGrid& grid, std::span<const SampleBox> changed) {
  UnitMask mask(extent_, kCell);
  for (const SampleBox& box : changed) {
    std::array<std::int64_t, 3> low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::int64_t{box.first[a]} - 1;
      high[a] = std::int64_t{box.first[a]} + box.size[a] + 1;
    }
    mask.mark(low, high);
  }
  measure(grid, mask.take_for(kMostCells, 1));
  const std::uint64_t count = wanted();
  const auto spare = [&](double factor) {
    return key_of(static_cast<std::uint64_t>(std::ceil(factor * static_cast<double>(count))));
  };
  const std::uint32_t needed = key_of(count);
  if (lowest_ == 0 || needed < lowest_) {
    lowest_ = spare(kSpare);
    mask.mark_all();
    collect(grid, mask.take(kMostCells));
  } else if (lowest_ < spare(kMostSpare)) {
    lowest_ = spare(kSpare);
    const std::uint32_t lowest = lowest_ << kLowerBits;
    constexpr std::size_t kPart = 1024;
    parallel_for((all_.size() + kPart - 1) / kPart, [&](std::size_t part) {
      for (std::size_t i = part * kPart; i < std::min(all_.size(), (part + 1) * kPart); ++i)
        std::erase_if(all_[i].vectors, [&](const Vector& vector) { return vector.length < lowest; });
    });
  }
}

CellVectors::Cut CellVectors::cut() const {
  Cut cut;
  cut.count = wanted();
  if (cut.count == 0) return cut;
  cut.key = key_of(cut.count);
  std::uint64_t above = 0;
  for (std::size_t key = cut.key + 1; key < kKeys; ++key) above += static_cast<std::uint64_t>(counts_[key]);
  std::vector<std::uint32_t> lengths;
  for (const Cell& cell : all_)
    for (const Vector& vector : cell.vectors)
      if (vector.length >> kLowerBits == cut.key) lengths.push_back(vector.length);
  const auto nth = lengths.begin() + static_cast<std::ptrdiff_t>(cut.count - above - 1);
  std::nth_element(lengths.begin(), nth, lengths.end(), std::greater<>());
  cut.length = *nth;
  cut.ties = static_cast<std::uint64_t>(std::count(lengths.begin(), nth + 1, cut.length));
  return cut;
}

void CellVectors::fill(const SampledGrid& grid, Volume& volume) const {
  const Cut cut = this->cut();
  volume.positions.resize(cut.count);
  volume.normals.resize(cut.count);
  volume.weights.resize(cut.count);
  volume.classes.resize(cut.count);
  if (cut.count == 0) return;
  // Each part of the cells counts its vectors by key. Then all parts know where theirs begin.
  constexpr std::size_t kParts = 8;
  struct Part {
    std::vector<std::uint64_t> starts;
    std::uint64_t ties = 0;
  };
  std::array<Part, kParts> parts;
  const std::size_t cells = all_.size() / kParts + 1, keys = kKeys - cut.key;
  const auto each = [&](std::size_t part, const auto& visit) {
    for (std::size_t i = std::min(all_.size(), part * cells); i < std::min(all_.size(), (part + 1) * cells); ++i)
      for (const Vector& vector : all_[i].vectors)
        if (vector.length >= cut.length) visit(i, vector);
  };
  parallel_for(kParts, [&](std::size_t p) {
    parts[p].starts.assign(keys, 0);
    each(p, [&](std::size_t, const Vector& vector) {
      ++(vector.length == cut.length ? parts[p].ties : parts[p].starts[(vector.length >> kLowerBits) - cut.key]);
    });
  });
  std::uint64_t start = 0, ties = cut.ties;
  for (Part& part : parts) {
    part.ties = std::min(part.ties, ties);
    ties -= part.ties;
    part.starts[0] += part.ties;
  }
  for (std::size_t key = keys; key-- > 0;)
    for (Part& part : parts) {
      const std::uint64_t count = part.starts[key];
      part.starts[key] = start;
      start += count;
    }
  const double least = static_cast<double>(options_.range.first),
               range = static_cast<double>(options_.range.second) - least, scale = range > 0 ? 255 / range : 0;
  parallel_for(kParts, [&](std::size_t p) {
    std::uint64_t left = parts[p].ties;
    each(p, [&](std::size_t i, const Vector& vector) {
      if (vector.length == cut.length && (left == 0 || left-- == 0)) return;
      const std::size_t to = parts[p].starts[(vector.length >> kLowerBits) - cut.key]++;
      const std::size_t x = i % cells_[0] * kCell + vector.place % kCell,
                        y = i / cells_[0] % cells_[1] * kCell + vector.place / kCell % kCell,
                        z = i / cells_[0] / cells_[1] * kCell + vector.place / (kCell * kCell);
      volume.positions[to] =
          voxel_position(grid.layout, static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
      volume.normals[to] = vector.normal;
      volume.weights[to] = std::bit_cast<float>(vector.length);
      const double part = (static_cast<double>(vector.value) - least) * scale;
      volume.classes[to] = static_cast<std::uint8_t>(std::clamp(part, 0.0, 255.0) + 0.5);
    });
  });
}

double CellVectors::total() const {
  double sum = 0;
  for (const Cell& cell : all_) sum += cell.total;
  return sum;
}

}  // namespace gs::qnv::values
