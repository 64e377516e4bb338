// Measures the octree payload: speed of encoding and decoding, bits per vector, and the cost of progressive order.
//
//   packed_bench MODEL...
//
// Prints a Markdown table. "At once" codes the same finest voxels without coarser pictures: the octree's occupancy at
// its empirical entropy per level, and normals and offsets as differences from the previous voxel in Morton order, with
// the same static models and cluster sizes.
#include "app/encode/surface_triangles.h"
#include "app/loading/world_loader.h"
#include "qnv/codecs/octree/encode/packed_quantize.h"
#include "qnv/codecs/octree/packed_layout.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace {

using namespace gs;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

struct Finest {
  std::uint64_t key;
  int u, v, offset;
};

double residual_bits(const std::vector<std::pair<int, int>>& values) {  // context, residual
  std::array<std::array<std::size_t, qnv::kResidualSymbols>, 3> histograms{};
  for (const auto& [context, value] : values)
    ++histograms[static_cast<std::size_t>(context)][std::min(qnv::zigzag(value), qnv::kEscape)];
  double sum = 0;
  for (const auto& histogram : histograms) {
    double least = 1e300;
    for (const qnv::ResidualModel& model : qnv::residual_models()) {
      double bits = 0;
      for (std::size_t s = 0; s < histogram.size(); ++s)
        bits += static_cast<double>(histogram[s]) * model.cost[s] / 256.0;
      least = std::min(least, bits);
    }
    sum += least;
  }
  return sum;
}

// Returns the bits for coding only the finest voxels, without the planes of coarser levels.
double bits_at_once(std::vector<Finest> finest, int level, int normal_shift, int offset_shift) {
  std::sort(finest.begin(), finest.end(), [](const Finest& a, const Finest& b) { return a.key < b.key; });
  double bits = 0;
  std::vector<std::uint64_t> keys;
  for (const Finest& f : finest) keys.push_back(f.key);
  for (int l = level; l > 0; --l) {
    std::map<unsigned, double> counts;
    std::vector<std::uint64_t> parents;
    unsigned mask = 0;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      mask |= 1u << (keys[i] & 7);
      if (i + 1 < keys.size() && keys[i + 1] >> 3 == keys[i] >> 3) continue;
      ++counts[mask];
      parents.push_back(keys[i] >> 3);
      mask = 0;
    }
    for (const auto& [byte, n] : counts) bits -= n * std::log2(n / static_cast<double>(parents.size()));
    keys = std::move(parents);
  }
  constexpr std::size_t kCluster = 1600;  // about this number of voxels
  for (std::size_t first = 0; first < finest.size(); first += kCluster) {
    std::vector<std::pair<int, int>> normal, offset;
    int context = 2;
    for (std::size_t i = first; i < std::min(first + kCluster, finest.size()); ++i) {
      const Finest before = i > first ? finest[i - 1] : Finest{finest[i].key, 0, 0, 0};
      const int du = (finest[i].u - before.u) >> normal_shift, dv = (finest[i].v - before.v) >> normal_shift;
      normal.emplace_back(context, du);
      normal.emplace_back(context, dv);
      // Offset of the previous voxel's plane, seen from this voxel.
      const auto m = qnv::octahedral_normal(before.u, before.v);
      const glm::vec3 step = qnv::voxel_cell(finest[i].key) - qnv::voxel_cell(before.key);
      const double along = (static_cast<double>(m[0]) * step.x + static_cast<double>(m[1]) * step.y +
                            static_cast<double>(m[2]) * step.z) /
                           qnv::kOctahedral;
      const int predicted = qnv::clamp_offset(static_cast<int>(std::lround(before.offset - along * qnv::kOffsetUnits)));
      offset.emplace_back(context, (finest[i].offset - predicted) >> offset_shift);
      context = std::min(2, std::max(std::abs(du), std::abs(dv)));
    }
    bits += residual_bits(normal) + residual_bits(offset) + 8.0 * (qnv::kClusterHeaderSize + 16);
  }
  return bits;
}

