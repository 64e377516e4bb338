#pragma once

#include "qnv/codecs/values/labels/label_runs.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace gs::qnv::values {

/// Result of adding a run.
enum class AddedLabels : std::uint8_t { taken, repeated, refused, dropped };

/// Received labels of all levels, in any order. Safe for untrusted runs. One thread at a time.
class LabelLevels {
 public:
  /// Drops runs of levels below `finest`. `extent` has at most kMaxLabelEdge voxels per axis; `count` is the size of
  /// the palette, at least 1.
  LabelLevels(Extent extent, std::uint32_t count, int finest);

  AddedLabels add(const LabelRun& run);
  /// Begins the next step of a time series. Cubes keep their labels until a run of the step has them.
  void begin_step();
  [[nodiscard]] int levels() const { return static_cast<int>(all_.size()) - 1; }
  /// Returns the level to show: the finest one that is small or has a share of its cubes.
  [[nodiscard]] int level() const;
  /// Reports whether all labels of the volume were received.
  [[nodiscard]] bool is_whole() const { return all_.front().known == all_.front().cubes; }
  /// Returns the labels of a level, which never change. Where they are missing, coarser ones replace them; `none`
  /// replaces the coarsest. A whole level is shared, not copied.
  [[nodiscard]] std::shared_ptr<const LabelGrid> labels(int level, std::uint32_t none) const;

 private:
  struct Level {
    Extent extent{};
    std::uint64_t cubes = 0, known = 0;  // number of all cubes, and of the received ones
    std::uint64_t work = 0;              // codes of all decoded runs
    std::optional<CubeOrder> order;      // set with the first run
    std::shared_ptr<LabelGrid> grid;     // null before the first run
    std::vector<bool> received;          // by cube, x first
  };
  /// Returns the index of a cube in Level::received.
  static std::size_t number(const Level& level, const Extent& cube);
  static void refine(const LabelGrid& coarse, LabelGrid& fine);
  static void copy_received(const Level& level, LabelGrid& to);

  std::uint32_t count_;
  int finest_;
  std::vector<Level> all_;  // 0 is the volume
};

}  // namespace gs::qnv::values
