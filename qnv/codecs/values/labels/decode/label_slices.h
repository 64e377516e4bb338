#pragma once

#include "qnv/base/description.h"
#include "qnv/codecs/values/labels/label_runs.h"
#include "qnv/container/value_grid.h"
#include "qnv/sampling/volume/volume_values.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gs::qnv::values {

/// Place of a run in a stream.
struct LabelRunPlace {
  std::uint64_t first = 0, offset = 0;  // code; offset of the payload
  std::uint32_t count = 0;              // of codes
  std::uint32_t low = 0, high = 0;      // range of cubes along z, `high` is excluded
  std::uint16_t bytes = 0;              // of the payload
};

/// Extents of all levels of a volume, and the orders of their cubes.
struct LabelLayout {
  explicit LabelLayout(Extent extent);
  std::vector<Extent> extents;
  std::vector<CubeOrder> orders;
};

/// Places of the runs of all levels. A run that overlaps one before it is left out.
class LabelRunIndex {
 public:
  explicit LabelRunIndex(std::shared_ptr<const LabelLayout> layout) : layout_(std::move(layout)) {
    levels_.resize(layout_->orders.size());
  }

  /// Adds the payload of a chunk. `run` is the parsed payload, without its step. Returns false if it is not a run of
  /// the volume.
  bool add(const LabelRun& run, std::size_t bytes, std::uint64_t offset);
  /// Sorts the places. Must follow the last add().
  void finish();

  [[nodiscard]] const LabelLayout& layout() const { return *layout_; }
  /// Returns the places of a level, by code.
  [[nodiscard]] std::span<const LabelRunPlace> places(int level) const { return of(level).places; }
  /// Reports whether the runs have all cubes of a level.
  [[nodiscard]] bool is_whole(int level) const { return of(level).whole; }
  /// Returns the number of runs.
  [[nodiscard]] std::uint32_t count() const;

 private:
  struct Level {
    std::vector<LabelRunPlace> places;
    bool whole = false;
  };
  [[nodiscard]] const Level& of(int level) const { return levels_[static_cast<std::size_t>(level)]; }
  std::shared_ptr<const LabelLayout> layout_;
  std::vector<Level> levels_;
};

/// Bytes of a stream at any offset. Returns false on failure. Several threads call it.
using ReadStream = std::function<bool(std::uint64_t offset, std::span<std::byte> to)>;

/// Steps of a time series from the start of a chain to the shown step, or a single volume.
using LabelChain = std::vector<std::shared_ptr<const LabelRunIndex>>;

/// Returns the labels of a volume that may be larger than memory. Reading a slice decodes a slab of
/// slices, so ascending order is fastest. A slab needs 128 MB, or four slices of 4 bytes per voxel. `whole` means that
/// all labels were received; `in_order` is as in label_values().
[[nodiscard]] std::shared_ptr<VolumeValues> label_slices(const ValueGrid& grid, const Description& about,
                                                         LabelChain chain, ReadStream read, bool whole,
                                                         std::optional<std::uint32_t> in_order);

}  // namespace gs::qnv::values
