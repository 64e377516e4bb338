#include "qnv/codecs/octree/decode/packed_kernels.h"

#include <algorithm>

namespace gs::qnv {
namespace {

void occupancy(RansDecoder& shared, const std::uint32_t* probabilities, const PackedVoxels& from, std::size_t first,
               std::size_t count, std::uint8_t* masks) {
  RansDecoder rans = shared;  // copies the decoder, so that the copy stays in registers
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

void inherit_around(const PackedVoxels& from, std::size_t first, std::size_t count, const std::uint8_t* masks,
                    const PlaneBlock& block, bool normals, bool offsets, const PackedKernels::Inherited& to) {
  inherit(from, first, count, masks, to);
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const int u = from.u[first + i], v = from.v[first + i], offset = from.offset[first + i];
    const FaceChanges changes = face_changes(u, v, offset, block.around(i));
    for (unsigned c = 0; c < 8; ++c) {
      if ((masks[i] >> c & 1) == 0) continue;
      const PredictedPlane plane = predicted_plane(u, v, offset, changes, c, normals, offsets);
      to.u[next] = static_cast<std::int16_t>(plane.u);
      to.v[next] = static_cast<std::int16_t>(plane.v);
      to.offset[next] = static_cast<std::int8_t>(plane.offset);
      ++next;
    }
  }
}

void turn(std::int16_t* u, std::int16_t* v, std::uint8_t* state, const std::int16_t* du, const std::int16_t* dv,
          int step, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    int a = u[i] + du[i] * step, b = v[i] + dv[i] * step;
    wrap_octahedral(a, b);
    u[i] = static_cast<std::int16_t>(a);
    v[i] = static_cast<std::int16_t>(b);
    const int size = std::max(std::abs(static_cast<int>(du[i])), std::abs(static_cast<int>(dv[i])));
    state[i] = static_cast<std::uint8_t>(state[i] | std::min(static_cast<int>(kActivity), size));
  }
}

void move(std::int8_t* offset, const std::int16_t* residual, int step, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i)
    offset[i] = static_cast<std::int8_t>(clamp_offset(offset[i] + residual[i] * step));
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
  static constexpr PackedKernels kKernels{occupancy, inherit, inherit_around, turn, move, residuals};
  return kKernels;
}

const PackedKernels& packed_kernels() {
  static const PackedKernels& best = packed_kernels_avx2() ? *packed_kernels_avx2() : packed_kernels_scalar();
  return best;
}

}  // namespace gs::qnv
