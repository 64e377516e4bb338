#include "qnv/codecs/octree/encode/packed_quantize.h"

#include "qnv/codecs/octree/encode/cluster_tree.h"
#include "qnv/codecs/octree/encode/residual_coding.h"
#include "qnv/codecs/octree/packed_neighbours.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace gs::qnv {
namespace {

// Maximum length of a voxel's mean unit normal at which the voxel counts as a thin, two-sided sheet.
constexpr float kDoubleLength = 0.35f;
// Weight of displacement errors: radians of normal error that cost as much as a displacement by the object's size.
constexpr double kDisplacementWeight = 20;
// Weight of area that a splat covers outside the surface, relative to area with a normal error of one radian.
constexpr double kOverspillWeight = 0.3;

struct DiscPlane {
  glm::vec3 normal{0, 0, 1};  // unit vector
  float offset = 0;  // distance from the centre, -1/2..1/2, relative to edge times 1-norm
  bool doubled = false;
};

glm::vec3 principal_axis(const std::array<float, 6>& s) {
  const glm::mat3 m(s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5]);
  glm::vec3 axis(0.8f, 0.5f, 0.33f);
  for (int i = 0; i < 32; ++i) {
    const glm::vec3 next = m * axis;
    const float length = std::sqrt(glm::dot(next, next));
    if (!(length > 1e-20f)) return {0, 0, 1};
    axis = next / length;
  }
  return axis;
}

float one_norm(const glm::vec3& n) { return std::abs(n.x) + std::abs(n.y) + std::abs(n.z); }

DiscPlane plane_of(const SurfaceMoments& m) {
  DiscPlane plane;
  const float length = std::sqrt(glm::dot(m.normal, m.normal));
  plane.doubled = !(length > kDoubleLength * m.area);
  if (plane.doubled) {
    plane.normal = principal_axis(m.spread);
    if (glm::dot(plane.normal, m.normal) < 0) plane.normal = -plane.normal;
  } else {
    plane.normal = m.normal / length;
  }
  if (m.area > 0) plane.offset = glm::dot(plane.normal, m.position / m.area) / one_norm(plane.normal);
  plane.offset = std::clamp(plane.offset, -0.5f, 0.5f);
  return plane;
}

// Returns the octahedral coordinates of a normal, not rounded.
std::array<float, 2> octahedral(glm::vec3 n) {
  n = n * (static_cast<float>(kOctahedral) / one_norm(n));
  if (n.z >= 0) return {n.x, n.y};
  const auto r = static_cast<float>(kOctahedral);
  return {(r - std::abs(n.y)) * (n.x < 0 ? -1.0f : 1.0f), (r - std::abs(n.x)) * (n.y < 0 ? -1.0f : 1.0f)};
}

glm::vec3 unit_normal(int u, int v) {
  const auto m = octahedral_normal(u, v);
  return glm::normalize(glm::vec3(static_cast<float>(m[0]), static_cast<float>(m[1]), static_cast<float>(m[2])));
}

// Finds the smallest residual that leads from (from_u, from_v) to a normal; may cross the edges of the square.
void normal_difference(const glm::vec3& normal, int from_u, int from_v, int shift, int& du, int& dv) {
  const auto [u, v] = octahedral(normal);
  const auto r2 = static_cast<float>(2 * kOctahedral), step = static_cast<float>(1 << shift);
  const std::array<std::array<float, 2>, 3> images = {
      {{u, v}, {(u < 0 ? -r2 : r2) - u, -v}, {-u, (v < 0 ? -r2 : r2) - v}}};
  int best = std::numeric_limits<int>::max();
  for (const auto& image : images) {
    const auto a = static_cast<int>(std::lround((image[0] - static_cast<float>(from_u)) / step));
    const auto b = static_cast<int>(std::lround((image[1] - static_cast<float>(from_v)) / step));
    if (std::abs(a) + std::abs(b) < best) {
      best = std::abs(a) + std::abs(b);
      du = a;
      dv = b;
    }
  }
}

int rounded(float value, int shift) { return static_cast<int>(std::lround(value / static_cast<float>(1 << shift))); }

