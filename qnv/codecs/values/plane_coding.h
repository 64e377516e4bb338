#pragma once

#include "qnv/codecs/values/block_places.h"
#include "qnv/codecs/values/plane_models.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace gs::qnv::values {

// Decisions about the coefficients of one cube in one plane (FORMAT.md, "Values payload"). Encoder and decoder share
// the code. Coefficients are magnitudes with their sign in the highest bit.

inline constexpr std::uint32_t kSign = std::uint32_t{1} << 31;
/// Maximum size of a coefficient in units of the plane, as a neighbour.
inline constexpr std::uint32_t kMaxSize = 4;

/// Encoder's side of a cube.
struct EncodingSide {
  RangeWriter coder;
  const std::uint32_t* values = nullptr;  // of the cube
  int plane = 0;

  bool code(Estimate& model, bool bit) {
    coder.put(bit, static_cast<std::uint32_t>(std::uint64_t{coder.range()} * model.probability() >> 16));
    model.learn(bit);
    return bit;
  }
  /// Codes a decision that is hardly predictable.
  std::uint32_t code_even(Estimate& model, bool bit) { return code(model, bit) ? 1 : 0; }
  /// Codes a decision that is not predictable, without an estimate.
  std::uint32_t code_bit(bool bit) {
    coder.put(bit, coder.range() >> 1);
    return bit ? 1 : 0;
  }
  [[nodiscard]] bool bit(std::size_t i) const { return (values[i] >> plane & 1) != 0; }
  /// Reports whether any of four coefficients that are zero so far gets its first bit.
  [[nodiscard]] bool any(std::size_t i) const {
    return ((values[i] | values[i + 1] | values[i + 2] | values[i + 3]) & ~kSign) >> plane != 0;
  }
  void start(std::size_t i) { code_bit(values[i] >> 31 != 0); }
  void add(std::size_t, std::uint32_t) {}
};

/// Decoder's side of a cube.
struct DecodingSide {
  RangeReader coder;
  std::uint32_t* values = nullptr;  // of the cube, with the bits known so far
  int plane = 0;

  bool code(Estimate& model, bool) {
    const auto bound = static_cast<std::uint32_t>(std::uint64_t{coder.range()} * model.probability() >> 16);
    if (coder.get(bound)) {
      model.learn(true);
      return true;
    }
    model.learn(false);
    return false;
  }
  std::uint32_t code_even(Estimate& model, bool) {
    const std::uint32_t bit =
        coder.get_even(static_cast<std::uint32_t>(std::uint64_t{coder.range()} * model.probability() >> 16));
    model.learn(bit != 0);
    return bit;
  }
  std::uint32_t code_bit(bool) { return coder.get_bit(); }
  [[nodiscard]] bool bit(std::size_t) const { return false; }
  [[nodiscard]] bool any(std::size_t) const { return false; }
  void start(std::size_t i) { values[i] = 1u << plane | coder.get_bit() << 31; }
  void add(std::size_t i, std::uint32_t bit) { values[i] |= bit << plane; }
};

/// Sizes of the coefficients of a cube in the buffer of their block.
struct CubeSizes {
  std::uint8_t* first = nullptr;  // of the first coefficient
  std::uint32_t row = 0, slice = 0;
  std::array<std::uint8_t, 3> size{};
};

/// Codes one plane of a cube. `highs` is the number of axes on which its band is high.
void code_cube(EncodingSide& side, PlaneModels& models, std::uint32_t highs, const CubeSizes& cube);
void code_cube(DecodingSide& side, PlaneModels& models, std::uint32_t highs, const CubeSizes& cube);

}  // namespace gs::qnv::values
