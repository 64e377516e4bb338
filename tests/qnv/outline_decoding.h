#pragma once

#include "qnv/codecs/outlines/outline_stream.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <variant>
#include <vector>

// Decoded content of outline streams, in a form that tests can compare.
namespace gs::qnv::outlines {

using Bytes = std::vector<std::byte>;
using Point = std::array<float, 3>;

/// Decoded polygon with all its data.
struct One {
  bool inner = false;
  std::uint32_t appearance = 0, group = 0, count = 0;
  std::vector<std::vector<Point>> rings;
  std::vector<std::array<float, 2>> texture_coordinates;  // empty, or ring by ring
  auto operator<=>(const One&) const = default;
};

/// Rotates triangles to start at their smallest corner.
inline One canonical(One one) {
  if (one.rings.size() != 1 || one.rings[0].size() != 3) return one;
  const auto first = std::min_element(one.rings[0].begin(), one.rings[0].end()) - one.rings[0].begin();
  std::rotate(one.rings[0].begin(), one.rings[0].begin() + first, one.rings[0].end());
  if (!one.texture_coordinates.empty())
    std::rotate(one.texture_coordinates.begin(), one.texture_coordinates.begin() + first,
                one.texture_coordinates.end());
  return one;
}

inline void append(const OutlineBatch& batch, std::vector<One>& to) {
  const OutlinePolygons& p = batch.polygons;
  REQUIRE(batch.groups.size() == p.size());
  REQUIRE(p.areas.size() == p.size());
  REQUIRE(batch.counts.size() == (batch.inner ? 0 : p.size()));
  REQUIRE((p.texture_coordinates.empty() || p.texture_coordinates.size() == p.positions.size()));
  std::size_t ring = 0, corner = 0;
  bool good = true;
  for (std::size_t i = 0; i < p.size(); ++i) {
    One one;
    one.inner = batch.inner;
    one.appearance = batch.appearance;
    one.group = batch.groups[i];
    one.count = batch.inner ? 0 : batch.counts[i];
    good = good && p.polygon_ends[i] > ring;
    for (; ring < p.polygon_ends[i]; ++ring) {
      good = good && p.ring_ends[ring] >= corner + 3;
      auto& points = one.rings.emplace_back();
      for (; corner < p.ring_ends[ring]; ++corner) {
        points.push_back({p.positions[corner].x, p.positions[corner].y, p.positions[corner].z});
        if (!p.texture_coordinates.empty())
          one.texture_coordinates.push_back({p.texture_coordinates[corner].x, p.texture_coordinates[corner].y});
      }
    }
    to.push_back(canonical(std::move(one)));
  }
  REQUIRE(good);
  REQUIRE(corner == p.positions.size());
  REQUIRE(ring == p.ring_ends.size());
}

inline std::vector<One> take(OutlineDecoder& decoder) {
  std::vector<One> all;
  for (const OutlineBatch& batch : decoder.take()) append(batch, all);
  return all;
}

inline std::vector<One> sorted(std::vector<One> all) {
  std::sort(all.begin(), all.end());
  return all;
}

inline std::vector<One> decode_all(std::span<const std::byte> bytes) {
  OutlineDecoder decoder;
  (void)decoder.push(bytes);
  decoder.finish();
  return take(decoder);
}

inline EncodedStream encoded(const OutlineGroups& groups, std::span<const OutlineAppearance> appearances = {},
                             const OutlineEncodeOptions& options = {}) {
  auto result = encode_outlines(groups, appearances, options);
  if (const auto* error = std::get_if<EncodeError>(&result)) FAIL(error->message);
  return std::move(std::get<EncodedStream>(result));
}

struct ChunkAt {
  ChunkType type;
  std::size_t offset;  // position of its header
  Bytes payload;
};

inline std::vector<ChunkAt> chunks_of(std::span<const std::byte> bytes) {
  std::vector<ChunkAt> chunks;
  StreamReader reader;
  const auto on_chunk = [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    chunks.push_back({type, static_cast<std::size_t>(offset), Bytes(payload.begin(), payload.end())});
  };
  REQUIRE(reader.push(bytes, on_chunk));
  reader.finish(on_chunk);
  REQUIRE(reader.problems().empty());
  return chunks;
}

inline std::size_t u16(std::span<const std::byte> bytes, std::size_t at) {
  return std::to_integer<std::size_t>(bytes[at]) | std::to_integer<std::size_t>(bytes[at + 1]) << 8;
}

/// Returns the header alone, so that chunks can be added singly.
inline std::span<const std::byte> header_of(std::span<const std::byte> bytes) { return bytes.first(u16(bytes, 12)); }

/// Returns a model after the round trip: all coordinates at the nearest lattice point, and repeated corners of a ring
/// merged.
inline std::vector<One> expected(const OutlineGroups& groups, const OutlineHeader& header) {
  const auto nearest = [](const auto& lattice, float value) {
    const double step = std::ldexp(1.0, lattice.exponent);
    return static_cast<float>(std::round(static_cast<double>(value) / step) * step);
  };
  std::vector<One> all;
  for (std::uint32_t g = 0; g < groups.groups.size(); ++g) {
    const OutlineGroup& group = groups.groups[g];
    for (const OutlinePolygons* polygons : {&group.outline, &group.inner}) {
      std::size_t ring = 0, corner = 0;
      for (const std::uint32_t polygon_end : polygons->polygon_ends) {
        One one;
        one.inner = polygons == &group.inner;
        one.appearance = group.appearance;
        one.group = g;
        one.count = one.inner ? 0 : static_cast<std::uint32_t>(group.inner.size());
        for (; ring < polygon_end; ++ring) {
          auto& points = one.rings.emplace_back();
          for (; corner < polygons->ring_ends[ring]; ++corner) {
            const glm::vec3 p = polygons->positions[corner];
            const Point point{nearest(header.positions, p.x), nearest(header.positions, p.y),
                              nearest(header.positions, p.z)};
            if (!points.empty() && points.back() == point) continue;
            points.push_back(point);
            if (polygons->texture_coordinates.empty()) continue;
            const glm::vec2 t = polygons->texture_coordinates[corner];
            one.texture_coordinates.push_back(
                {nearest(header.texture_coordinates, t.x), nearest(header.texture_coordinates, t.y)});
          }
          while (points.size() > 1 && points.back() == points.front()) {
            points.pop_back();
            if (!one.texture_coordinates.empty()) one.texture_coordinates.pop_back();
          }
        }
        all.push_back(canonical(std::move(one)));
      }
    }
  }
  return sorted(std::move(all));
}

}  // namespace gs::qnv::outlines
