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

/// Received part of a records stream. Scales the weights so that their integral is right, however many vectors are
/// missing.
/// FORMAT.md, "Conservation", defines the rule. A cell stands if its header and at least kMinVectors of its vectors
/// were received, or if no enclosing cell can stand. Each vector belongs to the deepest standing cell that contains it.
/// One factor scales all vectors of a cell, so that these vectors and the inner cells have the weight that the header
/// states. If no vector was received in a part of a cell, the weight of that part goes to the neighbouring cells. No
/// cell gets more than kLargestGrowth times its own weight, so no vector weighs more than kLargestGrowth times its
/// cell.
/// One thread at a time. Safe for untrusted patches: their size bounds the memory, and any numbers give finite weights.
class RecordsAssembly {
 public:
  static constexpr std::size_t kMinVectors = 8;
  static constexpr double kLargestGrowth = 2;
  static constexpr std::size_t kMaxNodes = std::size_t{1} << 22;

  /// Uses the box and the total of the stream's `description`.
  explicit RecordsAssembly(const Description& description);

  /// Adds the received records of a chunk, in any order. Skips records that were added before. Returns the number of
  /// new records. Rejects chunks of new cells if there are kMaxNodes cells, which valid streams never have.
  std::size_t add(const RecordsPatch& patch);

  [[nodiscard]] std::size_t size() const { return positions_.size(); }
  /// Positions of all vectors, in the order in which they were added.
  [[nodiscard]] std::span<const glm::vec3> positions() const { return positions_; }
  [[nodiscard]] std::span<const glm::vec3> normals() const { return normals_; }
  [[nodiscard]] std::span<const float> weights() const { return weights_; }  // as received
  [[nodiscard]] std::span<const std::uint8_t> colors() const { return colors_; }

  /// Returns the scaled weights of all vectors. Each is > 0, unless it is below the range of float. Runs in O(size()).
  [[nodiscard]] std::vector<float> conserved_weights();

 private:
  struct Node {
    std::uint32_t parent = 0;
    std::uint8_t depth = 0;
    std::array<std::uint32_t, 8> children{};  // indices of nodes; 0 means none, since the root is not a child
    double weight = 0;  // total weight, from the first header that has one; for the root, from the description
    bool known = false;  // `weight` was received
  };
  using HeaderBits = std::array<std::uint32_t, 12>;
  // Sums over vectors; each array has one entry per node.
  struct Sums {
    std::vector<std::uint32_t> vectors;  // number of received vectors in the cell
    std::vector<bool> stands;
    std::vector<std::uint32_t> owner;  // deepest standing cell among the node and its ancestors
    std::vector<double> own;  // received weight of the vectors that belong to the cell
    std::vector<double> inside;  // total weight of the nearest standing cells inside the cell
  };

  [[nodiscard]] std::uint32_t node_of(const RecordsCell& cell);
  static HeaderBits bits_of(const RecordsHeader& header);
  void descend();
  [[nodiscard]] Sums sum() const;
  [[nodiscard]] std::vector<double> factors(const Sums& sums) const;

  RecordsCube cube_;
  std::vector<Node> nodes_;  // parents precede their children
  std::map<HeaderBits, std::vector<bool>> chunks_;  // flags of the received records of each chunk
  std::vector<glm::vec3> positions_, normals_;
  std::vector<float> weights_;
  std::vector<std::uint8_t> colors_;
  std::vector<std::array<std::uint32_t, 3>> cells_;  // cell at depth 20 of each vector
  std::vector<std::uint32_t> deepest_;  // deepest node that contains each vector
};

}  // namespace gs::qnv
