#pragma once

#include "qnv/codecs/octree/encode/encode_surface.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "tests/qnv/surface_shapes.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

// Streams for tests of levels of detail, and their cuts.
namespace gs::qnv {

inline EncodedStream stream_of(const Triangles& triangles, std::size_t vectors, bool two_sided = false) {
  EncodeOptions options;
  options.vectors = vectors;
  options.two_sided = two_sided;
  auto encoded = encode_surface([&](const TriangleSink& sink) { return sink(triangles); }, options);
  REQUIRE(std::holds_alternative<EncodedStream>(encoded));
  return std::move(std::get<EncodedStream>(encoded));
}

/// Encodes once per file of tests.
inline const EncodedStream& sphere_stream(std::size_t vectors) {
  static std::map<std::size_t, EncodedStream> made;
  const auto found = made.find(vectors);
  return found != made.end() ? found->second : made.emplace(vectors, stream_of(sphere(200), vectors)).first->second;
}

/// Returns a sphere with bumps a tenth of its radius high.
inline Triangles bumpy_sphere(int n) {
  Triangles triangles = sphere(n);
  for (Triangle& t : triangles)
    for (glm::vec3& p : t.positions) p *= 1 + 0.1f * std::sin(9 * p.x) * std::sin(8 * p.y + 1) * std::sin(7 * p.z + 2);
  return triangles;
}

inline std::unique_ptr<LodStream> taken(LodStream::Opened opened) {
  REQUIRE(std::holds_alternative<std::unique_ptr<LodStream>>(opened));
  return std::move(std::get<std::unique_ptr<LodStream>>(opened));
}

inline std::unique_ptr<LodStream> opened(std::vector<std::byte> bytes, std::size_t cache = LodStream::kCacheBytes) {
  return taken(LodStream::open(std::move(bytes), cache));
}

/// Opens a stream that is read in place, on demand.
inline std::unique_ptr<LodStream> opened_there(std::vector<std::byte> bytes,
                                               std::size_t cache = LodStream::kCacheBytes) {
  return taken(LodStream::open(memory_source(std::move(bytes)), cache));
}

inline std::vector<std::array<float, 3>> places(std::span<const glm::vec3> positions) {
  std::vector<std::array<float, 3>> out;
  for (const glm::vec3& p : positions) out.push_back({p.x, p.y, p.z});
  std::sort(out.begin(), out.end());
  return out;
}

inline std::vector<std::array<float, 3>> places(const std::vector<Piece>& pieces) {
  std::vector<glm::vec3> all;
  for (const Piece& piece : pieces)
    for (std::size_t i = piece.first; i < piece.first + piece.count; ++i) all.push_back(piece.splats->positions[i]);
  return places(all);
}

inline double area(const std::vector<Piece>& pieces) {
  double sum = 0;
  for (const Piece& piece : pieces)
    for (std::size_t i = piece.first; i < piece.first + piece.count; ++i) sum += piece.splats->weights[i];
  return sum;
}

inline std::size_t count(const std::vector<Piece>& pieces) {
  std::size_t n = 0;
  for (const Piece& piece : pieces) n += piece.count;
  return n;
}

/// Returns a view of everything at full detail.
inline LodView everything() {
  LodView view;
  view.error_pixels = 0;
  return view;
}

inline LodView from(const glm::vec3& eye, float pixels = 1000) {
  LodView view;
  view.eye = eye;
  view.pixels = pixels;
  return view;
}

inline const double kSphereArea = 4 * 3.14159265358979;

}  // namespace gs::qnv
