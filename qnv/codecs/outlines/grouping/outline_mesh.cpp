#include "qnv/codecs/outlines/grouping/outline_mesh.h"

#include "base/finite.h"

#include <glm/geometric.hpp>

#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <span>
#include <unordered_map>
#include <utility>

namespace gs::qnv::outline {
namespace {

std::uint64_t mixed(std::uint64_t x) {  // finaliser of the generator splitmix64
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

std::uint64_t hash_of(const glm::vec3& p) {
  const auto bits = [](float x) -> std::uint64_t { return std::bit_cast<std::uint32_t>(x + 0.0f); };  // turns -0 into 0
  return mixed(mixed(bits(p.x) << 32 | bits(p.y)) ^ bits(p.z));
}

// Returns for each position the index of the first equal position; kNone if the position is not finite.
std::vector<std::uint32_t> welded(const std::vector<glm::vec3>& positions, unsigned threads) {
  std::vector<std::uint32_t> same(positions.size(), kNone);
  const std::size_t size = std::bit_ceil(positions.size() * 3 / 2 + 2);
  std::vector<std::uint32_t> table(size, kNone);
  // Each part owns a segment of the hash table and scans all positions. Equal positions always belong to the same part.
  const auto weld_part = [&](std::size_t part, std::size_t parts) {
    const std::size_t stretch = size / parts, begin = part * stretch, mask = stretch - 1;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const glm::vec3& p = positions[i];
      const std::uint64_t hash = hash_of(p);
      if ((hash >> 40) % parts != part || !finite(p)) continue;
      std::size_t at = hash & mask;
      while (table[begin + at] != kNone && positions[table[begin + at]] != p) at = (at + 1) & mask;
      if (table[begin + at] == kNone) table[begin + at] = static_cast<std::uint32_t>(i);
      same[i] = table[begin + at];
    }
  };
  // The hash table is at most two thirds full, but bad luck could overflow the segment of a part. Then one part does
  // all the work.
  constexpr std::size_t kParts = 4;
  std::array<std::size_t, kParts> counts{};
  for (const glm::vec3& p : positions) ++counts[(hash_of(p) >> 40) % kParts];
  if (size < 1024 || *std::max_element(counts.begin(), counts.end()) >= size / kParts * 7 / 8)
    weld_part(0, 1);
  else
    parallel_for(
        kParts, [&](std::size_t part) { weld_part(part, kParts); }, threads);
  return same;
}

// Reader of the model's polygons, in order.
class Reader {
 public:
  Reader(const PolygonModel& model, unsigned threads, Mesh& mesh, OutlineCounts& counts)
      : model_(model), mesh_(mesh), counts_(counts), same_(welded(model.positions, threads)) {
    number_.assign(model.positions.size(), kNone);
    mesh_.vertices.reserve(model.corners.size());
    mesh_.faces.reserve(model.corners.size());
    mesh_.begins.reserve(model.ends.size() + 1);
    mesh_.sources.reserve(model.ends.size());
    mesh_.appearances.reserve(model.ends.size());
    mesh_.begins.push_back(0);
  }

  void read() {
    for (std::size_t polygon = 0, begin = 0; polygon < model_.ends.size(); ++polygon) {
      const std::size_t end = model_.ends[polygon];
      read_polygon(static_cast<std::uint32_t>(polygon), begin, end);
      begin = end;
    }
  }

 private:
  void read_polygon(std::uint32_t polygon, std::size_t begin, std::size_t end) {
    const std::size_t first = mesh_.vertices.size();
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t corner = model_.corners[i];
      if (corner >= same_.size() || same_[corner] == kNone) {
        ++counts_.invalid;
        return give_up(first);
      }
      const std::uint32_t vertex = same_[corner];
      if (mesh_.vertices.size() > first && mesh_.vertices.back() == vertex) continue;
      add(vertex, i);
    }
    while (mesh_.vertices.size() > first + 1 && mesh_.vertices.back() == mesh_.vertices[first]) {
      mesh_.vertices.pop_back();
      if (!mesh_.corners.empty()) mesh_.corners.pop_back();
    }
    const std::size_t size = mesh_.vertices.size() - first;
    if (size < 3 || (size == 4 && mesh_.vertices[first] == mesh_.vertices[first + 2] &&
                     mesh_.vertices[first + 1] == mesh_.vertices[first + 3])) {
      ++counts_.degenerate;
      return give_up(first);
    }
    for (std::size_t i = first; i < mesh_.vertices.size(); ++i) {
      std::uint32_t& number = number_[mesh_.vertices[i]];
      if (number == kNone) {
        number = static_cast<std::uint32_t>(mesh_.positions.size());
        mesh_.positions.push_back(model_.positions[mesh_.vertices[i]] + glm::vec3(0.0f));
      }
      mesh_.vertices[i] = number;
    }
    mesh_.faces.resize(mesh_.vertices.size(), static_cast<std::uint32_t>(mesh_.sources.size()));
    mesh_.begins.push_back(static_cast<std::uint32_t>(mesh_.vertices.size()));
    mesh_.sources.push_back(polygon);
    mesh_.appearances.push_back(model_.appearances.empty() ? 0 : model_.appearances[polygon]);
  }

