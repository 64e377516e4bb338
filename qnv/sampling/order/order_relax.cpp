#include "qnv/sampling/order/order_spread.h"

#include <algorithm>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace gs::qnv::order {
namespace {

constexpr float kAway = -0.25f;  // below this cosine, two normals face away from each other

}  // namespace

void relax_portable(const Points& points, std::size_t first, std::size_t last, const Centre& centre, bool surface,
                    float* gaps) {
  for (std::size_t i = first; i < last; ++i) {
    const float dx = points.x[i] - centre.x, dy = points.y[i] - centre.y, dz = points.z[i] - centre.z;
    const float gap = ((dx * dx + dy * dy) + dz * dz) * points.density[i];
    if (!(gap < gaps[i])) continue;
    if (surface && (points.nx[i] * centre.nx + points.ny[i] * centre.ny) + points.nz[i] * centre.nz < kAway) continue;
    gaps[i] = gap;
  }
}

#if defined(__x86_64__)

bool has_relax_avx2() { return __builtin_cpu_supports("avx2"); }

__attribute__((target("avx2"))) void relax_avx2(const Points& points, std::size_t first, std::size_t last,
                                                const Centre& centre, bool surface, float* gaps) {
  constexpr std::size_t lanes = 8;
  static_assert(Points::kPadding >= lanes);
  const __m256 x = _mm256_set1_ps(centre.x), y = _mm256_set1_ps(centre.y), z = _mm256_set1_ps(centre.z);
  const __m256 nx = _mm256_set1_ps(centre.nx), ny = _mm256_set1_ps(centre.ny), nz = _mm256_set1_ps(centre.nz);
  const __m256 away = _mm256_set1_ps(kAway);
  const __m256i lane = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  for (std::size_t i = first; i < last; i += lanes) {
    const __m256 dx = _mm256_sub_ps(_mm256_loadu_ps(&points.x[i]), x);
    const __m256 dy = _mm256_sub_ps(_mm256_loadu_ps(&points.y[i]), y);
    const __m256 dz = _mm256_sub_ps(_mm256_loadu_ps(&points.z[i]), z);
    const __m256 square =
        _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy)), _mm256_mul_ps(dz, dz));
    const __m256 gap = _mm256_mul_ps(square, _mm256_loadu_ps(&points.density[i]));
    // Masks lanes beyond `last`, where another thread may be writing. Masked gaps read as 0, so that no gap there
    // shrinks.
    const auto left = static_cast<int>(std::min(last - i, lanes));
    const __m256i here = _mm256_cmpgt_epi32(_mm256_set1_epi32(left), lane);
    __m256 smaller = _mm256_cmp_ps(gap, _mm256_maskload_ps(gaps + i, here), _CMP_LT_OQ);
    if (_mm256_testz_ps(smaller, smaller)) continue;
    if (surface) {
      const __m256 xy = _mm256_add_ps(_mm256_mul_ps(_mm256_loadu_ps(&points.nx[i]), nx),
                                      _mm256_mul_ps(_mm256_loadu_ps(&points.ny[i]), ny));
      const __m256 cosine = _mm256_add_ps(xy, _mm256_mul_ps(_mm256_loadu_ps(&points.nz[i]), nz));
      smaller = _mm256_andnot_ps(_mm256_cmp_ps(cosine, away, _CMP_LT_OQ), smaller);
    }
    _mm256_maskstore_ps(gaps + i, _mm256_castps_si256(smaller), gap);
  }
}

#else

bool has_relax_avx2() { return false; }
void relax_avx2(const Points& points, std::size_t first, std::size_t last, const Centre& centre, bool surface,
                float* gaps) {
  relax_portable(points, first, last, centre, surface, gaps);
}

#endif

}  // namespace gs::qnv::order
