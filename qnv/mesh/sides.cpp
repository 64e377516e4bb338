#include "qnv/mesh/sides.h"

#include "base/parallel.h"

#include <algorithm>
#include <mutex>
#include <thread>

namespace gs::qnv::displaced {
namespace {

constexpr std::size_t kVerticesTogether = std::size_t{1} << 15;  // vertices per task
constexpr std::size_t kSidesTogether = std::size_t{1} << 16;
// A mesh with fewer vertices is counted on one thread. With more threads than the maximum, reading would cost more than
// counting saves.
constexpr std::size_t kCountedByOne = 50'000, kMaxCounting = 8;

std::size_t parts_of(std::size_t count, std::size_t together) { return (count + together - 1) / together; }

}  // namespace

bool side_before(const Side& a, const Side& b) {
  return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.at < b.at;
}

std::vector<Side> sorted_sides(std::span<const Corners> triangles) {
  // Counting sort by the lower vertex, which few sides share. Every thread has its own range of vertices.
  std::uint32_t vertices = 0;
  for (const Corners& t : triangles) vertices = std::max({vertices, t[0] + 1, t[1] + 1, t[2] + 1});
  std::vector<std::uint32_t> ends(std::size_t{vertices} + 1, 0);
  std::vector<Side> sides(triangles.size() * 3);
  const std::size_t threads = triangles.size() < kCountedByOne
                                  ? 1
                                  : std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, kMaxCounting);
  const auto range = [&](std::size_t part) { return static_cast<std::uint32_t>(vertices * part / threads); };
  parallel_for(threads, [&](std::size_t part) {
    const std::uint32_t first = range(part), count = range(part + 1) - first;
    for (const Corners& t : triangles)
      for (std::size_t k = 0; k < 3; ++k)
        if (const std::uint32_t low = std::min(t[k], t[k == 2 ? 0 : k + 1]); low - first < count) ++ends[low + 1];
  });
  for (std::size_t v = 1; v < ends.size(); ++v) ends[v] += ends[v - 1];
  parallel_for(threads, [&](std::size_t part) {
    const std::uint32_t first = range(part), count = range(part + 1) - first;
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t a = triangles[t][k], b = triangles[t][k == 2 ? 0 : k + 1];
        if (const std::uint32_t low = std::min(a, b); low - first < count)
          sides[ends[low]++] = {low, std::max(a, b), 3 * t + k};
      }
  });
  parallel_for(parts_of(vertices, kVerticesTogether), [&](std::size_t part) {
    std::size_t v = part * kVerticesTogether, first = v == 0 ? 0 : ends[v - 1];
    for (const std::size_t last = std::min<std::size_t>(v + kVerticesTogether, vertices); v < last; first = ends[v++])
      std::sort(sides.begin() + static_cast<std::ptrdiff_t>(first), sides.begin() + ends[v], side_before);
  });
  return sides;
}

void for_each_edge(std::span<const Side> sides, const std::function<void(std::size_t, std::size_t)>& each) {
  parallel_for(parts_of(sides.size(), kSidesTogether), [&](std::size_t part) {
    std::size_t i = part * kSidesTogether;
    const std::size_t stop = std::min(i + kSidesTogether, sides.size());
    while (i > 0 && i < stop && same_edge(sides[i - 1], sides[i])) ++i;  // the previous part processes this edge
    for (std::size_t end = 0; i < stop; i = end) {
      for (end = i + 1; end < sides.size() && same_edge(sides[i], sides[end]);) ++end;
      each(i, end);
    }
  });
}

std::vector<Side> join_at(std::span<const Corners> triangles, std::span<const Side> sides, Neighbours& beside) {
  std::vector<Side> odd;
  std::mutex mutex;
  for_each_edge(sides, [&](std::size_t i, std::size_t end) {
    if (end - i == 1) return;
    const Side &a = sides[i], &b = sides[i + 1];
    if (end - i == 2 && triangles[a.at / 3][a.at % 3] != triangles[b.at / 3][b.at % 3]) {
      beside[a.at / 3][a.at % 3] = b.at / 3;
      beside[b.at / 3][b.at % 3] = a.at / 3;
      return;
    }
    const std::lock_guard lock(mutex);
    odd.insert(odd.end(), sides.begin() + static_cast<std::ptrdiff_t>(i),
               sides.begin() + static_cast<std::ptrdiff_t>(end));
  });
  std::sort(odd.begin(), odd.end(), side_before);
  return odd;
}

std::vector<std::uint8_t> one_fan(std::span<const Corners> triangles, std::size_t vertices, const Neighbours& beside) {
  // One corner of each vertex, and the number of corners at each vertex.
  struct Round {
    std::uint32_t corner = kNone, count = 0;
  };
  std::vector<Round> round(vertices);
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      Round& at = round[triangles[t][k]];
      at.corner = 3 * t + k;
      ++at.count;
    }
  std::vector<std::uint8_t> whole(vertices, 1);
  parallel_for(parts_of(vertices, kVerticesTogether), [&](std::size_t part) {
    for (std::size_t v = part * kVerticesTogether; v < std::min(vertices, (part + 1) * kVerticesTogether); ++v) {
      if (round[v].count == 0) continue;
      std::uint32_t count = 0;
      for_each_in_fan(triangles, beside, round[v].corner, [&](std::uint32_t) { return ++count <= round[v].count; });
      whole[v] = count == round[v].count ? 1 : 0;
    }
  });
  return whole;
}

}  // namespace gs::qnv::displaced
