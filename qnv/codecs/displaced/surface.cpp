#include "qnv/codecs/displaced/surface.h"

#include "base/bytes.h"
#include "qnv/base/short_number.h"
#include "qnv/codecs/displaced/cluster_coder.h"
#include "qnv/codecs/displaced/subdivision.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace gs::qnv::displaced {
namespace {

Rgb8 to_rgb(int y, int co, int cg) {
  const int t = y - (cg >> 1), g = cg + t, b = t - (co >> 1), r = b + co;
  const auto clamped = [](int c) { return static_cast<std::uint8_t>(std::clamp(c, 0, 255)); };
  return {clamped(r), clamped(g), clamped(b)};
}

}  // namespace

std::vector<std::byte> encode_stage(const StageHeader& header, std::span<const std::byte> base) {
  std::vector<std::byte> out;
  out.reserve(base.size() + 4);
  for (const int byte :
       {header.depth, header.step_exponent, (header.colored ? 1 : 0) | (header.beside ? 2 : 0), header.clusters})
    out.push_back(static_cast<std::byte>(byte));
  out.insert(out.end(), base.begin(), base.end());
  return out;
}

std::optional<StageHeader> decode_stage(std::span<const std::byte> bytes) {
  if (bytes.size() < 5) return {};
  StageHeader header;
  header.depth = std::to_integer<int>(bytes[0]);
  header.step_exponent = std::to_integer<int>(bytes[1]);
  const int flags = std::to_integer<int>(bytes[2]);
  header.clusters = std::to_integer<int>(bytes[3]);
  header.colored = (flags & 1) != 0;
  header.beside = (flags & 2) != 0;
  if (header.depth > kDeepestPatch || header.step_exponent < 1 || header.step_exponent > 24 || flags > 3) return {};
  auto base = decode_base(bytes.subspan(4), kMaxTriangles);
  if (!base || base->triangles.empty()) return {};
  header.base = std::move(*base);
  return header;
}

std::vector<std::byte> encode_cluster_header(const ClusterHeader& header) {
  std::vector<std::byte> out;
  out.push_back(static_cast<std::byte>(static_cast<int>(header.kind) | header.stage << 4));
  if (header.kind == ClusterHeader::Kind::base) return out;
  out.push_back(static_cast<std::byte>(header.level | header.layer << 4));
  put_number(out, header.first);
  put_number(out, header.count);
  return out;
}

std::optional<ClusterHeader> decode_cluster_header(std::span<const std::byte> payload) {
  ByteReader reader(payload);
  ClusterHeader header;
  const auto kind = reader.integer<std::uint8_t>();
  header.kind = static_cast<ClusterHeader::Kind>(kind & 15);
  header.stage = kind >> 4;
  if (!reader.good() || header.kind > ClusterHeader::Kind::color) return {};
  if (header.kind == ClusterHeader::Kind::base) {
    header.bytes = 1;
    return header;
  }
  const auto level = reader.integer<std::uint8_t>();
  header.level = level & 15;
  header.layer = level >> 4;
  header.first = get_number(reader);
  header.count = get_number(reader);
  if (!reader.good() || header.level < 1 || header.level > kDeepestPatch || header.layer >= kLayers ||
      header.count == 0 || header.first > kMaxTriangles || header.count > kMaxTriangles)
    return {};
  header.bytes = payload.size() - reader.left();
  return header;
}

Frame::Frame(const Box& box) : lower(box.lower), size(std::max({box.size().x, box.size().y, box.size().z})) {
  if (!(size > 0)) size = std::numeric_limits<float>::min();
}

Surface::Surface(StageHeader header)
    : header_(std::move(header)),
      patches_(header_.base.triangles, static_cast<std::uint32_t>(header_.base.vertices.size())) {
  patches_.set_creases(header_.base.creases);
  slots_ = patches_.cut();
  lines_ = patches_.has_lines();
}

float Surface::step(int layer) const { return std::ldexp(1.0f, -header_.step_exponent - kLayerShift * layer); }

LevelNumbers& Surface::sparse(int layer, int level) {
  LevelNumbers& found = numbers_[static_cast<std::size_t>(layer)][static_cast<std::size_t>(level)];
  if (found.normal.empty()) {
    found.normal.assign_zeros(patches_.vertices_at(level));
    if (lines_ && level > 0) found.sideways.assign_zeros(patches_.inner_start(0, level) - patches_.base_vertices());
  }
  return found;
}

std::array<NumberArray, 3>& Surface::sparse_colors(int level) {
  auto& found = colors_[static_cast<std::size_t>(level)];
  for (auto& channel : found)
    if (channel.empty()) channel.assign_zeros(patches_.vertices_at(level));
  return found;
}

