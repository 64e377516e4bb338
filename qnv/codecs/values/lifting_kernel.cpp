#include "qnv/codecs/values/lifting_kernel.h"

#include "qnv/sampling/volume/gradient_row.h"

#if defined(__x86_64__)
#include <immintrin.h>
#define GHOSTSPACE_AVX2 __attribute__((target("avx2")))
#define GHOSTSPACE_AVX2_INLINE __attribute__((target("avx2"), always_inline)) inline
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

#if defined(__x86_64__)

GHOSTSPACE_AVX2_INLINE __m256i load(const std::int32_t* from) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
}
GHOSTSPACE_AVX2_INLINE void store(std::int32_t* to, __m256i value) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), value);
}

// Returns change_of() for eight samples. The lower 14 bits and a 1 are multiplied in halves of 16 bits.
GHOSTSPACE_AVX2_INLINE __m256i change_of(__m256i a, __m256i b, std::int32_t factor) {
  const __m256i sum = _mm256_add_epi32(a, b);
  const __m256i upper = _mm256_mullo_epi32(_mm256_srai_epi32(sum, 14), _mm256_set1_epi32(factor));
  const __m256i lower = _mm256_or_si256(_mm256_and_si256(sum, _mm256_set1_epi32(16383)), _mm256_set1_epi32(1 << 16));
  const __m256i both = _mm256_set1_epi32((factor & 65535) | 8192 << 16);
  return _mm256_add_epi32(upper, _mm256_srai_epi32(_mm256_madd_epi16(lower, both), 14));
}

GHOSTSPACE_AVX2 std::size_t lift_avx2(std::int32_t* target, const std::int32_t* a, const std::int32_t* b,
                                      std::size_t count, std::int32_t factor, bool undo) {
  const __m256i sign = _mm256_set1_epi32(undo ? -1 : 0);
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    const __m256i change = change_of(load(a + i), load(b + i), factor);
    store(target + i, _mm256_add_epi32(load(target + i), _mm256_sub_epi32(_mm256_xor_si256(change, sign), sign)));
  }
  return i;
}

// Reverts the steps of eight columns in one pass. Each turn takes two rows. Step 3 is complete for the row that it
// takes, step 2 for the odd row before, step 1 for the even row before, and step 0 for the odd row before that.
GHOSTSPACE_AVX2 std::size_t unlift_avx2(std::int32_t* first, std::size_t count, std::size_t stride, std::size_t size) {
  const std::size_t odds = count / 2;
  std::size_t x = 0;
  for (; x + 8 <= size; x += 8) {
    std::int32_t* const column = first + x;
    const auto at = [&](std::size_t row) { return column + row * stride; };
    __m256i odd = load(at(1));  // of the pair before, as it was
    __m256i third = _mm256_sub_epi32(load(at(0)), change_of(odd, odd, kLiftFactors[3]));
    __m256i second{},
        first_even{};  // odd row after step 2, even row after step 1: of two pairs before, of the one before
    for (std::size_t k = 1; k <= odds; ++k) {
      // Pair k may not exist, or have only its even row. Lines continue by reflection.
      const bool even_there = 2 * k < count;
      const __m256i next_odd = k < odds ? load(at(2 * k + 1)) : odd;
      const __m256i next_third =
          even_there ? _mm256_sub_epi32(load(at(2 * k)), change_of(odd, next_odd, kLiftFactors[3])) : third;
      const __m256i next_second = _mm256_sub_epi32(odd, change_of(third, next_third, kLiftFactors[2]));
      const __m256i even =
          _mm256_sub_epi32(third, change_of(k == 1 ? next_second : second, next_second, kLiftFactors[1]));
      store(at(2 * k - 2), even);
      if (k > 1) store(at(2 * k - 3), _mm256_sub_epi32(second, change_of(first_even, even, kLiftFactors[0])));
      odd = next_odd;
      third = next_third;
      second = next_second;
      first_even = even;
    }
    __m256i last = first_even;
    if (count % 2 != 0) {
      last = _mm256_sub_epi32(third, change_of(second, second, kLiftFactors[1]));
      store(at(count - 1), last);
    }
    store(at(2 * odds - 1), _mm256_sub_epi32(second, change_of(first_even, last, kLiftFactors[0])));
  }
  return x;
}

