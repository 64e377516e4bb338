#include "qnv/codecs/displaced/encode/stage_encode.h"

#include "qnv/codecs/displaced/cluster_coder.h"
#include "qnv/codecs/displaced/encode/error_cells.h"
#include "qnv/codecs/displaced/subdivision.h"
#include "qnv/mesh/simplify/simplify.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace gs::qnv::displaced {
namespace {

// Limits that let a cluster with its header fit into a datagram.
constexpr std::size_t kMaxClusterBytes = 1190, kAimedClusterBytes = 1000;
// Residuals below this fraction of a quantisation step become 0. On deeper levels the fraction is larger, because small
// residuals would only add roughness.
constexpr float kDeadZone = 0.6f, kDeeperDeadZone = 1.2f;
constexpr std::size_t kPartVertices = 8192;  // vertices of a level per task
// Maximum distance of a crease of the base mesh from a sharp line of the source, relative to the crease's length.
constexpr float kCreaseReach = 0.12f;

// For stages with a successor. kLevelsSent is the maximum number of levels to send. The encoder decides kLevelsToTell
// levels before the last one whether a successor is needed. A point is far if its distance exceeds kFar source edges
// per remaining level.
constexpr int kLevelsSent = 4, kLevelsToTell = 2;
constexpr float kFar = 1;
// Approximate number of target points for measuring the error.
constexpr std::size_t kErrorSamples = 20'000;
constexpr std::size_t kErrorPatches = 64, kErrorPlaces = 1024;  // patches and points per task

glm::ivec3 luma_chroma(const glm::vec3& c) {
  const int r = static_cast<int>(c.x + 0.5f), g = static_cast<int>(c.y + 0.5f), b = static_cast<int>(c.z + 0.5f);
  const int co = r - b, t = b + (co >> 1), cg = g - t;
  return {t + (cg >> 1), co, cg};
}

std::int16_t quantised(float value, float step, float dead) {
  const float size = std::abs(value) / step;
  if (!(size >= dead)) return 0;
  const int whole = std::max(1, static_cast<int>(std::min(size, 32000.0f) + 0.5f));
  return static_cast<std::int16_t>(value < 0 ? -whole : whole);
}

class StageEncoder {
 public:
  StageEncoder(const Target& target, const StageOptions& options, EncodedStage& out)
      : target_(target), options_(options), out_(out) {}
  void run(const SurfaceMesh& coarse, Progress* progress);

 private:
  void make_base(const SurfaceMesh& coarse);
  void displace_base(Surface& surface);
  void displace(Surface& surface, int level);
  void color(Surface& surface, int deepest);
  void cut(Surface& surface, ClusterHeader header, std::vector<StageCluster>& out);
  /// Root mean square distances of target points to the surface at a level. `all` is for all points, `far` for the
  /// points that no finer level can approach.
  struct Errors {
    float all, far;
  };
  [[nodiscard]] Errors errors_of(const Surface& surface, int level) const;
  [[nodiscard]] bool surely_followed(const Surface& surface, int level, const SurfaceMesh& coarse, float& error) const;
  void measure(Surface& surface, StageCluster& cluster);

