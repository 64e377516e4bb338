#pragma once

#include "qnv/codecs/octree/packed_layout.h"
#include "qnv/codecs/octree/packed_neighbours.h"

#include <cstddef>
#include <cstdint>

namespace gs::qnv {

// Inner loops of the packed decoder, portable and for AVX2. Both give the same bits.

/// Operations on one level of one cluster. Output arrays must have room for kKernelSlack more entries.
constexpr std::size_t kKernelSlack = 16;

struct PackedKernels {
  /// Decodes one byte per parent: the mask of existing children. `probabilities` are those of one occupancy model.
  void (*occupancy)(RansDecoder& rans, const std::uint32_t* probabilities, const PackedVoxels& from, std::size_t first,
                    std::size_t count, std::uint8_t* masks);
  /// Values that children inherit: cell, predicted normal and offset, residual context, parent index.
  struct Inherited {
    std::uint16_t *x, *y, *z;
    std::int16_t *u, *v;
    std::int8_t* offset;
    std::uint8_t* context;
    std::uint16_t* parent;
  };
  void (*inherit)(const PackedVoxels& from, std::size_t first, std::size_t count, const std::uint8_t* masks,
                  const Inherited& to);
  /// Like `inherit`, but predicts normals, offsets or both from neighbours too.
  void (*inherit_around)(const PackedVoxels& from, std::size_t first, std::size_t count, const std::uint8_t* masks,
                         const PlaneBlock& block, bool normals, bool offsets, const Inherited& to);
  /// Adds residuals times a step to n normals. Stores the size of the residuals in bits 0 and 1 of the states.
  void (*turn)(std::int16_t* u, std::int16_t* v, std::uint8_t* state, const std::int16_t* du, const std::int16_t* dv,
               int step, std::size_t n);
  /// Adds residuals times a step to n offsets.
  void (*move)(std::int8_t* offset, const std::int16_t* residual, int step, std::size_t n);
  /// Decodes n residuals, eight lanes at a time. `models` maps contexts to models. The symbols of a group come first,
  /// then its escaped values.
  void (*residuals)(RansDecoder& rans, const std::uint32_t* models, const std::uint8_t* context, std::size_t n,
                    std::int16_t* out);
};

[[nodiscard]] const PackedKernels& packed_kernels();         // fastest on this machine
[[nodiscard]] const PackedKernels& packed_kernels_scalar();  // for comparison
/// Returns nullptr if the machine has no AVX2.
[[nodiscard]] const PackedKernels* packed_kernels_avx2();

/// Like decode_cluster(payload, parent), with the given inner loops.
[[nodiscard]] std::variant<Cluster, PackedError> decode_cluster(std::span<const std::byte> payload,
                                                                const Cluster* parent, const PackedKernels& kernels);

}  // namespace gs::qnv