class Quantizer {
 public:
  Quantizer(const PackedVoxels& from, const ClusterParameters& shifts, double edge, LevelSymbols& out)
      : from_(from), p_(shifts), edge_(edge), out_(out) {}

  void parent(std::size_t index, std::span<const Voxel> children, const FaceChanges& changes) {
    LevelSymbols::Parent entry{};
    entry.index = static_cast<std::uint32_t>(index);
    entry.first_child = static_cast<std::uint32_t>(out_.children.size());
    const std::array<int, 3> normal = octahedral_normal(from_.u[index], from_.v[index]);
    for (unsigned c = 0; c < 8; ++c)
      entry.bins[c] = static_cast<std::uint8_t>(occupancy_bin(along(normal, c), from_.offset[index]));
    changes_ = changes;
    gain_ = 0;
    double area = 0, sections = 0;
    for (const Voxel& voxel : children) {
      entry.mask = static_cast<std::uint8_t>(entry.mask | 1u << (voxel.key & 7));
      child(index, voxel);
      area += voxel.moments.area;
      const std::size_t last = out_.children.size() - 1;
      sections += std::max(
          0.0f, plane_section(out_.voxels.u[last], out_.voxels.v[last], out_.voxels.offset[last]) - voxel.moments.area);
    }
    // Area that the parent's splat covers although the surface does not.
    const double overspill =
        std::max(0.0, 4.0 * plane_section(from_.u[index], from_.v[index], from_.offset[index]) - area);
    entry.gain = gain_ + kOverspillWeight * edge_ * edge_ * std::max(0.0, overspill - sections);
    out_.parents.push_back(entry);
  }

 private:
  void child(std::size_t index, const Voxel& voxel) {
    LevelSymbols::Child s{};
    const bool parent_double = (from_.state[index] & kDouble) != 0;
    s.code = static_cast<std::uint8_t>(voxel.key & 7);
    s.context = static_cast<std::uint8_t>(residual_context(from_.state[index]));
    DiscPlane plane = plane_of(voxel.moments);
    s.doubled = plane.doubled;
    int u = from_.u[index], v = from_.v[index], offset = from_.offset[index];
    if (plane.doubled || parent_double) {
      const bool opposite = glm::dot(unit_normal(u, v), plane.normal) < 0;
      if (plane.doubled && opposite) {  // a sheet has no outside; chooses the side with smaller residuals
        plane.normal = -plane.normal;
        plane.offset = -plane.offset;
      }
      s.asks_flip = parent_double && !plane.doubled;
      s.flip = s.asks_flip && opposite;
      if (s.flip) {
        flip_octahedral(u, v);
        offset = -offset;
      }
    }
    const glm::vec3 before = unit_normal(u, v);
    const int offset_before = predicted_offset(along(octahedral_normal(u, v), s.code), offset);
    const PredictedPlane expected =
        predicted_plane(u, v, offset, changes_, s.code, p_.normals_around, p_.offsets_around);
    u = expected.u;
    v = expected.v;
    offset = expected.offset;
    normal_difference(plane.normal, u, v, p_.normal_shift, s.du, s.dv);
    u += s.du * (1 << p_.normal_shift);
    v += s.dv * (1 << p_.normal_shift);
    wrap_octahedral(u, v);
    s.offset = rounded(plane.offset * kOffsetUnits - static_cast<float>(offset), p_.offset_shift);
    const int offset_after = clamp_offset(offset + s.offset * (1 << p_.offset_shift));
    gain(voxel, plane, before, unit_normal(u, v), offset_before, offset_after);
    PackedVoxels& to = out_.voxels;
    to.x.push_back(static_cast<std::uint16_t>(from_.x[index] * 2 + (s.code & 1)));
    to.y.push_back(static_cast<std::uint16_t>(from_.y[index] * 2 + (s.code >> 1 & 1)));
    to.z.push_back(static_cast<std::uint16_t>(from_.z[index] * 2 + (s.code >> 2)));
    to.u.push_back(static_cast<std::int16_t>(u));
    to.v.push_back(static_cast<std::int16_t>(v));
    to.offset.push_back(static_cast<std::int8_t>(offset_after));
    to.state.push_back(static_cast<std::uint8_t>(
        (s.doubled ? kDouble : 0) | std::min(static_cast<int>(kActivity), std::max(std::abs(s.du), std::abs(s.dv)))));
    if (p_.colored) color(index, voxel, s);
    out_.children.push_back(s);
  }

