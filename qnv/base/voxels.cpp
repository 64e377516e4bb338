#include "qnv/base/voxels.h"

#include "base/finite.h"
#include "qnv/base/morton.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gs::qnv {

// Voxels of one block, as a hash table with open addressing. Keys are Morton codes inside the block; values are
// moments.
struct VoxelBlock {
  std::vector<std::uint32_t> slots;  // 0 means free; otherwise 1 + index
  std::vector<std::uint32_t> keys;
  std::vector<MomentSums> moments;

  MomentSums& at(std::uint32_t key) {
    if (keys.size() * 2 >= slots.size()) grow();
    const std::size_t mask = slots.size() - 1;
    std::size_t slot = (key * 2654435761u >> 7) & mask;
    while (slots[slot] != 0) {
      if (keys[slots[slot] - 1] == key) return moments[slots[slot] - 1];
      slot = (slot + 1) & mask;
    }
    keys.push_back(key);
    moments.emplace_back();
    slots[slot] = static_cast<std::uint32_t>(keys.size());
    return moments.back();
  }

  void grow() {
    slots.assign(std::max<std::size_t>(256, slots.size() * 2), 0);
    const std::size_t mask = slots.size() - 1;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      std::size_t slot = (keys[i] * 2654435761u >> 7) & mask;
      while (slots[slot] != 0) slot = (slot + 1) & mask;
      slots[slot] = static_cast<std::uint32_t>(i + 1);
    }
  }
};

namespace {

// log2 of a block's edge in voxels. Small enough that the table stays in the processor's cache; large enough that few
// triangles cross blocks.
constexpr int kBlockBits = 5;
constexpr std::size_t kBatch = std::size_t{1} << 19;        // maximum number of triangles in a batch
constexpr std::size_t kMaxMeetings = std::size_t{1} << 22;  // maximum number of triangle-block pairs in one batch
constexpr std::uint32_t kBlockEdge = 1u << kBlockBits;

// Corner of a clipped triangle: position in voxels from the block's corner, and barycentric coordinates.
struct ClippedCorner {
  glm::vec3 p;
  float b1, b2;
};

struct ClippedPolygon {
  static constexpr int kMax = 12;  // a triangle clipped by six planes has at most nine
  std::array<ClippedCorner, kMax> corners;
  int size = 0;
  ClippedPolygon() = default;
  // Copies only the used corners, mostly three or four.
  ClippedPolygon(const ClippedPolygon& other) { *this = other; }
  ClippedPolygon& operator=(const ClippedPolygon& other) {
    size = other.size;
    for (int i = 0; i < size; ++i) corners[static_cast<std::size_t>(i)] = other.corners[static_cast<std::size_t>(i)];
    return *this;
  }
  void push(const ClippedCorner& corner) {
    if (size < kMax) corners[static_cast<std::size_t>(size++)] = corner;
  }
};

// Avoids std::floor, a function call on the oldest supported processors.
int floor_of(float v) {
  const int i = static_cast<int>(v);
  return i - (v < static_cast<float>(i) ? 1 : 0);
}

// Splits the polygon `in` at the plane p[axis] = at into `below` and `above`.
void cut(const ClippedPolygon& in, int axis, float at, ClippedPolygon& below, ClippedPolygon& above) {
  below.size = above.size = 0;
  for (int i = 0; i < in.size; ++i) {
    const ClippedCorner& a = in.corners[static_cast<std::size_t>(i)];
    const ClippedCorner& b = in.corners[static_cast<std::size_t>(i + 1 < in.size ? i + 1 : 0)];
    const float da = a.p[axis] - at, db = b.p[axis] - at;
    if (da <= 0) below.push(a);
    if (da >= 0) above.push(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
      const float t = da / (da - db);
      ClippedCorner c{a.p + (b.p - a.p) * t, a.b1 + (b.b1 - a.b1) * t, a.b2 + (b.b2 - a.b2) * t};
      c.p[axis] = at;
      below.push(c);
      above.push(c);
    }
  }
}

glm::vec3 color_of(const Rgb8& c) { return {c.r, c.g, c.b}; }

void add_to(std::array<MomentSums::Sum, 3>& sums, const glm::vec3& v) {
  for (int axis = 0; axis < 3; ++axis) sums[static_cast<std::size_t>(axis)].add(v[axis]);
}

template <int kBits>
glm::vec3 value_of(const std::array<FixedSum<kBits>, 3>& sums) {
  return {static_cast<float>(sums[0].value()), static_cast<float>(sums[1].value()),
          static_cast<float>(sums[2].value())};
}

// Divides one triangle among the voxels of one block.
struct VoxelCutter {
  VoxelBlock& block;
  const Triangle& triangle;
  glm::vec3 face{0};  // unit normal of the triangle
  std::array<glm::vec3, 3> normals{};
  std::array<glm::vec3, 3> colors{};

