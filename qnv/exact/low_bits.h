#pragma once

#include "qnv/exact/exact_mesh.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace gs::qnv::exact {

/// What finer lattices add to a tail, bit by bit of all places: payloads of chunks, any of which is of use. `mesh`: as
/// quantized, on the finest lattice; `bits`: of the tail; `numbers`: of its vertices in the tail, as encode_tail says.
[[nodiscard]] std::vector<std::vector<std::byte>> low_bits_of(const ExactMesh& mesh, int bits,
                                                              std::span<const std::uint32_t> numbers);

/// Such bits as they come, in any order. Safe for untrusted bytes; holds what came, and no more than so much.
class LowBits {
 public:
  /// The payload of a chunk. False where it is none.
  bool add(std::span<const std::byte> payload);
  /// Whether all that a mesh has room for has come.
  [[nodiscard]] bool complete(const ExactMesh& mesh) const;
  /// Places as exactly as they are known, on the mesh's finest lattice: the middle of what may be meant.
  void apply(ExactMesh& mesh) const;

 private:
  std::map<std::pair<int, std::uint32_t>, std::vector<std::byte>> runs_;  // by layer and first vertex
  std::size_t bytes_ = 0;
};

}  // namespace gs::qnv::exact
