#include "qnv/sampling/volume/gradient_row.h"

#include <algorithm>
#include <cmath>
#include <limits>

#if defined(__x86_64__)
#include <immintrin.h>
#define GHOSTSPACE_AVX2 __attribute__((target("avx2")))
#define GHOSTSPACE_AVX2_INLINE __attribute__((target("avx2"), always_inline)) inline
#endif

namespace gs::qnv {
namespace {

constexpr double kLargestLength = std::numeric_limits<float>::max();

// Returns the central difference. Uses the voxel itself instead of a missing neighbour; the step is then one voxel
// instead of two.
inline double difference(float before, float here, float after, double factor) {
  const bool both = before == before && after == after;
  const double low = before == before ? before : here;
  const double high = after == after ? after : here;
  return (high - low) * (both ? factor : 1.0);
}

inline float magnitude_of(const glm::dvec3& g) {
  return static_cast<float>(std::min(std::sqrt((g.x * g.x + g.y * g.y) + g.z * g.z), kLargestLength));
}

inline float magnitude_at(const GradientRow& row, std::uint32_t x, const glm::dmat3& to_world) {
  return magnitude_of(gradient_at(row, x, to_world));
}

#if defined(__x86_64__)

GHOSTSPACE_AVX2_INLINE __m256d load(const float* from) { return _mm256_cvtps_pd(_mm_loadu_ps(from)); }

template <bool gaps>
GHOSTSPACE_AVX2_INLINE __m256d difference(const float* before, __m256d here, const float* after, __m256d factor) {
  __m256d low = load(before), high = load(after);
  if constexpr (gaps) {
    const __m256d low_there = _mm256_cmp_pd(low, low, _CMP_ORD_Q), high_there = _mm256_cmp_pd(high, high, _CMP_ORD_Q);
    low = _mm256_blendv_pd(here, low, low_there);
    high = _mm256_blendv_pd(here, high, high_there);
    factor = _mm256_blendv_pd(_mm256_set1_pd(1.0), factor, _mm256_and_pd(low_there, high_there));
  }
  return _mm256_mul_pd(_mm256_sub_pd(high, low), factor);
}

template <bool gaps>
GHOSTSPACE_AVX2 void interior_avx2(const GradientRow& row, const glm::dmat3& m, std::uint32_t end, float* out) {
  __m256d columns[3][3];
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) columns[c][r] = _mm256_set1_pd(m[c][r]);
  const __m256d half = _mm256_set1_pd(0.5), factor_y = _mm256_set1_pd(row.factor[0]),
                factor_z = _mm256_set1_pd(row.factor[1]), most = _mm256_set1_pd(kLargestLength);
  for (std::uint32_t x = 1; x < end; x += 4) {
    const __m256d here = load(row.here + x);
    const __m256d d[3] = {difference<gaps>(row.here + x - 1, here, row.here + x + 1, half),
                          difference<gaps>(row.before[0] + x, here, row.after[0] + x, factor_y),
                          difference<gaps>(row.before[1] + x, here, row.after[1] + x, factor_z)};
    __m256d g[3];
    for (int r = 0; r < 3; ++r)
      g[r] = _mm256_add_pd(_mm256_add_pd(_mm256_mul_pd(columns[0][r], d[0]), _mm256_mul_pd(columns[1][r], d[1])),
                           _mm256_mul_pd(columns[2][r], d[2]));
    const __m256d square =
        _mm256_add_pd(_mm256_add_pd(_mm256_mul_pd(g[0], g[0]), _mm256_mul_pd(g[1], g[1])), _mm256_mul_pd(g[2], g[2]));
    __m256d length = _mm256_min_pd(_mm256_sqrt_pd(square), most);
    if constexpr (gaps) length = _mm256_and_pd(length, _mm256_cmp_pd(here, here, _CMP_ORD_Q));
    _mm_storeu_ps(out + x, _mm256_cvtpd_ps(length));
  }
}

#endif

}  // namespace

glm::dvec3 gradient_at(const GradientRow& row, std::uint32_t x, const glm::dmat3& m) {
  const float here = row.here[x];
  if (here != here) return glm::dvec3(0);
  const bool first = x == 0, last = x + 1 == row.count;
  const double dx =
      difference(first ? here : row.here[x - 1], here, last ? here : row.here[x + 1], first || last ? 1.0 : 0.5);
  const double dy = difference(row.before[0][x], here, row.after[0][x], row.factor[0]);
  const double dz = difference(row.before[1][x], here, row.after[1][x], row.factor[1]);
  return {(m[0].x * dx + m[1].x * dy) + m[2].x * dz, (m[0].y * dx + m[1].y * dy) + m[2].y * dz,
          (m[0].z * dx + m[1].z * dy) + m[2].z * dz};
}

void magnitudes_portable(const GradientRow& row, const glm::dmat3& to_world, bool, float* out) {
  for (std::uint32_t x = 0; x < row.count; ++x) out[x] = magnitude_at(row, x, to_world);
}

#if defined(__x86_64__)

bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2");
  return has;
}

void magnitudes_avx2(const GradientRow& row, const glm::dmat3& to_world, bool gaps, float* out) {
  const std::uint32_t inside = row.count < 2 ? 0 : (row.count - 2) / 4 * 4, end = 1 + inside;
  if (gaps)
    interior_avx2<true>(row, to_world, end, out);
  else
    interior_avx2<false>(row, to_world, end, out);
  out[0] = magnitude_at(row, 0, to_world);
  for (std::uint32_t x = end; x < row.count; ++x) out[x] = magnitude_at(row, x, to_world);
}

#else

bool has_avx2() { return false; }
void magnitudes_avx2(const GradientRow& row, const glm::dmat3& to_world, bool gaps, float* out) {
  magnitudes_portable(row, to_world, gaps, out);
}

#endif

void magnitudes(const GradientRow& row, const glm::dmat3& to_world, bool gaps, float* out) {
  if (has_avx2())
    magnitudes_avx2(row, to_world, gaps, out);
  else
    magnitudes_portable(row, to_world, gaps, out);
}

}  // namespace gs::qnv