  void store(const std::array<int, 3>& voxel, float area, const glm::vec3& center, float b1, float b2) {
    if (!(area > 0)) return;
    const auto key = static_cast<std::uint32_t>(morton_encode(static_cast<std::uint32_t>(voxel[0]),
                                                              static_cast<std::uint32_t>(voxel[1]),
                                                              static_cast<std::uint32_t>(voxel[2])));
    MomentSums& m = block.at(key);
    const float b0 = 1 - b1 - b2;
    const glm::vec3 middle(static_cast<float>(voxel[0]) + 0.5f, static_cast<float>(voxel[1]) + 0.5f,
                           static_cast<float>(voxel[2]) + 0.5f);
    glm::vec3 normal = normals[0] * b0 + normals[1] * b1 + normals[2] * b2;
    const float length = glm::dot(normal, normal);
    normal = length > 1e-12f ? normal / std::sqrt(length) : face;
    m.area.add(area);
    add_to(m.position, (center - middle) * area);
    add_to(m.normal, normal * area);
    const glm::vec3 color = (colors[0] * b0 + colors[1] * b1 + colors[2] * b2) * area;
    for (int channel = 0; channel < 3; ++channel) m.color[static_cast<std::size_t>(channel)].add(color[channel]);
    m.spread[0].add(face.x * face.x * area);
    m.spread[1].add(face.x * face.y * area);
    m.spread[2].add(face.x * face.z * area);
    m.spread[3].add(face.y * face.y * area);
    m.spread[4].add(face.y * face.z * area);
    m.spread[5].add(face.z * face.z * area);
  }

  // Adds a polygon inside one voxel, as a fan of triangles.
  void piece(const ClippedPolygon& polygon, const std::array<int, 3>& voxel) {
    if (polygon.size < 3) return;
    float area = 0, b1 = 0, b2 = 0;
    glm::vec3 center(0);
    const ClippedCorner& a = polygon.corners[0];
    for (int i = 1; i + 1 < polygon.size; ++i) {
      const ClippedCorner& b = polygon.corners[static_cast<std::size_t>(i)];
      const ClippedCorner& c = polygon.corners[static_cast<std::size_t>(i + 1)];
      const float part = 0.5f * std::abs(glm::dot(glm::cross(b.p - a.p, c.p - a.p), face));
      area += part;
      center += (a.p + b.p + c.p) * (part / 3);
      b1 += (a.b1 + b.b1 + c.b1) * (part / 3);
      b2 += (a.b2 + b.b2 + c.b2) * (part / 3);
    }
    if (area > 0) store(voxel, area, center / area, b1 / area, b2 / area);
  }

  void slabs(const ClippedPolygon& polygon, int axis, std::array<int, 3>& voxel) {
    if (polygon.size < 3) return;
    if (axis == 3) {
      piece(polygon, voxel);
      return;
    }
    float least = polygon.corners[0].p[axis], most = least;
    for (int i = 1; i < polygon.size; ++i) {
      least = std::min(least, polygon.corners[static_cast<std::size_t>(i)].p[axis]);
      most = std::max(most, polygon.corners[static_cast<std::size_t>(i)].p[axis]);
    }
    const int edge = static_cast<int>(kBlockEdge);
    const int first = floor_of(least), last = floor_of(most);
    if (first >= edge || last < 0) return;
    if (first == last) {
      voxel[static_cast<std::size_t>(axis)] = first;
      slabs(polygon, axis + 1, voxel);
      return;
    }
    ClippedPolygon rest = polygon, below, above;
    if (first < 0) {
      cut(rest, axis, 0, below, above);
      rest = above;
    }
    for (int i = std::max(first, 0); i <= std::min(last, edge - 1); ++i) {
      voxel[static_cast<std::size_t>(axis)] = i;
      if (i == last) {
        slabs(rest, axis + 1, voxel);
        break;
      }
      cut(rest, axis, static_cast<float>(i + 1), below, above);
      slabs(below, axis + 1, voxel);
      rest = above;
      if (rest.size < 3) break;
    }
  }
};

using BlockRange = std::array<int, 2>;

// Returns the range of blocks that a polygon spans along an axis, with a margin for rounding. Positions are in voxels.
BlockRange blocks_along(const ClippedPolygon& polygon, int axis, int last) {
  constexpr float kSpare = 0.05f, kToBlock = 1.0f / static_cast<float>(kBlockEdge);
  float least = polygon.corners[0].p[axis], most = least;
  for (int i = 1; i < polygon.size; ++i) {
    least = std::min(least, polygon.corners[static_cast<std::size_t>(i)].p[axis]);
    most = std::max(most, polygon.corners[static_cast<std::size_t>(i)].p[axis]);
  }
  return {std::clamp(static_cast<int>((least - kSpare) * kToBlock), 0, last),
          std::clamp(static_cast<int>((most + kSpare) * kToBlock), 0, last)};
}

// Visits the blocks that a triangle intersects. Finds these blocks by clipping, because the bounding box of a large
// oblique triangle would contain many empty blocks.
template <class Visit>
void visit_blocks(const ClippedPolygon& polygon, int axis, int last, std::array<int, 3>& block, const Visit& visit) {
  if (polygon.size == 0) return;
  const BlockRange range = blocks_along(polygon, axis, last);
  ClippedPolygon rest = polygon, below, above;
  for (int i = range[0]; i <= range[1]; ++i) {
    block[static_cast<std::size_t>(axis)] = i;
    if (axis == 2) {
      visit(block);
      continue;
    }
    cut(rest, axis, static_cast<float>((i + 1) * static_cast<int>(kBlockEdge)), below, above);
    // If rounding left one side empty, uses the whole polygon for both sides.
    visit_blocks(below.size > 0 ? below : rest, axis + 1, last, block, visit);
    if (above.size > 0) rest = above;
  }
}

}  // namespace

