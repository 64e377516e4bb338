#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/outlines/grouping/outline_groups.h"
#include "qnv/codecs/outlines/outline_stream.h"
#include "qnv/codecs/shared/decoder.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/voxels/encode/encode_voxels.h"
#include "qnv/container/container.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Class that decodes a payload for display.
enum class PayloadReader : std::uint8_t {
  vectors,   // StreamDecoder: all vectors
  levels,    // LodStream: as many as each view needs
  polygons,  // OutlineDecoder
};

/// Polygons in groups, with their appearances.
struct OutlineSource {
  const OutlineGroups& groups;
  std::span<const OutlineAppearance> appearances;
  const OutlineEncodeOptions& options;
};
/// Input of an encoder.
using EncodeSource =
    std::variant<std::reference_wrapper<const TriangleSource>, VectorView, OutlineSource, VolumeVectors>;

/// Suitability of a payload for a request that leaves the choice to the codecs.
struct Suitability {
  int rank = 0;          // the highest is tried first; 0 means never
  std::string_view why;  // completes "chosen because"
};

/// Chunk types of a payload; the size is the maximum over all payloads.
using ChunkTypes = std::array<ChunkType, 9>;

/// Table row of a QNV payload: its properties for code that writes, reads, transports or drops its chunks.
struct PayloadRow {
  Payload payload;
  std::string_view name;
  PayloadReader reader;
  /// Reports whether a stream belongs to this row. nullptr: this row gets all streams with its number that no other row
  /// claims.
  bool (*sniff)(const StreamHeader& header);
  ChunkTypes chunks;           // padded with repetitions
  std::size_t head_bytes;      // header of a chunk's payload; must be received completely
  std::size_t record_bytes;    // size of the records after the header, each usable alone; 0 if only whole chunks are
                               // usable
  std::size_t packet_records;  // number of records per packet, lost together
  /// Reports how well the payload suits a source; nullptr: only another payload's encoder chooses it.
  Suitability (*choose)(const EncodeSource& source, const EncodeRequest& request);
  /// Encodes a stream. Returns an error if the payload does not support this kind of source. Ignores `options.payload`;
  /// outlines use the options in their source instead. Blocks; safe from any thread.
  std::variant<EncodedStream, EncodeError> (*encode)(const EncodeSource& source, EncodeOptions options,
                                                     Progress* progress);
  /// Makes a decoder for up to `most_vectors` vectors; nullptr for polygons.
  std::unique_ptr<Decoder> (*decoder)(const StreamHeader& header, std::size_t most_vectors);
};

/// Returns all payloads, ordered by number.
[[nodiscard]] std::span<const PayloadRow> payload_rows();
[[nodiscard]] const PayloadRow& row_of(const StreamHeader& header);
/// Returns the row of a payload; of the rows that share its number, the one without `sniff`.
[[nodiscard]] const PayloadRow& row_of(Payload payload);
/// Returns the payload of a stream from its first bytes, or nullptr for other data or too few bytes. Safe for untrusted
/// bytes.
[[nodiscard]] const PayloadRow* payload_of(std::span<const std::byte> bytes);
/// Reports whether a payload uses chunks of this type.
[[nodiscard]] bool carries(const PayloadRow& row, ChunkType type);

/// Whole chunk as sent over an unreliable connection: the head is always received, the body in part.
struct ChunkParts {
  std::span<const std::byte> head, body;
};
/// Splits a chunk. Returns nullopt if the bytes are not exactly one chunk of the payload. Does not verify the checksum.
/// Safe for untrusted bytes.
[[nodiscard]] std::optional<ChunkParts> cut_chunk(const PayloadRow& row, std::span<const std::byte> chunk);

}  // namespace gs::qnv