LevelNumbers& Surface::numbers(int layer, int level) {
  LevelNumbers& found = sparse(layer, level);
  found.normal.fill_pages();
  found.sideways.fill_pages();
  return found;
}

std::array<NumberArray, 3>& Surface::colors(int level) {
  auto& found = sparse_colors(level);
  for (NumberArray& channel : found) channel.fill_pages();
  return found;
}

const LevelNumbers* Surface::find(int layer, int level) const {
  const LevelNumbers& found = numbers_[static_cast<std::size_t>(layer)][static_cast<std::size_t>(level)];
  return found.normal.empty() ? nullptr : &found;
}

// Accepts numbers for each patch only once. Otherwise the result would depend on the order of the clusters, and
// repeated clusters could occupy a decoder forever.
bool Surface::add_run(const ClusterHeader& cluster) {
  const int kind = cluster.kind == ClusterHeader::Kind::color ? kLayers : cluster.layer;
  std::vector<bool>& taken = taken_[static_cast<std::size_t>(kind)][static_cast<std::size_t>(cluster.level)];
  taken.resize(patches_.size());
  const auto first = taken.begin() + static_cast<std::ptrdiff_t>(cluster.first);
  const auto end = first + static_cast<std::ptrdiff_t>(cluster.count);
  if (std::find(first, end, true) != end) return false;
  std::fill(first, end, true);
  return true;
}

bool Surface::add(const ClusterHeader& cluster, std::span<const std::byte> payload) {
  const bool color = cluster.kind == ClusterHeader::Kind::color;
  if (cluster.level > header_.depth || cluster.first >= patches_.size() ||
      cluster.count > patches_.size() - cluster.first || (color && !header_.colored) || !add_run(cluster))
    return false;
  ++clusters_;
  cluster_bytes_ += payload.size();
  BinaryDecoder decoder(payload.subspan(cluster.bytes));
  if (color) {
    auto &base = sparse_colors(0), &now = sparse_colors(cluster.level);
    for (std::size_t channel = 0; channel < 3; ++channel) {
      ClusterCoder<BinaryDecoder> coder(decoder, patches_, cluster.first, cluster.count);
      if (cluster.level == 1 && !coder.base(base[channel])) return false;
      if (!coder.level(cluster.level, now[channel], nullptr)) return false;
    }
    return true;
  }
  finest_ = std::max(finest_, cluster.level);
  ClusterCoder<BinaryDecoder> coder(decoder, patches_, cluster.first, cluster.count);
  if (cluster.level == 1 && !coder.base(sparse(cluster.layer, 0).normal)) return false;
  LevelNumbers& now = sparse(cluster.layer, cluster.level);
  return coder.level(cluster.level, now.normal, &now.sideways);
}

std::vector<glm::vec3> Surface::base_positions() const {
  std::vector<glm::vec3> positions;
  positions.reserve(header_.base.vertices.size());
  const float cell = std::ldexp(1.0f, -header_.base.bits);
  for (const glm::ivec3& v : header_.base.vertices) positions.push_back((glm::vec3(v) + 0.5f) * cell);
  return positions;
}

std::vector<glm::vec3> Surface::base_normals(const std::vector<glm::vec3>& places) const {
  const std::vector<glm::vec3> at_slots = slot_normals(patches_, slots_, 0, places);
  std::vector<glm::vec3> normals(places.size(), glm::vec3(0));
  for (std::uint32_t p = 0; p < patches_.size(); ++p)
    for (std::size_t k = 0; k < 3; ++k) normals[patches_.triangles()[p][k]] += at_slots[slots_.triangles()[p][k]];
  for (glm::vec3& n : normals) {
    const float length = glm::length(n);
    n = length > 0 ? n / length : glm::vec3(0);
  }
  return normals;
}

