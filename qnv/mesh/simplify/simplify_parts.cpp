#include "base/parallel.h"
#include "qnv/mesh/centre.h"
#include "qnv/mesh/simplify/simplifier.h"
#include "qnv/mesh/simplify/simplify.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

// First simplification of large meshes, in parts and in parallel. The division into parts depends only on the mesh, so
// the result does not depend on the number of cores.
namespace gs::qnv::displaced {
namespace {

constexpr std::size_t kPartTriangles = 100'000, kMaxParts = 64;
// Ratio of the triangles that remain after this step to the requested number. The rest is simplified as a whole,
// because borders of parts stay unchanged here.
constexpr std::size_t kKept = 4;

/// Simplified part of a mesh.
struct Part {
  SurfaceMesh mesh;
  std::vector<std::array<std::uint32_t, 2>> kept;  // vertices shared with other parts: index here and in the whole mesh
};

/// Sorts triangles into runs that are spatially compact. `parts` is the number of runs, a power of two.
std::vector<std::uint32_t> in_runs(const SurfaceMesh& mesh, std::size_t parts, unsigned threads) {
  std::vector<Centre> centres;
  centres.reserve(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners& c = mesh.triangles[t];
    centres.push_back({mesh.positions[c[0]] + mesh.positions[c[1]] + mesh.positions[c[2]], t});
  }
  for (std::size_t runs = 1; runs < parts; runs *= 2) {
    const auto halve = [&](std::size_t i) {
      const auto begin = centres.begin() + static_cast<std::ptrdiff_t>(centres.size() * i / runs);
      const auto middle = centres.begin() + static_cast<std::ptrdiff_t>(centres.size() * (2 * i + 1) / (2 * runs));
      const auto end = centres.begin() + static_cast<std::ptrdiff_t>(centres.size() * (i + 1) / runs);
      Box box;
      for (auto at = begin; at != end; ++at) box.add(at->place);
      const glm::vec3 size = box.size();
      const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
      put_middle(begin, middle, end, axis);
    };
    parallel_for(runs, halve, threads);
  }
  std::vector<std::uint32_t> runs;
  runs.reserve(centres.size());
  for (const Centre& centre : centres) runs.push_back(centre.triangle);
  return runs;
}

template <class T>
void put(std::vector<std::byte>& bytes, const std::vector<T>& values) {
  const auto size = static_cast<std::uint64_t>(values.size());
  const auto head = std::as_bytes(std::span(&size, 1)), rest = std::as_bytes(std::span(values));
  bytes.insert(bytes.end(), head.begin(), head.end());
  bytes.insert(bytes.end(), rest.begin(), rest.end());
}

template <class T>
void get(std::span<const std::byte>& bytes, std::vector<T>& values) {
  std::uint64_t size = 0;
  std::memcpy(&size, bytes.data(), sizeof size);
  values.resize(static_cast<std::size_t>(size));
  if (size > 0) std::memcpy(values.data(), bytes.data() + sizeof size, values.size() * sizeof(T));
  bytes = bytes.subspan(sizeof size + values.size() * sizeof(T));
}

/// Passes the simplified parts `first` to `end` - 1 to rank 0. On rank 0, fills the parts of all other ranks.
void pass_parts(const SimplifyRanks& ranks, std::vector<Part>& parts, std::size_t first, std::size_t end) {
  std::vector<std::byte> own;
  for (std::size_t p = first; p < end; ++p) {
    put(own, parts[p].kept);
    put(own, parts[p].mesh.positions);
    put(own, parts[p].mesh.triangles);
  }
  const std::vector<std::byte> all = ranks.gather(own);
  if (ranks.rank != 0) return;
  std::span<const std::byte> rest(all);
  for (Part& part : parts) {
    get(rest, part.kept);
    get(rest, part.mesh.positions);
    get(rest, part.mesh.triangles);
  }
}

}  // namespace

SurfaceMesh thinned(const SurfaceMesh& mesh, std::size_t wanted, std::size_t count, unsigned threads,
                    const SimplifyRanks& ranks) {
  const std::vector<std::uint32_t> runs = in_runs(mesh, count, threads);
  const auto first_of = [&](std::size_t part) { return runs.size() * part / count; };
  // Index of each vertex's part; `count` if several parts share the vertex.
  std::vector<std::uint8_t> owner(mesh.positions.size(), 0xff);
  for (std::size_t p = 0; p < count; ++p)
    for (std::size_t i = first_of(p); i < first_of(p + 1); ++i)
      for (const std::uint32_t v : mesh.triangles[runs[i]])
        owner[v] = static_cast<std::uint8_t>(owner[v] == 0xff || owner[v] == p ? p : count);
  std::vector<Part> parts(count);
  const std::size_t first = count * ranks.rank / ranks.count, end = count * (ranks.rank + 1) / ranks.count;
  const auto simplify_part = [&](std::size_t i) {
    const std::size_t p = first + i;
    std::vector<std::uint32_t> sorted(runs.begin() + static_cast<std::ptrdiff_t>(first_of(p)),
                                      runs.begin() + static_cast<std::ptrdiff_t>(first_of(p + 1)));
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::uint32_t> here(mesh.positions.size(), kNone), vertices, places;
    std::vector<bool> kept;
    SurfaceMesh part;
    for (const std::uint32_t t : sorted) {
      Corners corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = mesh.triangles[t][k];
        if (here[v] == kNone) {
          here[v] = static_cast<std::uint32_t>(vertices.size());
          vertices.push_back(v);
          part.positions.push_back(mesh.positions[v]);
          kept.push_back(owner[v] == count);
        }
        corners[k] = here[v];
      }
      part.triangles.push_back(corners);
    }
    const std::size_t share = wanted * part.triangles.size() / mesh.triangles.size();
    Simplifier simplifier(part, kept);
    simplifier.thin(std::max<std::size_t>(share, 1), kKept * share);
    parts[p].mesh = simplifier.result(part, places);
    for (std::size_t v = 0; v < vertices.size(); ++v)
      if (kept[v] && places[v] != kNone) parts[p].kept.push_back({places[v], vertices[v]});
  };
  parallel_for(end - first, simplify_part, threads);
  if (ranks.count > 1) pass_parts(ranks, parts, first, end);
  if (ranks.rank != 0) return {};
  SurfaceMesh out;
  std::vector<std::uint32_t> joined(mesh.positions.size(), kNone);  // new index of each shared vertex
  for (const Part& part : parts) {
    std::vector<std::uint32_t> places(part.mesh.positions.size(), kNone);
    for (const auto& [at, whole] : part.kept) {
      if (joined[whole] == kNone) {
        joined[whole] = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(mesh.positions[whole]);
      }
      places[at] = joined[whole];
    }
    for (std::size_t v = 0; v < places.size(); ++v) {
      if (places[v] != kNone) continue;
      places[v] = static_cast<std::uint32_t>(out.positions.size());
      out.positions.push_back(part.mesh.positions[v]);
    }
    for (const Corners& t : part.mesh.triangles) out.triangles.push_back({places[t[0]], places[t[1]], places[t[2]]});
  }
  return out;
}

SurfaceMesh simplify(const SurfaceMesh& mesh, std::size_t triangles, unsigned threads,
                     const std::function<void()>& beside, const SimplifyRanks& ranks) {
  const bool large = mesh.triangles.size() >= 2 * kPartTriangles && mesh.triangles.size() / (2 * kKept) >= triangles;
  const std::size_t parts = std::min(kMaxParts, std::bit_floor(mesh.triangles.size() / kPartTriangles));
  const SurfaceMesh thin = large ? thinned(mesh, triangles, parts, threads, ranks) : SurfaceMesh();
  if (ranks.rank != 0) return {};
  const SurfaceMesh& from = large ? thin : mesh;
  SurfaceMesh out;
  const auto work = [&](std::size_t i) {
    if (i == 1) return beside();
    Simplifier simplifier(from);
    simplifier.run(triangles, large ? kKept : kFromTheStart);
    std::vector<std::uint32_t> places;
    out = simplifier.result(from, places);
  };
  parallel_for(beside ? 2 : 1, work, threads);
  return out;
}

}  // namespace gs::qnv::displaced
