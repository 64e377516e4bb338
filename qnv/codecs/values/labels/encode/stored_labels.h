#pragma once

#include "qnv/codecs/shared/ranks.h"
#include "qnv/codecs/shared/spill_store.h"
#include "qnv/codecs/values/labels/label_runs.h"
#include "qnv/container/label_palette.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::qnv::values {

/// Store that several threads read while others add bytes.
class SharedStore {
 public:
  explicit SharedStore(SpillStore& store) : store_(store) {}

  /// Adds bytes. Returns their offset, or nullopt if they cannot be stored.
  [[nodiscard]] std::optional<std::uint64_t> append(std::span<const std::byte> bytes);
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::byte> to) const;
  [[nodiscard]] std::string problem() const;
  /// Makes the added bytes readable to other processes.
  void publish();
  /// Reports whether one of the calls failed.
  [[nodiscard]] bool failed() const { return failed_; }

 private:
  mutable std::mutex mutex_;
  SpillStore& store_;
  mutable std::atomic<bool> failed_{false};
};

/// Edge of a tile in voxels: the unit in which encoders read stored labels.
inline constexpr std::uint32_t kTileEdge = 64;

/// Labels of one level in a store, as runs of equal labels. Pieces of kTileEdge x kTileEdge x kDepth voxels are packed
/// alone. Several threads may read.
class StoredLabels {
 public:
  static constexpr std::uint32_t kDepth = 2;

  /// `store` must outlive the labels.
  StoredLabels(Extent extent, SharedStore& store);

  [[nodiscard]] const Extent& extent() const { return extent_; }
  /// Returns the number of pieces per axis.
  [[nodiscard]] const Extent& pieces() const { return pieces_; }
  /// Returns the size of a piece in voxels, which is smaller at the ends of the level.
  [[nodiscard]] Extent size_of(const Extent& piece) const;

  /// Packed piece.
  struct Packed {
    std::vector<std::byte> bytes;  // empty if all labels are `label`
    std::uint32_t label = 0;
  };
  /// Packs the labels of a piece, x first. There must be at least one.
  [[nodiscard]] static Packed pack(std::span<const std::uint32_t> labels);
  /// Adds the next piece, x first. Returns false if it cannot be stored.
  [[nodiscard]] bool append(const Packed& piece);
  /// Joins the pieces that the ranks added to their common store, in the order of the ranks. Collective.
  void join(Ranks& ranks) { places_ = gather_records(ranks, std::span<const Place>(places_)); }

  /// Returns the label of a piece with equal labels; nullopt for other pieces.
  [[nodiscard]] std::optional<std::uint32_t> uniform(const Extent& piece) const;
  /// Calls take(label, count) for each run of a piece. Returns false if it cannot be read.
  bool each_run(const Extent& piece, const std::function<void(std::uint32_t label, std::size_t count)>& take) const;
  /// Reads the labels of a piece, x first. Returns false if it cannot be read.
  bool read(const Extent& piece, std::span<std::uint32_t> to) const;

  /// Sets the palette: later reads return indices instead of codes. The palette must have all codes.
  void set_palette(std::shared_ptr<const LabelPalette> palette) { palette_ = std::move(palette); }

 private:
  struct Place {
    std::uint64_t offset = 0;  // of a piece of several labels; otherwise the label
    std::uint32_t bytes = 0;   // 0 means one label
  };
  [[nodiscard]] const Place& place(const Extent& piece) const {
    return places_[(std::size_t{piece[2]} * pieces_[1] + piece[1]) * pieces_[0] + piece[0]];
  }
  [[nodiscard]] std::uint32_t index_of(std::uint32_t code) const {
    return palette_ ? palette_->index(code).value_or(0) : code;
  }

  Extent extent_{}, pieces_{};
  SharedStore* store_;
  std::shared_ptr<const LabelPalette> palette_;  // null if the labels are indices
  std::vector<Place> places_;
};

/// Tiles of stored labels: kTileEdge voxels per axis. One thread at a time.
class LabelTiles final : public LabelCubes {
 public:
  /// Keeps at most `most` tiles in memory. `level` must outlive the tiles.
  explicit LabelTiles(const StoredLabels& level, std::size_t most = 40);

  /// Tile of labels, x first.
  struct Tile {
    Extent size{};
    std::vector<std::uint32_t> labels;  // empty if all are equal
    std::uint32_t label = 0;            // if all are equal
    std::uint64_t used = 0;
    [[nodiscard]] std::uint32_t at(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
      return labels.empty() ? label : labels[(std::size_t{z} * size[1] + y) * size[0] + x];
    }
  };
  /// Returns a tile. It is valid until the next call of tile() or cube(). If the store fails, its labels are
  /// unspecified.
  [[nodiscard]] const Tile& tile(const Extent& tile);

  [[nodiscard]] const Extent& extent() const override { return level_.extent(); }
  [[nodiscard]] CubeLabels cube(const Extent& cube) override;

 private:
  void load(const Extent& at, Tile& tile) const;

  const StoredLabels& level_;
  const std::size_t most_;
  Extent count_{};  // of tiles per axis
  std::unordered_map<std::uint64_t, Tile> tiles_;
  std::uint64_t last_number_ = ~std::uint64_t{0}, time_ = 0;
  const Tile* last_ = nullptr;
  std::array<std::uint32_t, kCubeEdge> equal_{};  // labels of a row of the last tile with equal ones
};

}  // namespace gs::qnv::values
