#include "qnv/codecs/records/decode/records_assembly.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace gs::qnv {
namespace {

constexpr std::uint32_t kNoOwner = ~0u;

unsigned octant_at(const std::array<std::uint32_t, 3>& cell, unsigned depth) {
  const unsigned shift = kDeepestRecordsCell - depth;
  return (cell[0] >> shift & 1) | (cell[1] >> shift & 1) << 1 | (cell[2] >> shift & 1) << 2;
}

}  // namespace

RecordsAssembly::RecordsAssembly(const Description& description) : cube_(description.box), nodes_(1) {
  nodes_[0].known = description.total > 0 && std::isfinite(description.total);
  if (nodes_[0].known) nodes_[0].weight = description.total;
}

std::uint32_t RecordsAssembly::node_of(const RecordsCell& cell) {
  const unsigned up = kDeepestRecordsCell - cell.depth;
  const std::array<std::uint32_t, 3> at{cell.x << up, cell.y << up, cell.z << up};
  std::uint32_t node = 0;
  for (unsigned depth = 1; depth <= cell.depth; ++depth) {
    const unsigned octant = octant_at(at, depth);
    if (nodes_[node].children[octant] == 0) {
      nodes_[node].children[octant] = static_cast<std::uint32_t>(nodes_.size());
      nodes_.push_back({});
      nodes_.back().depth = static_cast<std::uint8_t>(depth);
      nodes_.back().parent = node;
    }
    node = nodes_[node].children[octant];
  }
  return node;
}

RecordsAssembly::HeaderBits RecordsAssembly::bits_of(const RecordsHeader& h) {
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  return {h.layer | std::uint32_t{h.cell.depth} << 8 | std::uint32_t{h.count} << 16,
          h.cell.x,
          h.cell.y,
          h.cell.z,
          bits(h.frame.lower.x),
          bits(h.frame.lower.y),
          bits(h.frame.lower.z),
          bits(h.frame.cell.x),
          bits(h.frame.cell.y),
          bits(h.frame.cell.z),
          bits(h.frame.weight_step),
          bits(h.cell_weight)};
}

std::size_t RecordsAssembly::add(const RecordsPatch& patch) {
  const std::size_t before = size();
  if (patch.size() == 0 || nodes_.size() + kDeepestRecordsCell > kMaxNodes) return 0;
  const RecordsHeader& header = patch.header;
  const std::uint32_t node = node_of(header.cell);
  if (!nodes_[node].known && header.cell_weight > 0) {
    nodes_[node].known = true;
    nodes_[node].weight = header.cell_weight;
  }
  std::vector<bool>& arrived = chunks_[bits_of(header)];
  arrived.resize(header.count);
  for (std::size_t i = 0; i < patch.size(); ++i) {
    const std::size_t index = patch.indices[i];
    if (index >= arrived.size() || arrived[index]) continue;
    arrived[index] = true;
    positions_.push_back(patch.positions[i]);
    normals_.push_back(patch.normals[i]);
    weights_.push_back(patch.weights[i]);
    colors_.push_back(patch.colors[i]);
    cells_.push_back(cube_.cell_of(patch.positions[i], header.cell));
    deepest_.push_back(node);
  }
  return size() - before;
}

// Moves vectors to deeper nodes that were created after the vectors were added.
void RecordsAssembly::descend() {
  for (std::size_t i = 0; i < size(); ++i) {
    std::uint32_t node = deepest_[i];
    while (nodes_[node].depth < kDeepestRecordsCell) {
      const std::uint32_t child = nodes_[node].children[octant_at(cells_[i], nodes_[node].depth + 1u)];
      if (child == 0) break;
      node = child;
    }
    deepest_[i] = node;
  }
}

RecordsAssembly::Sums RecordsAssembly::sum() const {
  const std::size_t count = nodes_.size();
  Sums sums{std::vector<std::uint32_t>(count), std::vector<bool>(count), std::vector<std::uint32_t>(count, kNoOwner),
            std::vector<double>(count), std::vector<double>(count)};
  for (const std::uint32_t node : deepest_) ++sums.vectors[node];
  for (std::size_t node = count; --node > 0;) sums.vectors[nodes_[node].parent] += sums.vectors[node];
  for (std::size_t node = 0; node < count; ++node) {
    const std::uint32_t around = node == 0 ? kNoOwner : sums.owner[nodes_[node].parent];
    sums.stands[node] =
        nodes_[node].known && sums.vectors[node] > 0 && (around == kNoOwner || sums.vectors[node] >= kMinVectors);
    sums.owner[node] = sums.stands[node] ? static_cast<std::uint32_t>(node) : around;
    if (sums.stands[node] && around != kNoOwner) sums.inside[around] += nodes_[node].weight;
  }
  for (std::size_t i = 0; i < size(); ++i) {
    const std::uint32_t owner = sums.owner[deepest_[i]];
    if (owner != kNoOwner) sums.own[owner] += weights_[i];
  }
  return sums;
}

// Returns the factor for the weights of the vectors of each node.
std::vector<double> RecordsAssembly::factors(const Sums& sums) const {
  std::vector<double> growth(nodes_.size(), 1), result(nodes_.size(), 1);
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    if (!sums.stands[node]) continue;
    const std::uint32_t around = node == 0 ? kNoOwner : sums.owner[nodes_[node].parent];
    const double given = around == kNoOwner ? 1 : growth[around];
    const double weight = nodes_[node].weight * std::min(given, kLargestGrowth);
    // Uses at least the sum of the received vectors, because the difference of large numbers is inexact.
    const double own = sums.own[node] > 0 ? std::max(nodes_[node].weight - sums.inside[node], sums.own[node]) : 0;
    const double all = own + sums.inside[node];
    growth[node] = all > 0 ? weight / all : 1;
    if (sums.own[node] > 0) result[node] = own / sums.own[node] * growth[node];
  }
  return result;
}

std::vector<float> RecordsAssembly::conserved_weights() {
  descend();
  const Sums sums = sum();
  const std::vector<double> factor = factors(sums);
  std::vector<float> result(size());
  for (std::size_t i = 0; i < size(); ++i) {
    const std::uint32_t owner = sums.owner[deepest_[i]];
    const double weight = owner == kNoOwner ? weights_[i] : weights_[i] * factor[owner];
    result[i] = static_cast<float>(std::min<double>(weight, std::numeric_limits<float>::max()));
  }
  return result;
}

}  // namespace gs::qnv
