#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/shared/decoder.h"
#include "qnv/container/container.h"
#include "qnv/container/piece_group.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gs::qnv {

struct PayloadRow;

/// Decodes a stream, received in pieces or with losses, into vectors or a surface, with the decoder of its payload. At
/// any time, the received part is a complete picture. Not thread-safe; safe for untrusted bytes; memory is bounded by
/// `most_vectors`.
class StreamDecoder {
 public:
  explicit StreamDecoder(std::size_t most_vectors = std::size_t{1} << 26) : most_vectors_(most_vectors) {}

  /// Decodes the next bytes of the stream. Returns false once the stream is rejected.
  bool push(std::span<const std::byte> bytes);
  /// Adds a chunk received separately (as a datagram), after the header, in any order. Of a records chunk, the bytes
  /// `missing` in the payload and those after its end may be added later or never. Chunks of other types must be
  /// complete.
  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing = {});
  /// Ends the stream: decodes waiting bytes, and reports missing ones.
  void finish();

  [[nodiscard]] const StreamHeader* header() const { return reader_.header(); }
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return reader_.problems(); }
  [[nodiscard]] std::size_t refused_chunks() const { return refused_chunks_ + count().refused; }
  /// Reports whether chunks were dropped because of `most_vectors`.
  [[nodiscard]] bool full() const { return count().full; }
  /// Returns the number of vectors of geometry().
  [[nodiscard]] std::size_t vectors() const { return decoder_ ? decoder_->vectors() : 0; }
  /// Returns a number that changes whenever geometry() would.
  [[nodiscard]] std::uint64_t revision() const { return count().taken; }
  /// Returns the received part of the stream's mesh, if it has one.
  [[nodiscard]] MeshProgress mesh() const { return decoder_ ? decoder_->mesh() : MeshProgress{}; }
  [[nodiscard]] const std::vector<DirectoryEntry>& directory() const { return directory_; }

  /// Returns everything received, at its finest detail; refined vectors are left out.
  [[nodiscard]] Geometry geometry() const;
  /// Like geometry(), for renderers: a displaced surface is patches, and only those changed since the last call are
  /// re-evaluated.
  [[nodiscard]] Geometry geometry_to_draw();

 private:
  /// Makes the payload's decoder once the header is known.
  void begin();
  [[nodiscard]] DecodeCount count() const { return decoder_ ? decoder_->count() : DecodeCount{}; }
  [[nodiscard]] GeometryBase base() const;

  StreamReader reader_;
  std::size_t most_vectors_, refused_chunks_ = 0;
  const PayloadRow* row_ = nullptr;
  std::unique_ptr<Decoder> decoder_;  // null before the header, and for polygons
  PieceGroups groups_;
  std::vector<DirectoryEntry> directory_;
};

}  // namespace gs::qnv