  void add(std::uint32_t vertex, std::size_t corner) {
    mesh_.vertices.push_back(vertex);
    if (!model_.texture_coordinates.empty()) mesh_.corners.push_back(static_cast<std::uint32_t>(corner));
  }

  void give_up(std::size_t first) {
    mesh_.vertices.resize(first);
    if (!mesh_.corners.empty()) mesh_.corners.resize(first);
  }

  const PolygonModel& model_;
  Mesh& mesh_;
  OutlineCounts& counts_;
  std::vector<std::uint32_t> same_, number_;
};

// Returns the error of coordinates: half a unit in the last place of the largest coordinate, in three dimensions, and
// doubled for derived values. The error is limited to an invisible amount for tiny models far from the origin.
double rounding_of(const Mesh& mesh) {
  double largest = 0;
  glm::dvec3 lower(INFINITY), upper(-INFINITY);
  for (const glm::vec3& p : mesh.positions) {
    largest = std::max<double>({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    lower = {std::min<double>(lower.x, p.x), std::min<double>(lower.y, p.y), std::min<double>(lower.z, p.z)};
    upper = {std::max<double>(upper.x, p.x), std::max<double>(upper.y, p.y), std::max<double>(upper.z, p.z)};
  }
  if (mesh.positions.empty()) return 0;
  return std::min(largest * 0x1p-23, glm::length(upper - lower) * 1e-6);
}

void measure_faces(Mesh& mesh, unsigned threads) {
  mesh.normals.resize(mesh.face_count());
  mesh.areas.resize(mesh.face_count());
  mesh.thin.resize(mesh.face_count());
  for_ranges(mesh.face_count(), 1u << 14, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t face = first; face < last; ++face) {
      const std::uint32_t begin = mesh.begins[face], size = mesh.begins[face + 1] - begin;
      const auto position = [&](std::size_t i) { return mesh.position(begin + static_cast<std::uint32_t>(i)); };
      const glm::dvec3 twice = ring_area(size, position);
      const double length = glm::length(twice);
      double longest = 0;
      for (std::size_t i = 0; i < size; ++i)
        longest = std::max(longest, glm::length(position(i + 1 == size ? 0 : i + 1) - position(i)));
      mesh.areas[face] = length / 2;
      mesh.normals[face] = length > 0 ? twice / length : glm::dvec3(0);
      mesh.thin[face] = !(length > longest * 2 * mesh.rounding);
    }
  });
}

// Half-edges grouped by edge. Sorted by the edge's vertex with the lower index, then by the other vertex.
class EdgeTable {
 public:
  explicit EdgeTable(const Mesh& mesh) : mesh_(mesh), begins_(mesh.positions.size() + 1), order_(mesh.vertices.size()) {
    const auto count = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t h = 0; h < count; ++h) ++begins_[std::min(mesh.vertices[h], mesh.target(h)) + 1];
    for (std::size_t i = 1; i < begins_.size(); ++i) begins_[i] += begins_[i - 1];
    std::vector<std::uint32_t> at(begins_.begin(), begins_.end() - 1);
    for (std::uint32_t h = 0; h < count; ++h) {
      const std::uint32_t a = mesh.vertices[h], b = mesh.target(h);
      order_[at[std::min(a, b)]++] = {std::max(a, b), h};
    }
  }

