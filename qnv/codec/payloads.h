#pragma once

#include "qnv/base/cloud.h"
#include "qnv/encode/encode_surface.h"
#include "qnv/encode/encode_voxels.h"
#include "qnv/outline/outline_groups.h"
#include "qnv/outline/outline_stream.h"
#include "qnv/stream/container.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::qnv {

/// What makes something to look at of a payload.
enum class PayloadReader : std::uint8_t {
  vectors,   // StreamDecoder, all of them
  levels,    // LodStream, as finely as views want it
  polygons,  // OutlineDecoder
};

/// Polygons in groups, with their looks.
struct OutlineSource {
  const OutlineGroups& groups;
  std::span<const OutlineAppearance> appearances;
  const OutlineEncodeOptions& options;
};
/// What a stream is made of.
using EncodeSource = std::variant<std::reference_wrapper<const TriangleSource>, std::reference_wrapper<const Cloud>,
                                  OutlineSource, VolumeVectors>;

/// What is in a stream that has ended.
struct DecodedStream {
  std::optional<StreamHeader> header;  // nothing: it is none
  std::variant<Cloud, std::vector<OutlineBatch>> content;
  std::vector<StreamProblem> problems;
  std::size_t refused_chunks = 0;
};

/// Of the chunks of a payload, as many as any has.
using ChunkTypes = std::array<ChunkType, 9>;

/// One payload of QNV streams: what those need to know of it who write, read, carry or lose its chunks.
struct PayloadRow {
  Payload payload;
  std::string_view name;
  PayloadReader reader;
  ChunkTypes chunks;           // the types of its chunks; often one and the same
  std::size_t head_bytes;      // of a chunk's payload, of which nothing may be missing
  std::size_t record_bytes;    // behind them, each of use by itself; 0: a chunk is of use only as a whole
  std::size_t packet_records;  // that travel together and are lost together
  /// Makes a stream; an error where the payload is not made of such a source. `options.payload` does not count, nor do
  /// the others for polygons, which have their own. Blocking; any thread.
  std::variant<EncodedStream, EncodeError> (*encode)(const EncodeSource& source, EncodeOptions options,
                                                     Progress* progress);
  /// All that a whole stream, or the front of one, has: at most so many vectors or polygons. Safe for untrusted bytes.
  DecodedStream (*decode)(std::span<const std::byte> stream, std::size_t most);
};

/// All payloads, in the order of their numbers.
[[nodiscard]] std::span<const PayloadRow> payload_rows();
[[nodiscard]] const PayloadRow& row_of(Payload payload);
/// The payload of the stream that begins so; null: it is none, or too little of it is there. Safe for untrusted bytes.
[[nodiscard]] const PayloadRow* payload_of(std::span<const std::byte> bytes);
/// Whether chunks of this type are the payload's own.
[[nodiscard]] bool carries(const PayloadRow& row, ChunkType type);

/// A whole chunk as an unreliable line carries it: all of the head, and of the body what arrives.
struct ChunkParts {
  std::span<const std::byte> head, body;
};
/// Nothing where the bytes are no chunk that is just so long, or none of the payload. The checksum is not looked at.
/// Safe for untrusted bytes.
[[nodiscard]] std::optional<ChunkParts> cut_chunk(const PayloadRow& row, std::span<const std::byte> chunk);

}  // namespace gs::qnv