void measure(const std::string& file, const render::RenderList& list, int level, bool compact) {
  const app::SurfaceSummary summary = app::summarize_surface(list);
  const qnv::Cube cube = qnv::Cube::around({glm::vec3(summary.box.lower), glm::vec3(summary.box.upper)});
  qnv::PackedOptions options;
  options.compact = compact;
  double encode_seconds = 1e300;
  std::vector<qnv::EncodedCluster> clusters;
  for (int run = 0; run < 3; ++run) {
    const auto start = Clock::now();
    qnv::SurfaceVoxelizer voxelizer(cube, level);
    app::for_each_triangle(list, [&](std::span<const qnv::Triangle> triangles) {
      voxelizer.add(triangles);
      return true;
    });
    clusters = qnv::encode_packed(voxelizer.finish(), level, cube, options);
    encode_seconds = std::min(encode_seconds, seconds_since(start));
  }
  std::vector<qnv::Cluster> decoded(clusters.size());
  double decode_seconds = 1e300;
  for (int run = 0; run < 7; ++run) {
    const auto start = Clock::now();
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      const std::uint32_t parent = clusters[i].header.parent;
      auto made = qnv::decode_cluster(clusters[i].payload, parent == qnv::kNoParent ? nullptr : &decoded[parent]);
      decoded[i] = std::move(std::get<qnv::Cluster>(made));
    }
    decode_seconds = std::min(decode_seconds, seconds_since(start));
  }
  std::size_t bytes = 0, all = 0;
  std::vector<Finest> finest;
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    bytes += clusters[i].payload.size();
    all += decoded[i].voxels.size();
    const qnv::PackedVoxels& v = decoded[i].voxels;
    if (decoded[i].level() == level)
      for (std::size_t k = 0; k < v.size(); ++k) {
        std::uint64_t key = 0;
        for (int b = 0; b < level; ++b)
          key |= (std::uint64_t{v.x[k]} >> b & 1) << (3 * b) | (std::uint64_t{v.y[k]} >> b & 1) << (3 * b + 1) |
                 (std::uint64_t{v.z[k]} >> b & 1) << (3 * b + 2);
        finest.push_back({key, v.u[k], v.v[k], v.offset[k]});
      }
  }
  const auto vectors = static_cast<double>(finest.size());
  const double once = bits_at_once(finest, level, options.normal_shift - (!compact && level >= 8 ? 1 : 0),
                                   options.offset_shift - (!compact && level >= 6 ? 1 : 0));
  std::printf("| %s | %s | %d | %zu | %.2f | %+.1f %% | %.2f | %.1f | %.1f |\n",
              std::filesystem::path(file).filename().string().c_str(), compact ? "compact" : "fine", level,
              finest.size(), static_cast<double>(bytes) * 8 / vectors,
              (static_cast<double>(bytes) * 8 / once - 1) * 100,
              static_cast<double>(summary.triangles) / encode_seconds / 1e6, vectors / encode_seconds / 1e6,
              static_cast<double>(all) / decode_seconds / 1e6);
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** arguments) {
  std::printf(
      "| model | steps | level | vectors | bits a vector | beside at once | encoding, M triangles/s | M vectors/s | "
      "decoding, M vectors/s a core |\n");
  std::printf("|---|---|---:|---:|---:|---:|---:|---:|---:|\n");
  for (int i = 1; i < count; ++i) {
    app::LoadedWorld world = app::load_world(arguments[i]);
    if (!world.scene) return 1;
    render::MeshCache cache;
    const render::RenderList list = render::collect(*world.scene, world.images, cache);
    for (const int level : {8, 9})
      for (const bool compact : {true, false}) measure(arguments[i], list, level, compact);
  }
  return count > 1 ? 0 : 2;
}