  // Calls edge() with the half-edges of each edge, on all threads.
  template <typename Take>
  void for_each(unsigned threads, const Take& take) {
    for_ranges(mesh_.positions.size(), 1u << 14, threads, [&](std::size_t first, std::size_t last) {
      std::vector<std::uint32_t> edge;
      for (std::size_t vertex = first; vertex < last; ++vertex) {
        const auto begin = order_.begin() + begins_[vertex], end = order_.begin() + begins_[vertex + 1];
        std::sort(begin, end);
        for (auto i = begin; i != end;) {
          edge.clear();
          const std::uint32_t other = i->first;
          for (; i != end && i->first == other; ++i) edge.push_back(i->second);
          take(std::span<const std::uint32_t>(edge), static_cast<std::uint32_t>(vertex));
        }
      }
    });
  }

 private:
  const Mesh& mesh_;
  std::vector<std::uint32_t> begins_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order_;
};

// Finds the mates of half-edges. Marks faces that traverse an edge in the same direction as another face.
class Pairing {
 public:
  explicit Pairing(Mesh& mesh) : mesh_(mesh), doubtful_(mesh.face_count()) {}

  void run(unsigned threads, OutlineCounts& counts) {
    mesh_.mates.assign(mesh_.vertices.size(), kNone);
    std::atomic<std::size_t> border{0}, unusual{0};
    EdgeTable(mesh_).for_each(threads, [&](std::span<const std::uint32_t> edge, std::uint32_t lower) {
      if (edge.size() == 1) {
        border.fetch_add(1, std::memory_order_relaxed);
      } else if (edge.size() == 2 && mesh_.vertices[edge[0]] != mesh_.vertices[edge[1]]) {
        if (may_pair(edge[0], edge[1])) pair(edge[0], edge[1]);
      } else {
        unusual.fetch_add(1, std::memory_order_relaxed);
        pair_unusual(edge, lower);
      }
    });
    counts.border_edges = border;
    counts.unusual_edges = unusual;
  }

  [[nodiscard]] const std::vector<std::uint8_t>& doubtful() const { return doubtful_; }

 private:
  [[nodiscard]] bool may_pair(std::uint32_t a, std::uint32_t b) const {
    return mesh_.appearances[mesh_.faces[a]] == mesh_.appearances[mesh_.faces[b]];
  }

  void pair(std::uint32_t a, std::uint32_t b) {
    mesh_.mates[a] = b;
    mesh_.mates[b] = a;
  }

  void pair_unusual(std::span<const std::uint32_t> edge, std::uint32_t lower) {
    constexpr std::size_t kMax = 64;  // an edge with more half-edges is not part of a surface
    std::vector<std::uint32_t> up, down;
    for (const std::uint32_t h : edge) (mesh_.vertices[h] == lower ? up : down).push_back(h);
    for (const auto* side : {&up, &down})
      if (side->size() > 1)
        for (const std::uint32_t h : *side)
          std::atomic_ref(doubtful_[mesh_.faces[h]]).store(1, std::memory_order_relaxed);
    if (edge.size() > kMax) return;
    struct Match {
      double agreement;
      std::uint32_t up, down;
    };
    std::vector<Match> matches;
    for (const std::uint32_t a : up)
      for (const std::uint32_t b : down) {
        const double agreement = glm::dot(mesh_.normals[mesh_.faces[a]], mesh_.normals[mesh_.faces[b]]);
        if (agreement > 0 && may_pair(a, b)) matches.push_back({agreement, a, b});
      }
    std::stable_sort(matches.begin(), matches.end(),
                     [](const Match& a, const Match& b) { return a.agreement > b.agreement; });
    for (const Match& match : matches)
      if (mesh_.mates[match.up] == kNone && mesh_.mates[match.down] == kNone) pair(match.up, match.down);
  }

  Mesh& mesh_;
  std::vector<std::uint8_t> doubtful_;
};

// Finds duplicates among the doubtful faces.
class Duplicates {
 public:
  Duplicates(const PolygonModel& model, const Mesh& mesh) : model_(model), mesh_(mesh) {}

