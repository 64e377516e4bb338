#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/shared/decoder.h"
#include "qnv/container/container.h"
#include "qnv/container/lost_chunks.h"
#include "qnv/container/piece_group.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gs::qnv {

class DirectoryReader;
struct PayloadRow;
namespace values {
class PlacesReader;
}

/// Decoder of a stream into vectors or a surface; its payload selects the codec. The stream may be received in pieces
/// or with losses; parity restores lost chunks. At any time, the received part gives a complete picture. One thread at
/// a time. Safe for untrusted bytes; memory is bounded by `most_vectors` and LostChunks.
class StreamDecoder {
 public:
  explicit StreamDecoder(std::size_t most_vectors = std::size_t{1} << 26);
  ~StreamDecoder();
  StreamDecoder(StreamDecoder&&) noexcept;
  StreamDecoder& operator=(StreamDecoder&&) noexcept;

  /// Decodes the next bytes of the stream. Returns false if the stream is rejected.
  bool push(std::span<const std::byte> bytes);
  /// Adds a chunk that was received separately, for example as a datagram. Call it after the header is received; chunks
  /// may have any order. A chunk of records may be incomplete: another call may add the ranges `missing` of its
  /// payload, and the bytes after its end. Chunks of other types must be complete.
  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing = {});
  /// Chooses the component of voxels that geometry() shows. Call it before the next geometry().
  void show(const ShownComponent& component);
  /// Ends the stream. Decodes the remaining bytes, and reports missing bytes as problems.
  void finish();

  [[nodiscard]] const StreamHeader* header() const { return reader_.header(); }
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return reader_.problems(); }
  [[nodiscard]] std::size_t refused_chunks() const { return refused_chunks_ + count().refused; }
  /// Reports whether chunks were dropped because of `most_vectors`.
  [[nodiscard]] bool full() const { return count().full; }
  /// Returns the number of vectors of geometry(), or the most that it may have if their number depends on values.
  [[nodiscard]] std::size_t vectors() const { return decoder_ ? decoder_->vectors() : 0; }
  /// Returns a number that changes whenever geometry() would.
  [[nodiscard]] std::uint64_t revision() const { return count().taken; }
  /// Returns the progress of the stream's mesh. Without a mesh, all numbers are 0.
  [[nodiscard]] MeshProgress mesh() const { return decoder_ ? decoder_->mesh() : MeshProgress{}; }
  [[nodiscard]] const std::vector<DirectoryEntry>& directory() const { return directory_; }
  /// Returns the number of lost chunks that parity restored.
  [[nodiscard]] std::size_t restored_chunks() const { return lost_.restored(); }

  /// Returns all received vectors at the finest received detail, without vectors that finer ones replace.
  [[nodiscard]] Geometry geometry() const;
  /// Like geometry(), for renderers: a displaced surface is patches, and only those changed since the last call are
  /// re-evaluated.
  [[nodiscard]] Geometry geometry_to_draw();

 private:
  /// Creates the decoder of the payload when the header is received.
  void begin();
  /// Adds a chunk of any type.
  void accept(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing);
  void add_places(std::span<const std::byte> payload);
  /// Adds a chunk that the payload may have.
  void take(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing);
  [[nodiscard]] DecodeCount count() const { return decoder_ ? decoder_->count() : DecodeCount{}; }
  [[nodiscard]] GeometryBase base() const;

  StreamReader reader_;
  std::size_t most_vectors_, refused_chunks_ = 0;
  const PayloadRow* row_ = nullptr;
  std::unique_ptr<Decoder> decoder_;  // null until the header is received, and for payloads of polygons
  PieceGroups groups_;
  ShownComponent shown_;
  LostChunks lost_;  // empty unless the header announces parity
  std::vector<DirectoryEntry> directory_;
  std::unique_ptr<DirectoryReader> entries_;      // null until the first chunk of a directory
  std::unique_ptr<values::PlacesReader> places_;  // of a values stream
};

}  // namespace gs::qnv