  void color(std::size_t index, const Voxel& voxel, LevelSymbols::Child& s) {
    const glm::vec3 mean = voxel.moments.color / voxel.moments.area;
    const auto whole = [](float c) { return std::clamp(static_cast<int>(std::lround(c)), 0, 255); };
    const auto want = ycocg_of(whole(mean.x), whole(mean.y), whole(mean.z));
    const auto channel = [&](const std::vector<std::int16_t>& from, std::vector<std::int16_t>& to, int wanted,
                             int shift) {
      const int d = rounded(static_cast<float>(wanted - from[index]), shift);
      to.push_back(static_cast<std::int16_t>(std::clamp(from[index] + d * (1 << shift), -1024, 1024)));
      const double better = d * (1 << shift) / 255.0;
      gain_ += voxel.moments.area * edge_ * edge_ * better * better;
      return d;
    };
    s.luma = channel(from_.luma, out_.voxels.luma, want[0], p_.color_shift);
    s.co = channel(from_.co, out_.voxels.co, want[1], p_.color_shift + 1);
    s.cg = channel(from_.cg, out_.voxels.cg, want[2], p_.color_shift + 1);
  }

  void gain(const Voxel& voxel, const DiscPlane& truth, const glm::vec3& before, const glm::vec3& after,
            int offset_before, int offset_after) {
    const auto square = [](const glm::vec3& d) { return static_cast<double>(glm::dot(d, d)); };
    const double turned = square(truth.normal - before) - square(truth.normal - after);
    const double far = std::abs(truth.offset - static_cast<float>(offset_before) / kOffsetUnits);
    const double near = std::abs(truth.offset - static_cast<float>(offset_after) / kOffsetUnits);
    gain_ += voxel.moments.area * edge_ * edge_ * std::max(0.0, turned + kDisplacementWeight * (far - near) * edge_);
  }

  const PackedVoxels& from_;
  const ClusterParameters& p_;
  double edge_, gain_ = 0;
  FaceChanges changes_;
  LevelSymbols& out_;
};

}  // namespace

float plane_section(int u, int v, int offset) {
  const auto m = octahedral_normal(u, v);
  const glm::vec3 l1 =
      glm::vec3(static_cast<float>(m[0]), static_cast<float>(m[1]), static_cast<float>(m[2])) * (1.0f / kOctahedral);
  return plane_section(l1, static_cast<float>(offset) * (1.0f / kOffsetUnits));
}

LevelSymbols quantize_level(const PackedVoxels& from, std::span<const std::span<const Voxel>> below, double edge,
                            const ClusterParameters& shifts) {
  LevelSymbols out;
  out.parents.reserve(below.size());
  Quantizer quantizer(from, shifts, edge, out);
  const bool around = shifts.normals_around || shifts.offsets_around;
  for (std::size_t first = 0; first < below.size();) {
    const std::size_t n = around ? plane_blocks().fill(from, first, below.size() - first) : below.size();
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t i = first + k;
      quantizer.parent(i, below[i],
                       around ? face_changes(from.u[i], from.v[i], from.offset[i], plane_blocks().block().around(k))
                              : FaceChanges{});
    }
    first += n;
  }
  return out;
}

LevelSymbols chosen_symbols(const LevelSymbols& all, std::size_t first, std::size_t count) {
  LevelSymbols out;
  const auto [begin, end] = choose_parents(all, first, count, out);
  out.children.assign(all.children.begin() + begin, all.children.begin() + static_cast<std::ptrdiff_t>(end));
  std::vector<std::uint32_t> voxels(end - begin);
  std::iota(voxels.begin(), voxels.end(), begin);
  out.voxels = chosen_voxels(all.voxels, voxels);
  return out;
}

