#include "qnv/codecs/values/lifting_kernel.h"

#include "qnv/sampling/volume/gradient_row.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace gs::qnv::values {

namespace {

std::uint32_t change_of(std::int32_t a, std::int32_t b, std::uint32_t factor) {
  const std::uint32_t sum = static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b);
  // The factor times the upper 18 bits, and times the lower 14 bits: no product of these exceeds 32 bits.
  const std::uint32_t upper = static_cast<std::uint32_t>(static_cast<std::int32_t>(sum) >> 14) * factor;
  const std::uint32_t lower = (sum & 16383) * factor + 8192;
  return upper + static_cast<std::uint32_t>(static_cast<std::int32_t>(lower) >> 14);
}

void lift_portable(std::int32_t* target, const std::int32_t* a, const std::int32_t* b, std::size_t count,
                   std::uint32_t factor, bool undo) {
  const std::uint32_t sign = undo ? ~0u : 0;
  for (std::size_t i = 0; i < count; ++i)
    target[i] = static_cast<std::int32_t>(static_cast<std::uint32_t>(target[i]) +
                                          ((change_of(a[i], b[i], factor) ^ sign) - sign));
}

#if defined(__x86_64__)

__attribute__((target("avx2"))) std::size_t lift_avx2(std::int32_t* target, const std::int32_t* a,
                                                      const std::int32_t* b, std::size_t count, std::uint32_t factor,
                                                      bool undo) {
  const __m256i sign = _mm256_set1_epi32(undo ? -1 : 0), by = _mm256_set1_epi32(static_cast<std::int32_t>(factor)),
                low_bits = _mm256_set1_epi32(16383), half = _mm256_set1_epi32(8192);
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    const __m256i sum = _mm256_add_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(a + i)),
                                         _mm256_loadu_si256(reinterpret_cast<const __m256i*>(b + i)));
    const __m256i upper = _mm256_mullo_epi32(_mm256_srai_epi32(sum, 14), by);
    const __m256i lower = _mm256_add_epi32(_mm256_mullo_epi32(_mm256_and_si256(sum, low_bits), by), half);
    const __m256i change = _mm256_add_epi32(upper, _mm256_srai_epi32(lower, 14));
    const __m256i old = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(target + i));
    const __m256i signed_change = _mm256_sub_epi32(_mm256_xor_si256(change, sign), sign);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(target + i), _mm256_add_epi32(old, signed_change));
  }
  return i;
}

#endif

}  // namespace

void lift(std::int32_t* target, const std::int32_t* a, const std::int32_t* b, std::size_t count, std::size_t step,
          bool undo) {
  const auto factor = static_cast<std::uint32_t>(kLiftFactors[step]);
  std::size_t done = 0;
#if defined(__x86_64__)
  static const bool fast = has_avx2();
  if (fast) done = lift_avx2(target, a, b, count, factor, undo);
#endif
  lift_portable(target + done, a + done, b + done, count - done, factor, undo);
}

}  // namespace gs::qnv::values