  [[nodiscard]] std::vector<std::uint8_t> find(const std::vector<std::uint8_t>& doubtful, std::size_t& count) {
    std::vector<std::uint8_t> twice(mesh_.face_count());
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> seen;
    constexpr std::size_t kMax = 64;  // maximum number of faces that are compared per hash value
    for (std::uint32_t face = 0; face < mesh_.face_count(); ++face) {
      if (!doubtful[face]) continue;
      std::uint64_t hash = mesh_.appearances[face];
      for (std::size_t i = 0; i < size(face); ++i) hash = mixed(hash ^ mesh_.vertices[half_edge(face, i)]);
      auto& same = seen[hash];
      for (const std::uint32_t other : same)
        if (equal(face, other)) twice[face] = 1;
      if (twice[face])
        ++count;
      else if (same.size() < kMax)
        same.push_back(face);
    }
    return twice;
  }

 private:
  [[nodiscard]] std::size_t size(std::uint32_t face) const { return mesh_.begins[face + 1] - mesh_.begins[face]; }

  // Returns the i-th half-edge of a face, counted from the vertex with the lowest index.
  [[nodiscard]] std::uint32_t half_edge(std::uint32_t face, std::size_t i) const {
    if (face != of_) {
      of_ = face;
      const auto begin = mesh_.vertices.begin() + mesh_.begins[face],
                 end = mesh_.vertices.begin() + mesh_.begins[face + 1];
      lowest_ = static_cast<std::size_t>(std::min_element(begin, end) - begin);
    }
    return mesh_.begins[face] + static_cast<std::uint32_t>((lowest_ + i) % size(face));
  }

  [[nodiscard]] bool equal(std::uint32_t a, std::uint32_t b) const {
    if (size(a) != size(b) || mesh_.appearances[a] != mesh_.appearances[b]) return false;
    std::vector<std::uint32_t> ring;
    for (std::size_t i = 0; i < size(a); ++i) ring.push_back(half_edge(a, i));
    for (std::size_t i = 0; i < size(b); ++i) {
      const std::uint32_t h = half_edge(b, i);
      if (mesh_.vertices[h] != mesh_.vertices[ring[i]]) return false;
      if (!mesh_.corners.empty() &&
          model_.texture_coordinates[mesh_.corners[h]] != model_.texture_coordinates[mesh_.corners[ring[i]]])
        return false;
    }
    return true;
  }

  const PolygonModel& model_;
  const Mesh& mesh_;
  mutable std::uint32_t of_ = kNone;
  mutable std::size_t lowest_ = 0;
};

void drop_faces(Mesh& mesh, const std::vector<std::uint8_t>& dropped) {
  std::uint32_t to = 0, face_to = 0;
  for (std::uint32_t face = 0; face < dropped.size(); ++face) {
    const std::uint32_t begin = mesh.begins[face], end = mesh.begins[face + 1];
    if (dropped[face]) continue;
    mesh.begins[face_to] = to;
    for (std::uint32_t h = begin; h < end; ++h, ++to) {
      mesh.vertices[to] = mesh.vertices[h];
      mesh.faces[to] = face_to;
      if (!mesh.corners.empty()) mesh.corners[to] = mesh.corners[h];
    }
    mesh.sources[face_to] = mesh.sources[face];
    mesh.appearances[face_to] = mesh.appearances[face];
    mesh.normals[face_to] = mesh.normals[face];
    mesh.areas[face_to] = mesh.areas[face];
    mesh.thin[face_to] = mesh.thin[face];
    ++face_to;
  }
  mesh.begins[face_to] = to;
  mesh.begins.resize(face_to + 1);
  mesh.vertices.resize(to);
  mesh.faces.resize(to);
  if (!mesh.corners.empty()) mesh.corners.resize(to);
  mesh.sources.resize(face_to);
  mesh.appearances.resize(face_to);
  mesh.normals.resize(face_to);
  mesh.areas.resize(face_to);
  mesh.thin.resize(face_to);
}

}  // namespace

Mesh make_mesh(const PolygonModel& model, unsigned threads, OutlineCounts& counts) {
  Mesh mesh;
  counts.polygons = model.ends.size();
  Reader(model, threads, mesh, counts).read();
  mesh.rounding = rounding_of(mesh);
  measure_faces(mesh, threads);
  Pairing pairing(mesh);
  pairing.run(threads, counts);
  const auto twice = Duplicates(model, mesh).find(pairing.doubtful(), counts.duplicates);
  if (counts.duplicates > 0) {
    drop_faces(mesh, twice);
    Pairing(mesh).run(threads, counts);
  }
  return mesh;
}

}  // namespace gs::qnv::outline
