#pragma once

#include "vrml/mesh/attribute.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::vrml {

/// What one vertex of a mesh is made of: places in the arrays of the node, or kMissing.
struct VertexParts {
  std::uint32_t position = 0;
  std::uint32_t normal = kMissing;
  std::uint32_t color = kMissing;
  std::uint32_t texture_coordinate = kMissing;
  friend bool operator==(const VertexParts&, const VertexParts&) = default;
};

/// Gives corners that are made of the same parts the same vertex.
///
/// The vertices of one position hang on a chain, which is as short as the position has different
/// looks; a chain longer than kLongestChain is not searched further, so that no input is slow.
class Welder {
 public:
  /// For corners whose `position` is less than `positions`.
  explicit Welder(std::size_t positions) : first_(positions, kMissing) {
    vertices_.reserve(positions);
    next_.reserve(positions);
  }

  [[nodiscard]] std::uint32_t add(const VertexParts& parts) {
    std::uint32_t vertex = first_[parts.position];
    for (int step = 0; vertex != kMissing && step < kLongestChain; ++step) {
      if (vertices_[vertex] == parts) return vertex;
      vertex = next_[vertex];
    }
    const auto fresh = static_cast<std::uint32_t>(vertices_.size());
    vertices_.push_back(parts);
    next_.push_back(first_[parts.position]);
    first_[parts.position] = fresh;
    return fresh;
  }

  [[nodiscard]] std::span<const VertexParts> vertices() const { return vertices_; }

 private:
  static constexpr int kLongestChain = 32;
  std::vector<std::uint32_t> first_;  // by position
  std::vector<std::uint32_t> next_;   // by vertex
  std::vector<VertexParts> vertices_;
};

/// One value a vertex out of `values`, at the place that `part` names; `filling` for kMissing.
template <class T>
[[nodiscard]] Array<T> gather(const Array<T>& values, std::span<const VertexParts> vertices,
                              std::uint32_t VertexParts::*part, const T& filling) {
  Array<T> gathered;
  T* next = gathered.prepare(vertices.size());
  const T* from = values.data();
  for (const VertexParts& vertex : vertices) *next++ = vertex.*part == kMissing ? filling : from[vertex.*part];
  gathered.commit(vertices.size());
  return gathered;
}

}  // namespace gs::vrml