  const Target& target_;
  const StageOptions& options_;
  EncodedStage& out_;
  // State of the current level: the vertices with layer 0, and the shifts of the finer layers.
  std::vector<glm::vec3> places_, normals_;
  std::array<std::vector<glm::vec3>, kLayers> shifts_;
  std::array<std::vector<glm::vec3>, kDeepestPatch + 1> level_places_, level_normals_;  // final vertices per level
};

void StageEncoder::make_base(const SurfaceMesh& coarse) {
  std::size_t wanted = options_.triangles;
  for (int attempt = 0; attempt < 8; ++attempt) {
    const SurfaceMesh small = options_.beside  ? coarse
                              : options_.bases ? options_.bases->base(wanted)
                                               : simplify(coarse, wanted);
    BaseMesh base;
    base.bits = small.triangles.size() > 8000   ? 11
                : small.triangles.size() > 3000 ? 10
                : small.triangles.size() > 1000 ? 9
                                                : 8;
    if (small.triangles.size() == coarse.triangles.size()) base.bits = options_.beside ? 11 : 12;
    out_.header.beside = options_.beside;
    const int cells = 1 << base.bits;
    for (const glm::vec3& p : small.positions)
      base.vertices.push_back(
          glm::clamp(glm::ivec3(glm::floor(p * static_cast<float>(cells))), glm::ivec3(0), glm::ivec3(cells - 1)));
    base.triangles = small.triangles;
    const auto is_crease = [&](std::uint32_t a, std::uint32_t b) {
      const glm::vec3 from = small.positions[a], to = small.positions[b];
      const float reach = kCreaseReach * glm::length(to - from);
      for (const float t : {0.25f, 0.5f, 0.75f})
        if (target_.line(from + t * (to - from), reach).triangle == kNone) return false;
      return true;
    };
    CodedBase coded = encode_base(base, is_crease);
    out_.header.base = std::move(coded.mesh);
    out_.header.colored = options_.colored;
    out_.header.step_exponent = options_.step_exponent;
    const auto triangles = static_cast<double>(std::max<std::size_t>(small.triangles.size(), 1));
    const double ratio = static_cast<double>(target_.mesh().triangles.size()) / triangles;
    out_.header.depth =
        ratio <= 1 ? 0
                   : std::clamp(static_cast<int>(std::ceil(std::log(ratio * 0.8) / std::log(4.0))), 1, kDeepestPatch);
    if (options_.beside) out_.header.depth = 0;
    if (options_.colored)
      out_.header.depth = std::max(out_.header.depth, 1);  // colours of the base vertices are in clusters of level 1
    out_.bytes = encode_stage(out_.header, coded.bytes);
    if (options_.most_bytes == 0 || out_.bytes.size() <= options_.most_bytes) return;
    const std::size_t less = wanted * options_.most_bytes / out_.bytes.size() * 97 / 100;
    if (small.triangles.size() > wanted * 3 / 2) return;  // `small` cannot be simplified further
    wanted = std::max<std::size_t>(less, 4);
  }
}

void StageEncoder::displace_base(Surface& surface) {
  places_ = surface.base_positions();
  normals_ = surface.base_normals(places_);
  const float cell = std::ldexp(1.0f, -surface.header().base.bits) * surface.step(0) *
                     std::ldexp(1.0f, surface.header().step_exponent);
  for (auto& shifts : shifts_) shifts.assign(places_.size(), glm::vec3(0));
  for (std::size_t v = 0; v < places_.size(); ++v) {
    const glm::vec3 n = normals_[v], from = places_[v];
    float moved = 0;
    std::uint32_t triangle = kNone;
    for (int layer = 0; layer < options_.layers; ++layer) {
      const float d = target_.distance(from + moved * n, n, 4 * cell, triangle);
      const std::int16_t q = quantised(d, surface.step(layer), kDeadZone);
      surface.numbers(layer, 0).normal[v] = q;
      moved += surface.step(layer) * static_cast<float>(q);
      if (layer == 0)
        places_[v] += moved * n;
      else
        for (int l = layer; l < options_.layers; ++l)
          shifts_[static_cast<std::size_t>(l)][v] += surface.step(layer) * static_cast<float>(q) * n;
    }
  }
}

void StageEncoder::displace(Surface& surface, int level) {
  const Patches& patches = surface.patches();
  normals_ = slot_normals(patches, surface.slots(), level - 1, places_, options_.threads);
  std::vector<glm::vec3> next(patches.vertices_at(level));
  std::array<std::vector<glm::vec3>, kLayers> next_shifts;
  for (int layer = 1; layer < options_.layers; ++layer)
    next_shifts[static_cast<std::size_t>(layer)].resize(next.size());
  std::array<LevelNumbers*, kLayers> numbers{};
  for (int layer = 0; layer < options_.layers; ++layer)
    numbers[static_cast<std::size_t>(layer)] = &surface.numbers(layer, level);
  const std::size_t lines_at = patches.base_vertices();
  const auto visit = [&](const NewVertex& v) {
    const bool line = v.edge != kNone && patches.edges()[v.edge].line();
    const Prediction p = predict(v, line, places_, normals_);
    const float length = glm::length(places_[v.b] - places_[v.a]);
    glm::vec3 at = p.position;
    std::uint32_t triangle = kNone;
    for (std::size_t layer = 0; layer < static_cast<std::size_t>(options_.layers); ++layer) {
      const float step = surface.step(static_cast<int>(layer));
      const float dead = level > 2 && step * 4 > length * 0.5f ? kDeeperDeadZone : kDeadZone;
      glm::vec3 from = at;
      if (layer > 0) from += 0.5f * (shifts_[layer][v.a] + shifts_[layer][v.b]);
      glm::vec3 by(0);
      if (line) {
        const SurfacePoint there = target_.line(from, 0.7f * length);
        if (there.triangle != kNone) {
          const glm::vec3 off = there.position - from;
          const std::int16_t q = quantised(glm::dot(off, p.normal), step, dead);
          const std::int16_t s = quantised(glm::dot(off, p.sideways), step, dead);
          numbers[layer]->normal[v.vertex] = q;
          numbers[layer]->sideways[v.vertex - lines_at] = s;
          by = step * (static_cast<float>(q) * p.normal + static_cast<float>(s) * p.sideways);
        }
      } else {
        const float d = target_.distance(from, p.normal, 0.5f * length, triangle);
        const std::int16_t q = quantised(d, step, dead);
        numbers[layer]->normal[v.vertex] = q;
        by = step * static_cast<float>(q) * p.normal;
      }
      if (layer == 0) {
        at += by;
        next[v.vertex] = at;
      } else {
        // A displacement of this layer shifts all finer layers too.
        next_shifts[layer][v.vertex] = from + by - next[v.vertex];
        at += by;
      }
    }
  };
  const auto keep = [&](std::uint32_t v, std::uint32_t before) {
    next[v] = places_[before];
    for (std::size_t layer = 1; layer < static_cast<std::size_t>(options_.layers); ++layer)
      next_shifts[layer][v] = shifts_[layer][before];
  };
  const std::size_t parts = std::max<std::size_t>(1, next.size() / kPartVertices);
  parallel_for(
      parts, [&](std::size_t part) { visit_level(patches, surface.slots(), level, visit, keep, part, parts); },
      options_.threads);
  places_ = std::move(next);
  for (std::size_t layer = 1; layer < static_cast<std::size_t>(options_.layers); ++layer)
    shifts_[layer] = std::move(next_shifts[layer]);
}

void StageEncoder::color(Surface& surface, int deepest) {
  const Patches& patches = surface.patches();
  const glm::ivec3 steps(kLumaStep, kChromaStep, kChromaStep);
  std::vector<glm::ivec3> now, next;
  for (int level = 0; level <= deepest; ++level) {
    auto& numbers = surface.colors(level);
    const auto& places = level_places_[static_cast<std::size_t>(level)];
    const auto& normals = level_normals_[static_cast<std::size_t>(level)];
    const float reach = 4 * target_.edge() + std::ldexp(surface.step(0), surface.header().step_exponent - 6);
    const auto set = [&](std::uint32_t v, glm::ivec3 predicted, const glm::vec3& normal) {
      const glm::ivec3 wanted = luma_chroma(target_.color(places[v], normal, reach));
      for (int c = 0; c < 3; ++c) {
        const std::int16_t q =
            quantised(static_cast<float>(wanted[c] - predicted[c]), static_cast<float>(steps[c]), 0.6f);
        numbers[static_cast<std::size_t>(c)][v] = q;
        predicted[c] += steps[c] * q;
      }
      return predicted;
    };
    next.resize(patches.vertices_at(level));
    if (level == 0) {
      const std::vector<glm::vec3> base = surface.base_normals(places);
      for (std::uint32_t v = 0; v < next.size(); ++v) next[v] = set(v, {128, 0, 0}, base[v]);
    } else {
      visit_level(
          patches, surface.slots(), level,
          [&](const NewVertex& v) {
            const glm::ivec3 sum = now[v.a] + now[v.b];
            const glm::vec3 normal = normals[v.slot_a] + normals[v.slot_b];
            const float length = glm::length(normal);
            next[v.vertex] =
                set(v.vertex, {sum.x >> 1, sum.y >> 1, sum.z >> 1}, length > 0 ? normal / length : glm::vec3(0, 0, 1));
          },
          [&](std::uint32_t v, std::uint32_t before) { next[v] = now[before]; });
    }
    now.swap(next);
  }
}

void StageEncoder::measure(Surface& surface, StageCluster& cluster) {
  const Patches& patches = surface.patches();
  const ClusterHeader& h = cluster.header;
  const std::size_t n = std::size_t{1} << h.level;
  const auto& places = level_places_[static_cast<std::size_t>(h.level)];
  std::vector<std::uint32_t> grid;
  double gain = 0, area = 0;
  const auto of = [&](const NumberArray& numbers, std::size_t v, double step) {
    const double moved = step * numbers[v];
    gain += moved * moved;
  };
  for (std::uint32_t p = h.first; p < h.first + h.count; ++p) {
    patches.grid(p, h.level, grid);
    for (const std::uint32_t v : grid) cluster.box.add(places[v]);
    const glm::vec3 a = places[grid[0]], b = places[grid[n]], c = places[grid[row_start(n, n)]];
    area += 0.5 * static_cast<double>(glm::length(glm::cross(b - a, c - a)));
    std::vector<std::size_t> mine;
    for (std::uint32_t k = 0; k < 3; ++k)
      if (patches.owns(p, k))
        for (std::size_t t = 0; t + 1 < n; t += 2) mine.push_back(patches.edge_start(patches.edge(p, k), h.level) + t);
    const std::size_t lines = mine.size(), inner = patches.inner_start(p, h.level);
    for (std::size_t i = 0; i < (n - 1) * (n - 2) / 2; ++i) mine.push_back(inner + i);
    cluster.vertices += static_cast<std::uint32_t>(lines + ((n - 1) * (n - 2) / 2) * 3 / 4);
    if (h.kind == ClusterHeader::Kind::color) {
      const auto of_colors = [&](int level, std::size_t v) {
        auto& colors = surface.colors(level);
        of(colors[0], v, kLumaStep / 255.0);
        of(colors[1], v, kChromaStep / 510.0);
        of(colors[2], v, kChromaStep / 510.0);
      };
      for (const std::size_t v : mine) of_colors(h.level, v);
      // Clusters of level 1 contain the base's colours too, and may contain no others.
      if (h.level == 1)
        for (const std::uint32_t v : {grid[0], grid[n], grid[row_start(n, n)]}) of_colors(0, v);
      continue;
    }
    LevelNumbers& numbers = surface.numbers(h.layer, h.level);
    const auto step = static_cast<double>(surface.step(h.layer));
    for (const std::size_t v : mine) of(numbers.normal, v, step);
    if (!numbers.sideways.empty())
      for (std::size_t i = 0; i < lines; ++i) of(numbers.sideways, mine[i] - patches.base_vertices(), step);
  }
  // Weights the gain by the area per vertex.
  if (h.kind == ClusterHeader::Kind::color) gain *= area / (h.count * static_cast<double>(n * n) / 2);
  cluster.gain = gain;
}

void StageEncoder::cut(Surface& surface, ClusterHeader header, std::vector<StageCluster>& out) {
  StageCluster cluster;
  cluster.header = header;
  cluster.payload = encode_cluster(surface, header);
  if (cluster.payload.size() > kMaxClusterBytes && header.count > 1) {
    const std::size_t parts = std::min<std::size_t>(
        header.count, std::max<std::size_t>(2, (cluster.payload.size() + kAimedClusterBytes - 1) / kAimedClusterBytes));
    for (std::size_t i = 0; i < parts; ++i) {
      ClusterHeader part = header;
      const auto from = static_cast<std::uint32_t>(header.count * i / parts);
      const auto to = static_cast<std::uint32_t>(header.count * (i + 1) / parts);
      part.first = header.first + from;
      part.count = to - from;
      cut(surface, part, out);
    }
    return;
  }
  measure(surface, cluster);
  if (cluster.gain > 0 && cluster.payload.size() <= 65535) out.push_back(std::move(cluster));
}

StageEncoder::Errors StageEncoder::errors_of(const Surface& surface, int level) const {
  SurfaceMesh made;
  made.positions = level_places_[static_cast<std::size_t>(level)];
  const std::vector<glm::vec3>& places = target_.mesh().positions;
  const int levels_left = surface.header().depth - level;
  const float reach = std::ldexp(4 * target_.edge(), levels_left);
  // Uses the same points at all levels.
  const ErrorCells cells(16 * target_.edge(), std::max<std::size_t>(1, places.size() / kErrorSamples));
  const std::size_t n = std::size_t{1} << level, patches = surface.patches().size(),
                    parts = (patches + kErrorPatches - 1) / kErrorPatches;
  std::vector<std::vector<Corners>> triangles(parts);
  parallel_for(
      parts,
      [&](std::size_t part) {
        std::vector<std::uint32_t> grid;
        for (std::size_t p = part * kErrorPatches; p < std::min(patches, (part + 1) * kErrorPatches); ++p) {
          surface.patches().grid(static_cast<std::uint32_t>(p), level, grid);
          for (std::size_t j = 0; j < n; ++j) {
            bool near = cells.near(made.positions[grid[row_start(j, n)]], reach);
            for (std::size_t i = 0; i + j < n; ++i) {
              const std::size_t row = row_start(j, n) + i, above = row_start(j + 1, n) + i;
              if (near) triangles[part].push_back({grid[row], grid[row + 1], grid[above]});
              if (i + j + 1 == n) break;
              near = cells.near(made.positions[grid[row + 1]], reach);
              if (near) triangles[part].push_back({grid[row + 1], grid[above + 1], grid[above]});
            }
          }
        }
      },
      options_.threads);
  for (const auto& some : triangles) made.triangles.insert(made.triangles.end(), some.begin(), some.end());
  const TriangleTree tree(made, options_.threads);
  std::vector<glm::vec3> looked;
  std::copy_if(places.begin(), places.end(), std::back_inserter(looked), [&](const auto& p) { return cells.has(p); });
  const std::size_t count = looked.size();
  std::vector<float> distances(count);
  const float most = 20 * target_.edge();
  parallel_for((count + kErrorPlaces - 1) / kErrorPlaces,
               [&](std::size_t part) {
                 for (std::size_t i = part * kErrorPlaces; i < std::min(count, (part + 1) * kErrorPlaces); ++i) {
                   const SurfacePoint near = tree.nearest(looked[i], most, glm::vec3(0), -1.0f);
                   distances[i] = near.triangle == kNone ? most : near.distance;
                 }
               },
               options_.threads);
  double sum = 0, far = 0;
  for (const float distance : distances) {
    const auto squared = static_cast<double>(distance) * static_cast<double>(distance);
    sum += squared;
    if (distance > kFar * static_cast<float>(levels_left) * target_.edge()) far += squared;
  }
  const auto root = [&](double of) {
    return static_cast<float>(std::sqrt(of / static_cast<double>(std::max<std::size_t>(count, 1))));
  };
  return {root(sum), root(far)};
}

/// Reports whether another stage is necessary, no matter how many levels this stage adds.
bool StageEncoder::surely_followed(const Surface& surface, int level, const SurfaceMesh& coarse, float& error) const {
  if (!(options_.most_error > 0) || kMoreTriangles * surface.patches().size() >= coarse.triangles.size()) return false;
  const Errors errors = errors_of(surface, level);
  error = errors.all;
  return errors.far > options_.most_error && errors.all < options_.trusted_error;
}

void StageEncoder::run(const SurfaceMesh& coarse, Progress* progress) {
  make_base(coarse);
  const std::size_t next = kMoreTriangles * out_.header.base.triangles.size();
  if (options_.bases && options_.most_error > 0 && next < coarse.triangles.size()) options_.bases->expect(next);
  Surface surface(out_.header);
  int depth = out_.header.depth;
  displace_base(surface);
  const auto keep = [&](int level) {
    const auto l = static_cast<std::size_t>(level);
    level_places_[l] = places_;
    if (options_.layers > 1)
      for (std::size_t v = 0; v < places_.size(); ++v)
        level_places_[l][v] += shifts_[static_cast<std::size_t>(options_.layers - 1)][v];
    if (level > 0 && options_.colored) level_normals_[l] = normals_;
  };
  keep(0);
  for (int level = 1; level <= depth && !is_cancelled(progress); ++level) {
    displace(surface, level);
    keep(level);
    if (level < depth && level == std::max(depth - kLevelsToTell, kLevelsSent) &&
        surely_followed(surface, level, coarse, out_.error))
      depth = level;
  }
  if (options_.colored && !is_cancelled(progress)) color(surface, depth);
  // Clusters of different levels, layers or kinds share no numbers, so that threads can encode them in parallel.
  const std::uint32_t all = surface.patches().size();
  std::vector<ClusterHeader> headers;
  for (int level = 1; level <= depth; ++level) {
    for (int layer = 0; layer < options_.layers; ++layer)
      headers.push_back({ClusterHeader::Kind::displacement, options_.number, level, layer, 0, all, 0});
    if (options_.colored) headers.push_back({ClusterHeader::Kind::color, options_.number, level, 0, 0, all, 0});
  }
  std::vector<std::vector<StageCluster>> clusters(headers.size());
  const auto cut_all = [&] {
    parallel_for(
        headers.size(),
        [&](std::size_t i) {
          const std::size_t at = headers.size() - 1 - i;  // starts with the largest task
          if (!is_cancelled(progress)) cut(surface, headers[at], clusters[at]);
        },
        options_.threads);
  };
  // The largest task takes as long as all others together. The other threads measure the error meanwhile.
  const bool whole = depth == out_.header.depth;
  parallel_for(
      whole ? 2 : 1,
      [&](std::size_t i) {
        if (i == 0)
          cut_all();
        else
          out_.error = errors_of(surface, depth).all;
      },
      options_.threads);
  for (auto& some : clusters) std::move(some.begin(), some.end(), std::back_inserter(out_.clusters));
}

}  // namespace

