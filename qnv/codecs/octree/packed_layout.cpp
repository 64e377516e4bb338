#include "qnv/codecs/octree/packed_layout.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gs::qnv {
namespace {

std::uint32_t byte_at(std::span<const std::byte> bytes, std::size_t i) {
  return std::to_integer<std::uint32_t>(bytes[i]);
}

void put(std::vector<std::byte>& out, std::uint32_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::byte>(value >> (8 * i) & 255));
}

}  // namespace

void PackedVoxels::resize(std::size_t size, bool colored) {
  x.resize(size);
  y.resize(size);
  z.resize(size);
  u.resize(size);
  v.resize(size);
  offset.resize(size);
  state.resize(size);
  if (!colored) return;
  luma.resize(size);
  co.resize(size);
  cg.resize(size);
}

float plane_section(const glm::vec3& m, float offset) {
  const float length = std::sqrt(glm::dot(m, m));
  const float largest = std::max({std::abs(m.x), std::abs(m.y), std::abs(m.z)});
  const float flat = std::abs(2 * largest - 1) * 0.5f, away = std::abs(offset);
  const float area = length / std::max(largest, 1 - largest);
  return away > flat ? area * std::max(0.1f, (0.5f - away) / (0.5f - flat)) : area;
}

PackedVoxels root_voxel(bool colored) {
  PackedVoxels root;
  root.resize(1, colored);
  root.state[0] = kActivity;
  if (colored) root.luma[0] = 128;
  return root;
}

PackedVoxels chosen_voxels(const PackedVoxels& from, std::span<const std::uint32_t> indices) {
  PackedVoxels out;
  out.resize(indices.size(), !from.luma.empty());
  const auto gather = [&](const auto& source, auto& target) {
    for (std::size_t i = 0; i < target.size(); ++i) target[i] = source[indices[i]];
  };
  gather(from.x, out.x);
  gather(from.y, out.y);
  gather(from.z, out.z);
  gather(from.u, out.u);
  gather(from.v, out.v);
  gather(from.offset, out.offset);
  gather(from.state, out.state);
  gather(from.luma, out.luma);
  gather(from.co, out.co);
  gather(from.cg, out.cg);
  return out;
}

std::variant<ClusterHeader, PackedError> read_cluster_place(std::span<const std::byte> payload,
                                                            std::size_t header_bytes) {
  if (payload.size() < header_bytes)
    return PackedError{"a cluster of " + std::to_string(payload.size()) + " bytes; expected " +
                       std::to_string(header_bytes) + " at least"};
  const auto u16 = [&](std::size_t i) { return byte_at(payload, i) | byte_at(payload, i + 1) << 8; };
  const auto u32 = [&](std::size_t i) { return u16(i) | u16(i + 2) << 16; };
  ClusterHeader header;
  header.id = u32(0);
  header.parent = u32(4);
  header.first = static_cast<std::uint16_t>(u16(8));
  header.count = static_cast<std::uint16_t>(u16(10));
  header.level = static_cast<std::uint8_t>(byte_at(payload, 12));
  header.levels = static_cast<std::uint8_t>(byte_at(payload, 13));
  if (header.levels < 1 || header.level + header.levels > kDeepestLevel)
    return PackedError{"a cluster divides level " + std::to_string(header.level) + " " + std::to_string(header.levels) +
                       " times; expected at least once, and at most to level " + std::to_string(kDeepestLevel)};
  if (header.count == 0) return PackedError{"a cluster divides no voxel"};
  if (header.id == kNoParent) return PackedError{"a cluster with the reserved number"};
  if (header.parent == kNoParent && (header.level != 0 || header.first != 0 || header.count != 1))
    return PackedError{"a cluster without a parent does not divide the root"};
  return header;
}

std::variant<ClusterHeader, PackedError> read_cluster_header(std::span<const std::byte> payload) {
  auto read = read_cluster_place(payload, kClusterHeaderSize);
  if (std::holds_alternative<PackedError>(read)) return read;
  if ((byte_at(payload, 14) & 0x80) != 0 || (byte_at(payload, 15) & 0x80) != 0 || (byte_at(payload, 20) & 0xf8) != 0 ||
      byte_at(payload, 21) != 0)
    return PackedError{"a cluster of a later version: reserved bits are set"};
  return read;
}

void write_cluster_place(const ClusterHeader& header, std::vector<std::byte>& out) {
  put(out, header.id, 4);
  put(out, header.parent, 4);
  put(out, header.first, 2);
  put(out, header.count, 2);
  put(out, header.level, 1);
  put(out, header.levels, 1);
}

ClusterParameters read_parameters(std::span<const std::byte> header) {
  ClusterParameters p;
  const std::uint32_t flags = byte_at(header, 14), shifts = byte_at(header, 15);
  p.occupancy = static_cast<std::uint8_t>(flags & 7);
  p.doubles = (flags & 8) != 0;
  p.colored = (flags & 16) != 0;
  p.normals_around = (flags & 32) != 0;
  p.offsets_around = (flags & 64) != 0;
  p.normal_shift = static_cast<std::uint8_t>(shifts & 15);
  p.offset_shift = static_cast<std::uint8_t>(shifts >> 4 & 7);
  const std::uint32_t models = byte_at(header, 16) | byte_at(header, 17) << 8 | byte_at(header, 18) << 16;
  for (std::size_t i = 0; i < kResidualContexts; ++i) {
    p.normal[i] = static_cast<std::uint8_t>(models >> (4 * i) & 15);
    p.offset[i] = static_cast<std::uint8_t>(models >> (4 * (i + 3)) & 15);
  }
  p.luma = static_cast<std::uint8_t>(byte_at(header, 19) & 15);
  p.chroma = static_cast<std::uint8_t>(byte_at(header, 19) >> 4);
  p.color_shift = static_cast<std::uint8_t>(byte_at(header, 20) & 7);
  return p;
}

void write_cluster_header(const ClusterHeader& header, const ClusterParameters& p, std::vector<std::byte>& out) {
  write_cluster_place(header, out);
  put(out,
      p.occupancy | (p.doubles ? 8u : 0u) | (p.colored ? 16u : 0u) | (p.normals_around ? 32u : 0u) |
          (p.offsets_around ? 64u : 0u),
      1);
  put(out, p.normal_shift | static_cast<std::uint32_t>(p.offset_shift) << 4, 1);
  std::uint32_t models = 0;
  for (std::size_t i = 0; i < kResidualContexts; ++i)
    models |= static_cast<std::uint32_t>(p.normal[i]) << (4 * i) | static_cast<std::uint32_t>(p.offset[i])
                                                                       << (4 * (i + 3));
  put(out, models, 3);
  put(out, p.luma | static_cast<std::uint32_t>(p.chroma) << 4, 1);
  put(out, p.color_shift, 1);
  put(out, 0, 1);
}

}  // namespace gs::qnv