std::vector<glm::vec3> Surface::positions(int level) const {
  std::vector<glm::vec3> places = base_positions();
  // Accumulates the shifts of finer layers separately. Predictions use layer 0 only, so that they do not depend on the
  // received part of finer layers.
  bool finer = false;
  for (int layer = 1; layer < kLayers; ++layer)
    for (int l = 0; l <= level; ++l) finer = finer || find(layer, l);
  std::vector<glm::vec3> shifts(finer ? places.size() : 0, glm::vec3(0)), next_shifts;
  std::vector<glm::vec3> normals = base_normals(places);
  for (int layer = 0; layer < kLayers; ++layer)
    if (const LevelNumbers* numbers = find(layer, 0))
      for (std::size_t v = 0; v < places.size(); ++v)
        (layer == 0 ? places : shifts)[v] += normals[v] * (step(layer) * static_cast<float>(numbers->normal[v]));
  std::vector<glm::vec3> next;
  for (int l = 1; l <= level; ++l) {
    normals = slot_normals(patches_, slots_, l - 1, places);
    std::array<const LevelNumbers*, kLayers> numbers{};
    for (int layer = 0; layer < kLayers; ++layer) numbers[static_cast<std::size_t>(layer)] = find(layer, l);
    next.resize(patches_.vertices_at(l));
    if (finer) next_shifts.resize(next.size());
    visit_level(
        patches_, slots_, l,
        [&](const NewVertex& fresh) {
          const std::uint32_t v = fresh.vertex;
          const bool line = fresh.edge != kNone && patches_.edges()[fresh.edge].line();
          const Prediction p = predict(fresh, line, places, normals);
          const auto moved = [&](int layer) {
            const LevelNumbers* of = numbers[static_cast<std::size_t>(layer)];
            if (!of) return glm::vec3(0);
            glm::vec3 by = p.normal * (step(layer) * static_cast<float>(of->normal[v]));
            if (line) by += p.sideways * (step(layer) * static_cast<float>(of->sideways[v - patches_.base_vertices()]));
            return by;
          };
          next[v] = p.position + moved(0);
          if (!finer) return;
          next_shifts[v] = 0.5f * (shifts[fresh.a] + shifts[fresh.b]);
          for (int layer = 1; layer < kLayers; ++layer) next_shifts[v] += moved(layer);
        },
        [&](std::uint32_t v, std::uint32_t before) {
          next[v] = places[before];
          if (finer) next_shifts[v] = shifts[before];
        });
    places.swap(next);
    if (finer) shifts.swap(next_shifts);
  }
  for (std::size_t v = 0; finer && v < places.size(); ++v) places[v] += shifts[v];
  return places;
}

std::vector<Rgb8> Surface::vertex_colors(int level) const {
  if (!header_.colored || colors_[0][0].empty()) return {};
  std::vector<glm::ivec3> now(patches_.base_vertices()), next;
  const glm::ivec3 steps(kLumaStep, kChromaStep, kChromaStep);
  for (std::size_t v = 0; v < now.size(); ++v)
    now[v] = glm::ivec3(128, 0, 0) + steps * glm::ivec3(colors_[0][0][v], colors_[0][1][v], colors_[0][2][v]);
  for (int l = 1; l <= level; ++l) {
    const auto& numbers = colors_[static_cast<std::size_t>(l)];
    next.resize(patches_.vertices_at(l));
    visit_level(
        patches_, slots_, l,
        [&](const NewVertex& fresh) {
          const std::uint32_t v = fresh.vertex;
          const glm::ivec3 sum = now[fresh.a] + now[fresh.b];
          next[v] = {sum.x >> 1, sum.y >> 1, sum.z >> 1};
          if (!numbers[0].empty()) next[v] += steps * glm::ivec3(numbers[0][v], numbers[1][v], numbers[2][v]);
        },
        [&](std::uint32_t v, std::uint32_t before) { next[v] = now[before]; });
    now.swap(next);
  }
  std::vector<Rgb8> colors;
  colors.reserve(now.size());
  for (const glm::ivec3& c : now) colors.push_back(to_rgb(c.x, c.y, c.z));
  return colors;
}

std::vector<std::uint32_t> Surface::vertices_of_slots(int level) const {
  std::vector<std::uint32_t> vertices(slots_.vertices_at(level), 0), grid, slot_grid;
  for (std::uint32_t p = 0; p < patches_.size(); ++p) {
    patches_.grid(p, level, grid);
    slots_.grid(p, level, slot_grid);
    for (std::size_t i = 0; i < grid.size(); ++i) vertices[slot_grid[i]] = grid[i];
  }
  return vertices;
}

std::vector<std::uint32_t> Surface::triangles(int level) const {
  const std::size_t n = std::size_t{1} << level;
  std::vector<std::uint32_t> corners, grid;
  corners.reserve(patches_.size() * n * n * 3);
  for (std::uint32_t p = 0; p < patches_.size(); ++p) {
    slots_.grid(p, level, grid);
    for (std::size_t j = 0; j < n; ++j) {
      const std::uint32_t* row = grid.data() + row_start(j, n);
      const std::uint32_t* above = grid.data() + row_start(j + 1, n);
      for (std::size_t i = 0; i + j < n; ++i) {
        corners.insert(corners.end(), {row[i], row[i + 1], above[i]});
        if (i + j + 1 < n) corners.insert(corners.end(), {row[i + 1], above[i + 1], above[i]});
      }
    }
  }
  return corners;
}

}  // namespace gs::qnv::displaced
