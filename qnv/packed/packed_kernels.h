#pragma once

#include "qnv/packed/packed_layout.h"
#include "qnv/packed/packed_neighbours.h"

#include <cstddef>
#include <cstdint>

namespace gs::qnv {

// The inner loops of the packed decoder, once for every machine and once for AVX2; both give the same bits.

/// One level of one cluster while it is decoded. Arrays that are written have room for kKernelSlack entries more.
constexpr std::size_t kKernelSlack = 16;

struct PackedKernels {
  /// One byte a parent: which of its children there are. `probabilities` are those of one occupancy model.
  void (*occupancy)(RansDecoder& rans, const std::uint32_t* probabilities, const PackedVoxels& from, std::size_t first,
                    std::size_t count, std::uint8_t* masks);
  /// What children inherit: cell, predicted normal and offset, context of the residuals, index of the parent.
  struct Inherited {
    std::uint16_t *x, *y, *z;
    std::int16_t *u, *v;
    std::int8_t* offset;
    std::uint8_t* context;
    std::uint16_t* parent;
  };
  void (*inherit)(const PackedVoxels& from, std::size_t first, std::size_t count, const std::uint8_t* masks,
                  const Inherited& to);
  /// The same, predicted from neighbours: normals, offsets or both.
  void (*inherit_around)(const PackedVoxels& from, std::size_t first, std::size_t count, const std::uint8_t* masks,
                         const PlaneBlock& block, bool normals, bool offsets, const Inherited& to);
  /// Adds residuals times a step to n normals, and puts how large they were into bits 0 and 1 of the states.
  void (*turn)(std::int16_t* u, std::int16_t* v, std::uint8_t* state, const std::int16_t* du, const std::int16_t* dv,
               int step, std::size_t n);
  /// Adds residuals times a step to n offsets.
  void (*move)(std::int8_t* offset, const std::int16_t* residual, int step, std::size_t n);
  /// n residuals, eight lanes at a time; `models` are the numbers of the models by context. A group's symbols come
  /// first, then what of them was escaped.
  void (*residuals)(RansDecoder& rans, const std::uint32_t* models, const std::uint8_t* context, std::size_t n,
                    std::int16_t* out);
};

[[nodiscard]] const PackedKernels& packed_kernels();         // the best for this machine
[[nodiscard]] const PackedKernels& packed_kernels_scalar();  // for comparison
/// Null where the machine has no AVX2.
[[nodiscard]] const PackedKernels* packed_kernels_avx2();

/// decode_cluster with chosen inner loops.
[[nodiscard]] std::variant<Cluster, PackedError> decode_cluster(std::span<const std::byte> payload,
                                                                const Cluster* parent, const PackedKernels& kernels);

}  // namespace gs::qnv
