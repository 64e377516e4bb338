#pragma once

#include "qnv/base/geometry.h"
#include "qnv/container/container.h"

#include <cstddef>
#include <span>
#include <utility>

namespace gs::qnv {

/// Outcome of the chunks that a decoder received.
struct DecodeCount {
  std::size_t refused = 0, taken = 0;  // unusable chunks; changes of the geometry
  bool full = false;                   // something was dropped because of the maximum number of vectors

  DecodeCount& operator+=(const DecodeCount& other) {
    refused += other.refused;
    taken += other.taken;
    full = full || other.full;
    return *this;
  }
};

/// Received part of the mesh that a stream ends with or grows to.
struct MeshProgress {
  std::size_t bytes = 0, received = 0;                  // of an exact mesh; `bytes` is 0 if unknown
  std::size_t texture_bytes = 0, texture_received = 0;  // of its picture; `texture_bytes` is 0 if unknown
  std::size_t vertices = 0;                             // of a growing mesh, received
  std::size_t triangles = 0, all_triangles = 0;         // of an exact mesh; `all_triangles` is set if `partly`
  int bits = 0;                                         // log2 of the lattice positions per axis; 0 means unknown
  bool partly = false;                                  // received triangles replace a part of the surface
  bool whole = false;                                   // all triangles are shown; positions may be refined
  bool growing = false;                                 // a progressive mesh is shown
  bool final = false;                                   // complete and exact

  [[nodiscard]] bool shown() const { return partly || whole || growing; }
};

/// Decoder of one stream's chunks, in any order and with losses. At any time, the received part is a complete picture.
/// Each codec has its own, made by the codec's row (codecs/payloads.h). Not thread-safe; safe for untrusted bytes.
class Decoder {
 public:
  Decoder() = default;
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
  virtual ~Decoder() = default;

  /// Adds the payload of a chunk of one of the codec's types. The bytes `missing` in the payload and those after its
  /// end may be added later or never; only codecs with records accept that.
  virtual void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) = 0;
  [[nodiscard]] virtual DecodeCount count() const = 0;
  /// Returns the number of vectors of geometry().
  [[nodiscard]] virtual std::size_t vectors() const = 0;
  /// Returns everything received, at its finest detail, with the properties `base`.
  [[nodiscard]] virtual Geometry geometry(GeometryBase base) const = 0;
  /// Returns the geometry for renderers. Shares unchanged parts with earlier results.
  [[nodiscard]] virtual Geometry geometry_to_draw(GeometryBase base) { return geometry(std::move(base)); }
  [[nodiscard]] virtual MeshProgress mesh() const { return {}; }
};

}  // namespace gs::qnv