GHOSTSPACE_AVX2 std::size_t interleave_avx2(const std::int32_t* even, const std::int32_t* odd, std::size_t count,
                                            std::int32_t* to) {
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    const __m256i a = load(even + i), b = load(odd + i);
    const __m256i low = _mm256_unpacklo_epi32(a, b), high = _mm256_unpackhi_epi32(a, b);
    store(to + 2 * i, _mm256_permute2x128_si256(low, high, 0x20));
    store(to + 2 * i + 8, _mm256_permute2x128_si256(low, high, 0x31));
  }
  return i;
}

GHOSTSPACE_AVX2 std::size_t separate_avx2(const std::int32_t* from, std::size_t count, std::int32_t* even,
                                          std::int32_t* odd) {
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    const __m256 a = _mm256_castsi256_ps(load(from + 2 * i)), b = _mm256_castsi256_ps(load(from + 2 * i + 8));
    const __m256i evens = _mm256_castps_si256(_mm256_shuffle_ps(a, b, 0x88)),
                  odds = _mm256_castps_si256(_mm256_shuffle_ps(a, b, 0xdd));
    store(even + i, _mm256_permute4x64_epi64(evens, 0xd8));
    store(odd + i, _mm256_permute4x64_epi64(odds, 0xd8));
  }
  return i;
}

#else

std::size_t lift_avx2(std::int32_t*, const std::int32_t*, const std::int32_t*, std::size_t, std::int32_t, bool) {
  return 0;
}
std::size_t unlift_avx2(std::int32_t*, std::size_t, std::size_t, std::size_t) { return 0; }
std::size_t interleave_avx2(const std::int32_t*, const std::int32_t*, std::size_t, std::int32_t*) { return 0; }
std::size_t separate_avx2(const std::int32_t*, std::size_t, std::int32_t*, std::int32_t*) { return 0; }

#endif

}  // namespace

void lift_portable(std::int32_t* target, const std::int32_t* a, const std::int32_t* b, std::size_t count,
                   std::size_t step, bool undo) {
  const auto factor = static_cast<std::uint32_t>(kLiftFactors[step]);
  const std::uint32_t sign = undo ? ~0u : 0;
  for (std::size_t i = 0; i < count; ++i)
    target[i] = static_cast<std::int32_t>(static_cast<std::uint32_t>(target[i]) +
                                          ((change_of(a[i], b[i], factor) ^ sign) - sign));
}

void lift(std::int32_t* target, const std::int32_t* a, const std::int32_t* b, std::size_t count, std::size_t step,
          bool undo) {
  const std::size_t done = has_avx2() ? lift_avx2(target, a, b, count, kLiftFactors[step], undo) : 0;
  lift_portable(target + done, a + done, b + done, count - done, step, undo);
}

void unlift_rows_portable(std::int32_t* first, std::size_t count, std::size_t stride, std::size_t size) {
  if (count < 2 || size == 0) return;
  for (std::size_t step = 4; step-- > 0;)
    for (std::size_t i = step % 2 == 0 ? 1 : 0; i < count; i += 2) {
      const std::size_t before = i > 0 ? i - 1 : 1;
      const std::size_t after = i + 1 < count ? i + 1 : i - 1;
      lift_portable(first + i * stride, first + before * stride, first + after * stride, size, step, true);
    }
}

void unlift_rows(std::int32_t* first, std::size_t count, std::size_t stride, std::size_t size) {
  if (count < 2) return;
  const std::size_t done = has_avx2() ? unlift_avx2(first, count, stride, size) : 0;
  unlift_rows_portable(first + done, count, stride, size - done);
}

void interleave_portable(const std::int32_t* even, const std::int32_t* odd, std::size_t count, std::int32_t* to) {
  for (std::size_t i = 0; i < count; ++i) {
    to[2 * i] = even[i];
    to[2 * i + 1] = odd[i];
  }
}

void interleave(const std::int32_t* even, const std::int32_t* odd, std::size_t count, std::int32_t* to) {
  const std::size_t done = has_avx2() ? interleave_avx2(even, odd, count, to) : 0;
  interleave_portable(even + done, odd + done, count - done, to + 2 * done);
}

void separate_portable(const std::int32_t* from, std::size_t count, std::int32_t* even, std::int32_t* odd) {
  for (std::size_t i = 0; i < count; ++i) {
    even[i] = from[2 * i];
    odd[i] = from[2 * i + 1];
  }
}

void separate(const std::int32_t* from, std::size_t count, std::int32_t* even, std::int32_t* odd) {
  const std::size_t done = has_avx2() ? separate_avx2(from, count, even, odd) : 0;
  separate_portable(from + 2 * done, count - done, even + done, odd + done);
}

}  // namespace gs::qnv::values