Cube Cube::around(const Box& box) {
  Cube cube;
  const glm::vec3 size = box.size();
  cube.edge = std::max({size.x, size.y, size.z, std::numeric_limits<float>::min() * 4}) * 1.0001f;
  cube.lower = (box.lower * 0.5f + box.upper * 0.5f) - glm::vec3(cube.edge * 0.5f);
  return cube;
}

glm::vec3 voxel_cell(std::uint64_t key) {
  const auto cell = morton_decode(key);
  return {static_cast<float>(cell[0]), static_cast<float>(cell[1]), static_cast<float>(cell[2])};
}

void SurfaceMoments::add(const SurfaceMoments& other) {
  area += other.area;
  position += other.position;
  normal += other.normal;
  color += other.color;
  for (std::size_t i = 0; i < spread.size(); ++i) spread[i] += other.spread[i];
}

void MomentSums::add(const MomentSums& other) {
  area.add(other.area);
  for (std::size_t i = 0; i < 3; ++i) {
    position[i].add(other.position[i]);
    normal[i].add(other.normal[i]);
    color[i].add(other.color[i]);
  }
  for (std::size_t i = 0; i < spread.size(); ++i) spread[i].add(other.spread[i]);
}

SurfaceMoments MomentSums::moments() const {
  SurfaceMoments m;
  m.area = static_cast<float>(area.value());
  if (!(m.area > 0)) return {};
  // Sums of tiny areas have few bits. Clamps the rounding errors of position and length of the normal.
  m.position = glm::clamp(value_of(position), glm::vec3(-0.5f * m.area), glm::vec3(0.5f * m.area));
  m.normal = value_of(normal);
  const float length = std::sqrt(glm::dot(m.normal, m.normal));
  if (length > m.area) m.normal *= m.area / length;
  m.color = value_of(color);
  const double trace = spread[0].value() + spread[3].value() + spread[5].value();
  const double scale = trace > 0 ? area.value() / trace : 0;
  for (std::size_t i = 0; i < spread.size(); ++i) m.spread[i] = static_cast<float>(spread[i].value() * scale);
  return m;
}

struct SurfaceVoxelizer::State {
  Cube cube;
  int level;
  unsigned threads;
  int block_level;  // octree level at which a cell is a block
  float scale;      // voxels per unit
  std::vector<std::uint64_t> block_keys;
  std::vector<std::unique_ptr<VoxelBlock>> blocks;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> block_table;  // hash table with open addressing, for large grids
  std::vector<Triangle> waiting;

  std::uint32_t find_block(std::uint64_t key) {
    if (block_keys.size() * 2 >= block_table.size()) grow_table();
    const std::size_t mask = block_table.size() - 1;
    std::size_t slot = (key * 0x9e3779b97f4a7c15ULL >> 20) & mask;
    while (block_table[slot].second != 0) {
      if (block_table[slot].first == key) return block_table[slot].second - 1;
      slot = (slot + 1) & mask;
    }
    block_keys.push_back(key);
    blocks.push_back(std::make_unique<VoxelBlock>());
    block_table[slot] = {key, static_cast<std::uint32_t>(blocks.size())};
    return static_cast<std::uint32_t>(blocks.size() - 1);
  }

