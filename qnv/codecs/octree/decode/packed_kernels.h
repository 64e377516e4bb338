#pragma once

#include "qnv/codecs/octree/packed_layout.h"
#include "qnv/codecs/octree/packed_neighbours.h"

#include <cstddef>
#include <cstdint>

namespace gs::qnv {

// Inner loops of the packed decoder, in a portable and an AVX2 version. Both give the same bits.

/// Number of entries after the last one that the loops may write in output arrays.
constexpr std::size_t kKernelSlack = 16;

struct PackedKernels {
  /// Decodes one byte per parent: the mask of its existing children. `probabilities` is the table of one occupancy
  /// model.
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
  /// Computes the values that children inherit, like `inherit`. Also uses neighbours to predict normals, offsets or
  /// both.
  void (*inherit_around)(const PackedVoxels& from, std::size_t first, std::size_t count, const std::uint8_t* masks,
                         const PlaneBlock& block, bool normals, bool offsets, const Inherited& to);
  /// Adds residuals times a step to n normals. Stores the size class of the residuals in bits 0 and 1 of `state`.
  void (*turn)(std::int16_t* u, std::int16_t* v, std::uint8_t* state, const std::int16_t* du, const std::int16_t* dv,
               int step, std::size_t n);
  /// Adds residuals times a step to n offsets.
  void (*move)(std::int8_t* offset, const std::int16_t* residual, int step, std::size_t n);
  /// Decodes n residuals, eight lanes at a time. `models` has the model of each context. In the stream, the symbols of
  /// a group of eight precede the escaped values of the group.
  void (*residuals)(RansDecoder& rans, const std::uint32_t* models, const std::uint8_t* context, std::size_t n,
                    std::int16_t* out);
};

[[nodiscard]] const PackedKernels& packed_kernels();  // fastest version that this machine supports
[[nodiscard]] const PackedKernels& packed_kernels_scalar();  // portable version, for comparison
/// Returns the AVX2 version; nullptr if the machine has no AVX2.
[[nodiscard]] const PackedKernels* packed_kernels_avx2();

/// Like decode_cluster(payload, parent), with the given inner loops.
[[nodiscard]] std::variant<Cluster, PackedError> decode_cluster(std::span<const std::byte> payload,
                                                                const Cluster* parent, const PackedKernels& kernels);

}  // namespace gs::qnv
