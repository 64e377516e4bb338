#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/outlines/grouping/outline_groups.h"
#include "qnv/codecs/outlines/outline_stream.h"
#include "qnv/codecs/shared/decoder.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/shared/gaussian_source.h"
#include "qnv/container/container.h"
#include "qnv/sampling/volume/volume.h"

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

/// Class that decodes a payload for drawing.
enum class PayloadReader : std::uint8_t {
  vectors,   // StreamDecoder: decodes all vectors
  levels,    // LodStream: decodes the vectors that each view needs
  polygons,  // OutlineDecoder: decodes polygons
};

/// Order in which views request the chunks of a stream.
enum class RequestOrder : std::uint8_t {
  stream,         // order of the stream: the decoder needs it, or each chunk changes the whole geometry
  visible_first,  // chunks in any view first: each chunk changes only the part of the geometry in its box
};

/// Input of the outlines encoder: polygons in groups, with their appearances.
struct OutlineSource {
  const OutlineGroups& groups;
  std::span<const OutlineAppearance> appearances;
  const OutlineEncodeOptions& options;
};
/// Input of an encoder.
using EncodeSource = std::variant<std::reference_wrapper<const TriangleSource>, VectorView, OutlineSource,
                                  std::reference_wrapper<const VolumeSource>, std::reference_wrapper<const Gaussians>,
                                  std::reference_wrapper<const GaussianSource>>;

/// Result of a payload's test of a request without a chosen payload.
struct Suitability {
  int rank = 0;          // the payload with the highest rank is tried first; 0 means never
  std::string_view why;  // completes "chosen because"
};

/// Chunk types of a payload. The array has the maximum size over all payloads.
using ChunkTypes = std::array<ChunkType, 9>;

/// Table row of a QNV payload, for code that writes, reads, transports or drops its chunks.
struct PayloadRow {
  Payload payload;
  std::string_view name;
  PayloadReader reader;
  RequestOrder requests;  // of streams that are decoded completely; cuts of a LodStream choose the chunks themselves
  /// Reports whether a stream belongs to this row. If nullptr, the row gets all streams with its number that no other
  /// row accepts.
  bool (*sniff)(const StreamHeader& header);
  ChunkTypes chunks;           // padded by repeating the last type
  std::size_t head_bytes;      // size of the header of a chunk's payload, which must be received completely
  std::size_t record_bytes;    // size of a record after that header; each is usable alone; 0 means that only
                               // whole chunks are usable
  std::size_t packet_records;  // number of records in one packet, which are lost together
  /// Reports how well the payload suits a source. If nullptr, only the encoder of another payload may choose this one.
  Suitability (*choose)(const EncodeSource& source, const EncodeRequest& request);
  /// Encodes a stream. Returns an error if the payload does not support this kind of source.
  /// For outlines, uses the options in the source instead of `options`. Blocks. Any thread.
  std::variant<EncodedStream, EncodeError> (*encode)(const EncodeSource& source, EncodeOptions options,
                                                     Progress* progress);
  /// Makes a decoder for at most `most_vectors` vectors. Returns nullptr for payloads of polygons.
  std::unique_ptr<Decoder> (*decoder)(const StreamHeader& header, std::size_t most_vectors);
};

/// Returns all rows, ordered by payload number.
[[nodiscard]] std::span<const PayloadRow> payload_rows();
[[nodiscard]] const PayloadRow& row_of(const StreamHeader& header);
/// Returns the row of a payload. If several rows share its number, returns the row without `sniff`.
[[nodiscard]] const PayloadRow& row_of(Payload payload);
/// Returns the payload of a stream from its first bytes. Returns nullptr for other data, or if the bytes are too few.
/// Safe for untrusted bytes.
[[nodiscard]] const PayloadRow* payload_of(std::span<const std::byte> bytes);
/// Reports whether a payload uses chunks of this type.
[[nodiscard]] bool carries(const PayloadRow& row, ChunkType type);

/// Chunk in two parts, for unreliable connections: the head is always received, the body possibly in part.
struct ChunkParts {
  std::span<const std::byte> head, body;
};
/// Splits a chunk into head and body. Returns nullopt if the bytes are not exactly one chunk of the payload. Does not
/// verify the checksum. Safe for untrusted bytes.
[[nodiscard]] std::optional<ChunkParts> cut_chunk(const PayloadRow& row, std::span<const std::byte> chunk);

}  // namespace gs::qnv
