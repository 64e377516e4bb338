#pragma once

#include "qnv/codecs/lossless/exact_mesh.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace gs::qnv::exact {

/// Returns chunk payloads with the position bits that the tail lacks, layer by layer. Each payload is useful alone.
/// `mesh` must be quantized() on the finest lattice. `bits` is the number of bits in the tail. `numbers` are the
/// decoding indices of the vertices, from encode_tail().
[[nodiscard]] std::vector<std::vector<std::byte>> low_bits_of(const ExactMesh& mesh, int bits,
                                                              std::span<const std::uint32_t> numbers);

/// Received low bits. Chunks may be received in any order. Safe for untrusted bytes; memory is bounded.
class LowBits {
 public:
  /// Adds the payload of a low-bits chunk. Returns false if it is invalid.
  bool add(std::span<const std::byte> payload);
  /// Reports whether all bits of a mesh were received.
  [[nodiscard]] bool complete(const ExactMesh& mesh) const;
  /// Sets the positions of `mesh` on the finest lattice. Bits that are not received leave an interval; uses its middle.
  void apply(ExactMesh& mesh) const;

 private:
  std::map<std::pair<int, std::uint32_t>, std::vector<std::byte>> runs_;  // payloads by layer and first vertex
  std::size_t bytes_ = 0;
};

}  // namespace gs::qnv::exact
