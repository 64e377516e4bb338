#include "qnv/packed/packed_kernels.h"

#include <algorithm>

namespace gs::qnv {
namespace {

void occupancy(RansDecoder& shared, const std::uint32_t* probabilities, const PackedVoxels& from, std::size_t first,
               std::size_t count, std::uint8_t* masks) {
  RansDecoder rans = shared;  // a copy of one's own stays in registers
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<int, 3> normal = octahedral_normal(from.u[first + i], from.v[first + i]);
    const int offset = from.offset[first + i];
    unsigned mask = 0;
    for (unsigned c = 0; c < 8; ++c) {
      const std::uint32_t probability = probabilities[occupancy_bin(along(normal, c), offset)];
      const bool there = rans.peek(c) < probability;
      rans.advance(c, there ? 0 : probability, there ? probability : kRansTotal - probability);
      mask |= (there ? 1u : 0u) << c;
    }
    masks[i] = static_cast<std::uint8_t>(mask);
  }
  shared = rans;
}

void inherit(const PackedVoxels& from, std::size_t first, std::size_t count, const std::uint8_t* masks,
             const PackedKernels::Inherited& to) {
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t p = first + i;
    const std::array<int, 3> normal = octahedral_normal(from.u[p], from.v[p]);
    for (unsigned c = 0; c < 8; ++c) {
      if ((masks[i] >> c & 1) == 0) continue;
      to.x[next] = static_cast<std::uint16_t>(from.x[p] * 2 + (c & 1));
      to.y[next] = static_cast<std::uint16_t>(from.y[p] * 2 + (c >> 1 & 1));
      to.z[next] = static_cast<std::uint16_t>(from.z[p] * 2 + (c >> 2));
      to.u[next] = from.u[p];
      to.v[next] = from.v[p];
      to.offset[next] = static_cast<std::int8_t>(predicted_offset(along(normal, c), from.offset[p]));
      to.context[next] = static_cast<std::uint8_t>(residual_context(from.state[p]));
      to.parent[next] = static_cast<std::uint16_t>(p);
      ++next;
    }
  }
}

void residuals(RansDecoder& shared, const std::uint32_t* models, const std::uint8_t* context, std::size_t n,
               std::int16_t* out) {
  RansDecoder rans = shared;
  const std::uint32_t* const slots = residual_slots();
  for (std::size_t i = 0; i < n; i += kRansLanes) {
    const std::size_t lanes = std::min(kRansLanes, n - i);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::uint32_t slot = rans.peek(lane);
      const std::uint32_t entry = slots[models[context[i + lane]] * kRansTotal + slot];
      rans.advance(lane, slot - (entry & 0xfff), entry >> 12 & 0x1fff);
      out[i + lane] = static_cast<std::int16_t>(entry >> 25);
    }
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      auto code = static_cast<std::uint32_t>(out[i + lane]);
      if (code == kEscape) code = rans.get_bits(lane, kEscapeBits);
      out[i + lane] = static_cast<std::int16_t>(unzigzag(code));
    }
  }
  shared = rans;
}

}  // namespace

const PackedKernels& packed_kernels_scalar() {
  static constexpr PackedKernels kKernels{occupancy, inherit, residuals};
  return kKernels;
}

const PackedKernels& packed_kernels() {
  static const PackedKernels& best = packed_kernels_avx2() ? *packed_kernels_avx2() : packed_kernels_scalar();
  return best;
}

}  // namespace gs::qnv