std::uint64_t plane_cost(std::span<const LevelSymbols> levels) {
  std::array<ResidualHistogram, kResidualContexts> normal{}, offset{};
  for (const LevelSymbols& level : levels)
    for (const LevelSymbols::Child& child : level.children) {
      count(normal[child.context], child.du);
      count(normal[child.context], child.dv);
      count(offset[child.context], child.offset);
    }
  std::uint64_t cost = 0;
  for (std::size_t i = 0; i < kResidualContexts; ++i)
    cost += cost_of(normal[i], cheapest(normal[i])) + cost_of(offset[i], cheapest(offset[i]));
  return cost;
}

void choose_models(std::span<const LevelSymbols> levels, ClusterParameters& p) {
  std::array<ResidualHistogram, kResidualContexts> normal{}, offset{};
  ResidualHistogram luma{}, chroma{};
  std::array<std::array<std::uint32_t, 2>, kOccupancyBins> occupied{};
  for (const LevelSymbols& level : levels) {
    for (const LevelSymbols::Parent& parent : level.parents)
      for (unsigned c = 0; c < 8; ++c) ++occupied[parent.bins[c]][parent.mask >> c & 1];
    for (const LevelSymbols::Child& child : level.children) {
      p.doubles = p.doubles || child.doubled || child.asks_flip;
      count(normal[child.context], child.du);
      count(normal[child.context], child.dv);
      count(offset[child.context], child.offset);
      count(luma, child.luma);
      count(chroma, child.co);
      count(chroma, child.cg);
    }
  }
  for (std::size_t i = 0; i < kResidualContexts; ++i) {
    p.normal[i] = cheapest(normal[i]);
    p.offset[i] = cheapest(offset[i]);
  }
  if (p.colored) {
    p.luma = cheapest(luma);
    p.chroma = cheapest(chroma);
  }
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t m = 0; m < kOccupancyModels; ++m) {
    double cost = 0;
    for (std::size_t b = 0; b < kOccupancyBins; ++b) {
      const double probability = occupancy_models()[m][b] / static_cast<double>(kRansTotal);
      cost -= occupied[b][1] * std::log2(probability) + occupied[b][0] * std::log2(1 - probability);
    }
    if (cost < least) {
      least = cost;
      p.occupancy = static_cast<std::uint8_t>(m);
    }
  }
}

void put_level(const LevelSymbols& level, const ClusterParameters& p, RansEncoder& rans) {
  const auto& occupancy = occupancy_models()[p.occupancy];
  for (const LevelSymbols::Parent& parent : level.parents)
    for (unsigned c = 0; c < 8; ++c) put_bit(rans, c, occupancy[parent.bins[c]], (parent.mask >> c & 1) != 0);
  const auto& children = level.children;
  const std::size_t n = children.size();
  if (p.doubles) {
    for (std::size_t i = 0; i < n; ++i) put_bit(rans, i % kRansLanes, kDoubleProbability, children[i].doubled);
    for (std::size_t i = 0; i < n; ++i)
      if (children[i].asks_flip) put_bit(rans, i % kRansLanes, kRansTotal / 2, children[i].flip);
  }
  const auto normal = [&](std::size_t i) { return p.normal[children[i].context]; };
  const auto offset = [&](std::size_t i) { return p.offset[children[i].context]; };
  const auto luma = [&](std::size_t) { return p.luma; };
  const auto chroma = [&](std::size_t) { return p.chroma; };
  put_residuals(
      rans, n, [&](std::size_t i) { return children[i].du; }, normal);
  put_residuals(
      rans, n, [&](std::size_t i) { return children[i].dv; }, normal);
  put_residuals(
      rans, n, [&](std::size_t i) { return children[i].offset; }, offset);
  if (!p.colored) return;
  put_residuals(
      rans, n, [&](std::size_t i) { return children[i].luma; }, luma);
  put_residuals(
      rans, n, [&](std::size_t i) { return children[i].co; }, chroma);
  put_residuals(
      rans, n, [&](std::size_t i) { return children[i].cg; }, chroma);
}

}  // namespace gs::qnv