  void grow_table() {
    block_table.assign(std::max<std::size_t>(1024, block_table.size() * 2), {0, 0});
    const std::size_t mask = block_table.size() - 1;
    for (std::size_t i = 0; i < block_keys.size(); ++i) {
      std::size_t slot = (block_keys[i] * 0x9e3779b97f4a7c15ULL >> 20) & mask;
      while (block_table[slot].second != 0) slot = (slot + 1) & mask;
      block_table[slot] = {block_keys[i], static_cast<std::uint32_t>(i + 1)};
    }
  }

  [[nodiscard]] glm::vec3 in_voxels(const glm::vec3& p) const { return (p - cube.lower) * scale; }

  void add_to_block(VoxelBlock& block, const glm::vec3& corner, const Triangle& triangle) const {
    VoxelCutter cutter{block, triangle};
    ClippedPolygon polygon;
    polygon.size = 3;
    for (std::size_t i = 0; i < 3; ++i) {
      polygon.corners[i] = {in_voxels(triangle.positions[i]) - corner, i == 1 ? 1.0f : 0.0f, i == 2 ? 1.0f : 0.0f};
      cutter.colors[i] = color_of(triangle.colors[i]);
    }
    const glm::vec3 across =
        glm::cross(polygon.corners[1].p - polygon.corners[0].p, polygon.corners[2].p - polygon.corners[0].p);
    const float twice = std::sqrt(glm::dot(across, across));
    if (!(twice > 0)) return;
    cutter.face = across / twice;
    for (std::size_t i = 0; i < 3; ++i)
      cutter.normals[i] =
          triangle.normals[i] == glm::vec3(0) || !finite(triangle.normals[i]) ? cutter.face : triangle.normals[i];
    std::array<int, 3> voxel{};
    // In a scan, most triangles lie in one voxel.
    bool single = true;
    for (int axis = 0; axis < 3 && single; ++axis) {
      const int v = floor_of(polygon.corners[0].p[axis]);
      single = v >= 0 && v < static_cast<int>(kBlockEdge) && floor_of(polygon.corners[1].p[axis]) == v &&
               floor_of(polygon.corners[2].p[axis]) == v;
      voxel[static_cast<std::size_t>(axis)] = v;
    }
    if (single) {
      cutter.store(voxel, twice * 0.5f,
                   (polygon.corners[0].p + polygon.corners[1].p + polygon.corners[2].p) * (1.0f / 3), 1.0f / 3,
                   1.0f / 3);
    } else {
      cutter.slabs(polygon, 0, voxel);
    }
  }

  void flush() {
    for (std::size_t first = 0; first < waiting.size();) first = flush_from(first);
    waiting.clear();
  }

  // Processes waiting triangles, from index `begin_at` on. Stops after kMaxMeetings pairs of a triangle and a block,
  // but processes at least one triangle. Returns the index of the next triangle.
  std::size_t flush_from(std::size_t begin_at) {
    // Pairs of block and triangle, in the order of triangles.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> meetings;
    meetings.reserve(std::min(kMaxMeetings, waiting.size() + waiting.size() / 4));
    const int last = (1 << block_level) - 1;
    std::uint64_t recent_key = ~std::uint64_t{0};
    std::uint32_t recent = 0;
    std::size_t t = begin_at;
    for (; t < waiting.size() && meetings.size() < kMaxMeetings; ++t) {
      const auto visit = [&](const std::array<int, 3>& block) {
        const std::uint64_t key =
            morton_encode(static_cast<std::uint32_t>(block[0]), static_cast<std::uint32_t>(block[1]),
                          static_cast<std::uint32_t>(block[2]));
        if (key != recent_key) {
          recent = find_block(key);
          recent_key = key;
        }
        meetings.emplace_back(recent, static_cast<std::uint32_t>(t));
      };
      ClippedPolygon polygon;
      for (const glm::vec3& p : waiting[t].positions) polygon.push({in_voxels(p), 0, 0});
      std::array<int, 3> block{};
      bool single = true;  // usual case: the triangle touches only one block
      for (int axis = 0; axis < 3; ++axis) {
        const BlockRange range = blocks_along(polygon, axis, last);
        block[static_cast<std::size_t>(axis)] = range[0];
        single = single && range[0] == range[1];
      }
      if (single)
        visit(block);
      else
        visit_blocks(polygon, 0, last, block, visit);
    }
    std::vector<std::uint32_t> begin(blocks.size() + 1, 0), order(meetings.size());
    for (const auto& m : meetings) ++begin[m.first + 1];
    for (std::size_t i = 0; i < blocks.size(); ++i) begin[i + 1] += begin[i];
    std::vector<std::uint32_t> place(begin.begin(), begin.end() - 1);
    for (const auto& m : meetings) order[place[m.first]++] = m.second;
    parallel_for(
        blocks.size(),
        [&](std::size_t b) {
          if (begin[b] == begin[b + 1]) return;
          const auto cell = morton_decode(block_keys[b]);
          const glm::vec3 corner(static_cast<float>(cell[0] * kBlockEdge), static_cast<float>(cell[1] * kBlockEdge),
                                 static_cast<float>(cell[2] * kBlockEdge));
          for (std::uint32_t i = begin[b]; i < begin[b + 1]; ++i) add_to_block(*blocks[b], corner, waiting[order[i]]);
        },
        threads);
    return t;
  }
};

