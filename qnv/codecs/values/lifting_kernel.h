#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace gs::qnv::values {

// Kernels with vector instructions. The portable versions define the results; all versions give the same bits.

/// Factors of the four lifting steps of CDF 9/7 (Daubechies and Sweldens 1998), in 1/16384.
inline constexpr std::array<std::int32_t, 4> kLiftFactors{-25987, -868, 14465, 7266};

/// Adds round(factor (a[i] + b[i]) / 16384) to target[i], or subtracts it, for `count` samples. Arithmetic wraps at 32
/// bits. `a` and `b` may overlap each other.
void lift(std::int32_t* target, const std::int32_t* a, const std::int32_t* b, std::size_t count, std::size_t step,
          bool undo);
void lift_portable(std::int32_t* target, const std::int32_t* a, const std::int32_t* b, std::size_t count,
                   std::size_t step, bool undo);

/// Reverts all lifting steps along `count` rows, `stride` apart, of `size` adjacent samples. Row i has sample i.
void unlift_rows(std::int32_t* first, std::size_t count, std::size_t stride, std::size_t size);
void unlift_rows_portable(std::int32_t* first, std::size_t count, std::size_t stride, std::size_t size);

/// Sets to[2 i] = even[i] and to[2 i + 1] = odd[i] for `count` pairs; and back.
void interleave(const std::int32_t* even, const std::int32_t* odd, std::size_t count, std::int32_t* to);
void interleave_portable(const std::int32_t* even, const std::int32_t* odd, std::size_t count, std::int32_t* to);
void separate(const std::int32_t* from, std::size_t count, std::int32_t* even, std::int32_t* odd);
void separate_portable(const std::int32_t* from, std::size_t count, std::int32_t* even, std::int32_t* odd);

}  // namespace gs::qnv::values
