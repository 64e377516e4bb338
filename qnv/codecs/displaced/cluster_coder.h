#pragma once

#include "qnv/codecs/displaced/number_array.h"
#include "qnv/codecs/displaced/patches.h"
#include "qnv/entropy/binary_coder.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <type_traits>
#include <vector>

namespace gs::qnv::displaced {

/// Coder of the numbers of new vertices in a run of patches, in the order of FORMAT.md, "Clusters". With BinaryEncoder
/// as `Coder`, encodes the numbers; with BinaryDecoder, decodes them. Never uses numbers from outside the run, so that
/// the loss of a cluster does not affect other clusters.
template <class Coder>
class ClusterCoder {
 public:
  ClusterCoder(Coder& coder, const Patches& patches, std::uint32_t first, std::uint32_t count)
      : coder_(coder), patches_(patches), first_(first), end_(first + count) {}

  /// Codes a level (1 and up). `now` has one number per vertex of the level; codes only the new vertices of the run.
  /// `sideways` has the second numbers of vertices on rims and creases, from the first edge vertex on; nullptr or empty
  /// if there are none. Returns false if the bytes end early.
  bool level(int level, NumberArray& now, NumberArray* sideways);
  /// Codes the numbers of base vertices. A base vertex belongs to the first patch that has it as a corner. Codes only
  /// vertices that belong to patches of the run.
  bool base(NumberArray& now);

 private:
  static constexpr bool kWrites = std::is_same_v<Coder, BinaryEncoder>;
  static constexpr std::uint32_t kContexts = 5;

  bool bit(BitModel& model, bool value) {
    if constexpr (kWrites) {
      coder_.put(model, value);
      return value;
    } else {
      return coder_.get(model);
    }
  }
  void residual(std::int16_t& value, std::uint32_t beside) {
    static constexpr std::array<std::uint8_t, 7> kContext{0, 1, 2, 3, 3, 3, 4};
    if (!bit(nonzero_[kContext[std::min<std::uint32_t>(beside, 6)]], value != 0)) {
      value = 0;
      return;
    }
    NumberModel<6>& sizes = sizes_[std::min<std::uint32_t>(beside / 3, 3)];
    if constexpr (kWrites) {
      coder_.put_bits(value < 0 ? 1 : 0, 1);
      sizes.put(coder_, static_cast<std::uint32_t>(std::abs(int{value})) - 1);
    } else {
      const bool negative = coder_.get_bits(1) != 0;
      const auto size = static_cast<int>(std::min<std::uint32_t>(sizes.get(coder_), 32766)) + 1;
      value = static_cast<std::int16_t>(negative ? -size : size);
    }
  }
  [[nodiscard]] bool good() const {
    if constexpr (kWrites)
      return true;
    else
      return !coder_.exhausted();
  }
  [[nodiscard]] bool mine(std::uint32_t patch) const { return patch >= first_ && patch < end_; }
  bool any_in(std::uint32_t patch, int level, const NumberArray& now, const NumberArray* sideways) const;

  Coder& coder_;
  const Patches& patches_;
  std::uint32_t first_, end_;
  std::array<BitModel, kContexts> nonzero_;
  std::array<NumberModel<6>, 4> sizes_;
  std::array<BitModel, 3> filled_;  // indexed by the number of directly preceding empty patches: none, one, more
  std::uint32_t empties_ = 0;
  std::vector<std::uint32_t> grid_;
  std::vector<std::uint8_t> known_;
};

template <class Coder>
bool ClusterCoder<Coder>::base(NumberArray& now) {
  for (std::uint32_t p = first_; p < end_ && good(); ++p)
    for (const std::uint32_t v : patches_.triangles()[p])
      if (patches_.owner(v) == p) residual(now[v], 0);
  return good();
}

template <class Coder>
bool ClusterCoder<Coder>::any_in(std::uint32_t patch, int level, const NumberArray& now,
                                 const NumberArray* sideways) const {
  const std::size_t n = std::size_t{1} << level, edges_at = patches_.base_vertices();
  for (std::uint32_t k = 0; k < 3; ++k) {
    if (!patches_.owns(patch, k)) continue;
    const std::size_t start = patches_.edge_start(patches_.edge(patch, k), level);
    if (now.any(start, n - 1)) return true;
    if (sideways && sideways->any(start - edges_at, n - 1)) return true;
  }
  return now.any(patches_.inner_start(patch, level), (n - 1) * (n - 2) / 2);
}

template <class Coder>
bool ClusterCoder<Coder>::level(int level, NumberArray& now, NumberArray* sideways) {
  if (sideways && sideways->empty()) sideways = nullptr;
  const std::size_t n = std::size_t{1} << level, edges_at = patches_.base_vertices();
  const auto small = [](std::int16_t v) { return static_cast<std::uint8_t>(std::min(std::abs(int{v}), 255)); };
  known_.resize((n + 1) * (n + 2) / 2);
  for (std::uint32_t p = first_; p < end_ && good(); ++p) {
    const bool filled = bit(filled_[empties_], kWrites && any_in(p, level, now, sideways));
    empties_ = filled ? 0 : std::min<std::uint32_t>(empties_ + 1, 2);
    if (!filled) continue;
    patches_.grid(p, level, grid_);
    std::fill(known_.begin(), known_.end(), std::uint8_t{0});
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Patches::Edge& edge = patches_.edges()[patches_.edge(p, k)];
      if (!mine(edge.owner)) continue;
      std::size_t last = 0;  // index of the previous position on this edge
      for (std::size_t t = 1; t < n; t += 2) {
        const std::size_t at = k == 0 ? t : k == 1 ? row_start(t, n) + n - t : row_start(n - t, n);
        const std::uint32_t v = grid_[at];
        if (edge.owner == p) {
          const std::uint32_t beside = t > 1 ? 2u * known_[last] : 0u;
          residual(now[v], beside);
          if (edge.line() && sideways) residual((*sideways)[v - edges_at], beside);
        }
        known_[at] = small(now[v]);
        last = at;
      }
    }
    for (std::size_t j = 1; j + 1 < n; ++j) {
      const std::size_t row = row_start(j, n), below = row_start(j - 1, n);
      for (std::size_t i = 1; i + j < n; ++i) {
        if (i % 2 == 0 && j % 2 == 0) continue;
        std::int16_t& value = now[grid_[row + i]];
        residual(value, std::uint32_t{known_[row + i - 1]} + known_[below + i] + known_[below + i + 1]);
        known_[row + i] = small(value);
      }
    }
  }
  return good();
}

}  // namespace gs::qnv::displaced
