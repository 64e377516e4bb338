#pragma once

#include "qnv/base/cloud.h"
#include "qnv/records/records_payload.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace gs::qnv {

/// What has arrived of a stream of records, with weights that conserve the integral however much is missing.
///
/// The rule (FORMAT.md, "Conservation"): a cell stands on its own when its header arrived and it holds at
/// least kFewestVectors of the vectors that arrived, or when no cell around it can stand. Each vector belongs to the
/// deepest such cell. All vectors that belong to a cell are scaled by one factor, such that they and the cells inside
/// weigh as much as the header says. The weight of a part of a cell from which nothing arrived goes to the cells beside
/// it, but no cell is given more than kLargestGrowth times its own weight. So no vector ever weighs more than
/// kLargestGrowth times the cell that it belongs to, however little arrived.
///
/// One thread. Patches may come from outside: memory is bounded by them, and any numbers give finite weights.
class RecordsAssembly {
 public:
  static constexpr std::size_t kFewestVectors = 8;
  static constexpr double kLargestGrowth = 2;
  static constexpr std::size_t kMostNodes = std::size_t{1} << 22;

  /// `description`: of the stream; its box and its total are used.
  explicit RecordsAssembly(const Description& description);

  /// Adds what arrived of a chunk, in any order; records that are there already are not added again. Returns how
  /// many were new. A stream of more than kMostNodes cells is not one of ours: chunks of further cells are refused.
  std::size_t add(const RecordsPatch& patch);

  [[nodiscard]] std::size_t size() const { return positions_.size(); }
  /// One entry a vector, in the order in which they were added.
  [[nodiscard]] std::span<const glm::vec3> positions() const { return positions_; }
  [[nodiscard]] std::span<const glm::vec3> normals() const { return normals_; }
  [[nodiscard]] std::span<const float> weights() const { return weights_; }  // as they were sent
  [[nodiscard]] std::span<const std::uint8_t> colors() const { return colors_; }

  /// The weights, scaled by the rule above; each > 0 unless it is below what a float can hold. Takes time in
  /// proportion to size().
  [[nodiscard]] std::vector<float> conserved_weights();

 private:
  struct Node {
    std::uint32_t parent = 0;
    std::uint8_t depth = 0;
    std::array<std::uint32_t, 8> children{};  // 0: none; the root is nobody's child
    double weight = 0;                        // of all vectors in the cell
    bool known = false;                       // weight is
  };
  using HeaderBits = std::array<std::uint32_t, 12>;
  // Sums over the nodes, one entry each.
  struct Sums {
    std::vector<std::uint32_t> vectors;  // that arrived in the cell
    std::vector<bool> stands;
    std::vector<std::uint32_t> owner;  // the deepest that stands, of the node and those around it
    std::vector<double> own;           // weight, as sent, of the vectors that belong to the cell
    std::vector<double> inside;        // weight of the nearest cells inside that stand
  };

  [[nodiscard]] std::uint32_t node_of(const RecordsCell& cell);
  static HeaderBits bits_of(const RecordsHeader& header);
  void descend();
  [[nodiscard]] Sums sum() const;
  [[nodiscard]] std::vector<double> factors(const Sums& sums) const;

  RecordsCube cube_;
  std::vector<Node> nodes_;                         // parents first
  std::map<HeaderBits, std::vector<bool>> chunks_;  // which records of each have arrived
  std::vector<glm::vec3> positions_, normals_;
  std::vector<float> weights_;
  std::vector<std::uint8_t> colors_;
  std::vector<std::array<std::uint32_t, 3>> cells_;  // of depth 20
  std::vector<std::uint32_t> deepest_;               // node that each vector lies in
};

}  // namespace gs::qnv
