#pragma once

#include "vrml/mesh/attribute.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::vrml {

/// Key of a mesh vertex: an index in each of the node's arrays, or kMissing.
struct VertexParts {
  std::uint32_t position = 0;
  std::uint32_t normal = kMissing;
  std::uint32_t color = kMissing;
  std::uint32_t texture_coordinate = kMissing;
  friend bool operator==(const VertexParts&, const VertexParts&) = default;
};

/// Welder that gives corners with equal parts the same vertex.
///
/// Vertices with an equal value in one chosen part form a chain. Chains are short unless many vertices share that value
/// but differ in other parts. The search stops after kLongestChain vertices, so that hostile input is not slow.
class Welder {
 public:
  explicit Welder(std::size_t chains) : first_(chains, kMissing) {
    vertices_.reserve(chains);
    next_.reserve(chains);
  }

  /// Returns the vertex with these parts. Adds a vertex if there is none. `chain` is the value of the chosen part; it
  /// is less than the number of chains.
  [[nodiscard]] std::uint32_t add(const VertexParts& parts, std::size_t chain) {
    std::uint32_t vertex = first_[chain];
    for (int step = 0; vertex != kMissing && step < kLongestChain; ++step) {
      if (vertices_[vertex] == parts) return vertex;
      vertex = next_[vertex];
    }
    const auto fresh = static_cast<std::uint32_t>(vertices_.size());
    vertices_.push_back(parts);
    next_.push_back(first_[chain]);
    first_[chain] = fresh;
    return fresh;
  }

  [[nodiscard]] std::span<const VertexParts> vertices() const { return vertices_; }

 private:
  static constexpr int kLongestChain = 16;
  std::vector<std::uint32_t> first_;  // first vertex of each chain
  std::vector<std::uint32_t> next_;  // next vertex in the chain of each vertex
  std::vector<VertexParts> vertices_;
};

/// Returns one element of `values` per vertex, at the index in `part`. For kMissing, the element is `filling`.
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