SurfaceVoxelizer::SurfaceVoxelizer(const Cube& cube, int level, unsigned threads) : state_(std::make_unique<State>()) {
  level = std::clamp(level, 1, kDeepestLevel);
  state_->cube = cube;
  state_->level = level;
  state_->threads = threads;
  state_->block_level = std::max(0, level - kBlockBits);
  state_->scale = static_cast<float>(1 << level) / cube.edge;
}

SurfaceVoxelizer::~SurfaceVoxelizer() = default;

void SurfaceVoxelizer::add(std::span<const Triangle> triangles) {
  const float most = static_cast<float>(1 << state_->level);
  for (const Triangle& triangle : triangles) {
    bool good = true;
    for (const glm::vec3& p : triangle.positions) {
      const glm::vec3 v = state_->in_voxels(p);
      good = good && v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < most && v.y < most && v.z < most;
    }
    if (!good) continue;
    state_->waiting.push_back(triangle);
    if (state_->waiting.size() == kBatch) state_->flush();
  }
}

std::vector<VoxelSums> SurfaceVoxelizer::sums() {
  State& state = *state_;
  state.flush();
  std::vector<std::uint32_t> order(state.blocks.size());
  std::vector<std::size_t> begin(state.blocks.size() + 1, 0);
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return state.block_keys[a] < state.block_keys[b]; });
  for (std::size_t i = 0; i < order.size(); ++i) begin[i + 1] = begin[i] + state.blocks[order[i]]->keys.size();
  std::vector<VoxelSums> voxels(begin.back());
  parallel_for(
      order.size(),
      [&](std::size_t i) {
        VoxelBlock& block = *state.blocks[order[i]];
        std::vector<std::uint32_t> inside(block.keys.size());
        for (std::size_t k = 0; k < inside.size(); ++k) inside[k] = static_cast<std::uint32_t>(k);
        std::sort(inside.begin(), inside.end(), [&](auto a, auto b) { return block.keys[a] < block.keys[b]; });
        for (std::size_t k = 0; k < inside.size(); ++k)
          voxels[begin[i] + k] = {state.block_keys[order[i]] << (3 * kBlockBits) | block.keys[inside[k]],
                                  block.moments[inside[k]]};
        state.blocks[order[i]].reset();
      },
      state.threads);
  return voxels;
}

std::vector<Voxel> voxels_of(std::span<const VoxelSums> sums) {
  std::vector<Voxel> voxels;
  voxels.reserve(sums.size());
  for (const VoxelSums& one : sums)
    if (const SurfaceMoments moments = one.sums.moments(); moments.area > 0) voxels.push_back({one.key, moments});
  return voxels;
}

std::vector<Voxel> SurfaceVoxelizer::finish() { return voxels_of(sums()); }

std::vector<Voxel> coarsen(std::span<const Voxel> voxels) {
  std::vector<Voxel> out;
  out.reserve(voxels.size() / 3 + 1);
  for (const Voxel& voxel : voxels) {
    const std::uint64_t key = voxel.key >> 3;
    if (out.empty() || out.back().key != key) out.push_back({key, {}});
    // Converts to units of the parent's edge: lengths halve, areas quarter. The child's centre is a quarter of the
    // parent's edge from the parent's centre.
    SurfaceMoments m = voxel.moments;
    const glm::vec3 from_parent((voxel.key & 1) != 0 ? 0.25f : -0.25f, (voxel.key & 2) != 0 ? 0.25f : -0.25f,
                                (voxel.key & 4) != 0 ? 0.25f : -0.25f);
    m.area *= 0.25f;
    m.position = m.position * 0.125f + from_parent * m.area;
    m.normal *= 0.25f;
    m.color *= 0.25f;
    for (float& s : m.spread) s *= 0.25f;
    out.back().moments.add(m);
  }
  return out;
}

}  // namespace gs::qnv