std::vector<std::byte> encode_cluster(Surface& surface, const ClusterHeader& header) {
  BinaryEncoder encoder;
  if (header.kind == ClusterHeader::Kind::color) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      ClusterCoder<BinaryEncoder> coder(encoder, surface.patches(), header.first, header.count);
      if (header.level == 1) (void)coder.base(surface.colors(0)[channel]);
      (void)coder.level(header.level, surface.colors(header.level)[channel], nullptr);
    }
  } else {
    ClusterCoder<BinaryEncoder> coder(encoder, surface.patches(), header.first, header.count);
    if (header.level == 1) (void)coder.base(surface.numbers(header.layer, 0).normal);
    LevelNumbers& numbers = surface.numbers(header.layer, header.level);
    (void)coder.level(header.level, numbers.normal, &numbers.sideways);
  }
  std::vector<std::byte> payload = encode_cluster_header(header);
  const std::vector<std::byte> body = encoder.finish();
  payload.insert(payload.end(), body.begin(), body.end());
  return payload;
}

EncodedStage encode_stage_of(const Target& target, const SurfaceMesh& coarse, const StageOptions& options,
                             Progress* progress) {
  EncodedStage stage;
  StageEncoder(target, options, stage).run(coarse, progress);
  return stage;
}

}  // namespace gs::qnv::displaced
