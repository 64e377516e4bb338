#pragma once

#include "qnv/base/description.h"
#include "qnv/codecs/records/records_payload.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace gs::qnv {

/// Received part of a records stream, with weights that keep the integral however much is missing.
/// The rule is in FORMAT.md, "Conservation". A cell stands if its header was received and it holds at least
/// kMinVectors received vectors, or if no enclosing cell can stand. Each vector belongs to the deepest standing cell
/// that contains it. One factor scales all vectors of a cell, so that they and the inner cells weigh what the header
/// says. If a part of a cell received no vectors, its weight goes to the neighbouring cells. No cell gets more than
/// kLargestGrowth times its own weight, so no vector weighs more than kLargestGrowth times its cell.
/// Not thread-safe. Accepts untrusted patches: their size bounds the memory, and any numbers give finite weights.
class RecordsAssembly {
 public:
  static constexpr std::size_t kMinVectors = 8;
  static constexpr double kLargestGrowth = 2;
  static constexpr std::size_t kMaxNodes = std::size_t{1} << 22;

  /// Uses the box and the total of the stream's `description`.
  explicit RecordsAssembly(const Description& description);

  /// Adds the received records of a chunk, in any order, and skips records that are already there. Returns the number
  /// of new records. Rejects chunks of further cells once there are kMaxNodes cells, which a valid stream never has.
  std::size_t add(const RecordsPatch& patch);

  [[nodiscard]] std::size_t size() const { return positions_.size(); }
  /// One entry per vector, in the order of addition.
  [[nodiscard]] std::span<const glm::vec3> positions() const { return positions_; }
  [[nodiscard]] std::span<const glm::vec3> normals() const { return normals_; }
  [[nodiscard]] std::span<const float> weights() const { return weights_; }  // as sent
  [[nodiscard]] std::span<const std::uint8_t> colors() const { return colors_; }

  /// Returns the weights, scaled by the rule above. All are > 0, except below the range of float. Runs in O(size()).
  [[nodiscard]] std::vector<float> conserved_weights();

 private:
  struct Node {
    std::uint32_t parent = 0;
    std::uint8_t depth = 0;
    std::array<std::uint32_t, 8> children{};  // 0 means none; the root is not a child
    double weight = 0;                        // of all vectors in the cell
    bool known = false;                       // whether `weight` is known
  };
  using HeaderBits = std::array<std::uint32_t, 12>;
  // Sums over the nodes; one entry per node.
  struct Sums {
    std::vector<std::uint32_t> vectors;  // number of received vectors in the cell
    std::vector<bool> stands;
    std::vector<std::uint32_t> owner;  // deepest standing cell among the node and its ancestors
    std::vector<double> own;           // sent weight of the vectors that belong to the cell
    std::vector<double> inside;        // weight of the nearest standing cells inside
  };

  [[nodiscard]] std::uint32_t node_of(const RecordsCell& cell);
  static HeaderBits bits_of(const RecordsHeader& header);
  void descend();
  [[nodiscard]] Sums sum() const;
  [[nodiscard]] std::vector<double> factors(const Sums& sums) const;

  RecordsCube cube_;
  std::vector<Node> nodes_;                         // parents before children
  std::map<HeaderBits, std::vector<bool>> chunks_;  // received records of each chunk
  std::vector<glm::vec3> positions_, normals_;
  std::vector<float> weights_;
  std::vector<std::uint8_t> colors_;
  std::vector<std::array<std::uint32_t, 3>> cells_;  // at depth 20
  std::vector<std::uint32_t> deepest_;               // node that contains each vector
};

}  // namespace gs::qnv
