#include "qnv/codecs/records/encode/encode_vectors.h"

#include "base/finite.h"
#include "qnv/base/palette.h"
#include "qnv/codecs/records/records_payload.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/shared/stream_writer.h"
#include "qnv/mesh/survey.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gs::qnv {
namespace {

// Number of vectors in the first layer, so that the first picture fits into the first datagram.
constexpr std::size_t kFirstLayer = 160;
// Bytes of a record, plus its share of the chunk headers.
constexpr double kBytesPerVector = 8.35;

StreamHeader header_of(const VectorView& vectors, const EncodeOptions& options) {
  StreamHeader header;
  header.kind = vectors.kind;
  header.payload = Payload::records;
  header.description = describe_vectors(vectors, options.metadata);
  header.color = vectors.color;
  header.cube = Cube::around(header.description.box);
  if (vectors.kind == Kind::surface && vectors.colors.size() == vectors.size())
    header.palette = make_palette(vectors.colors, options.threads);
  if (header.palette.size() == 1) {
    header.color = header.palette.front();
    header.palette.clear();
  }
  header.colored = !header.palette.empty();
  return header;
}

OutgoingChunk outgoing(RecordsChunk chunk) {
  OutgoingChunk out;
  out.type = ChunkType::records;
  out.entry.level = chunk.header.layer;
  out.entry.parent = std::numeric_limits<std::uint32_t>::max();
  out.entry.vectors = chunk.header.count;
  out.entry.box = chunk.header.frame.box();
  out.payload = std::move(chunk.payload);
  return out;
}

// Returns the chunks that fit into a stream of at most `max_bytes` bytes (0 means unlimited). Truncates the last chunk
// to the records that fit.
std::vector<OutgoingChunk> fitting(std::vector<RecordsChunk> encoded, const StreamHeader& header,
                                   std::size_t max_bytes) {
  std::vector<OutgoingChunk> chunks;
  std::size_t bytes = encode_header(header).size() + kChunkHeaderBytes;
  for (RecordsChunk& chunk : encoded) {
    const std::size_t around = kChunkHeaderBytes + kDirectoryEntryBytes + kChunkHeaderBytes * (chunks.size() / 2000);
    const std::size_t whole = chunk.payload.size();
    if (max_bytes != 0 && bytes + around + whole > max_bytes) {
      if (bytes + around + kRecordsHeaderBytes + kRecordBytes > max_bytes) break;
      const std::size_t room = (max_bytes - bytes - around - kRecordsHeaderBytes) / kRecordBytes;
      chunk.payload.resize(kRecordsHeaderBytes + room * kRecordBytes);
    }
    const std::size_t sent = chunk.payload.size();
    bytes += kChunkHeaderBytes + kDirectoryEntryBytes + sent;
    chunks.push_back(outgoing(std::move(chunk)));
    chunks.back().entry.vectors = static_cast<std::uint32_t>((sent - kRecordsHeaderBytes) / kRecordBytes);
    if (sent < whole) break;
  }
  return chunks;
}

}  // namespace

std::variant<EncodedStream, EncodeError> encode_vectors(const VectorView& vectors, const EncodeOptions& options,
                                                        Progress* progress) {
  if (vectors.normals.size() != vectors.size() || vectors.weights.size() != vectors.size() ||
      vectors.size() > std::numeric_limits<std::uint32_t>::max())
    return EncodeError{"the vectors cannot be encoded; expected fewer than 2^32, each with a normal and a weight"};
  StreamHeader header = header_of(vectors, options);
  if (!(header.description.total > 0)) return EncodeError{"no vectors to encode"};
  if (!std::isfinite(header.description.total) || !finite(header.description.box.size()))
    return EncodeError{"the vectors are too large or too far apart"};
  RecordsOptions records;
  records.seed = options.seed;
  records.first_layer = kFirstLayer;
  records.palette = header.palette;
  records.threads = options.threads;
  records.progress = progress;
  if (options.vectors != 0) records.vectors = options.vectors;
  if (options.max_bytes != 0) {
    constexpr std::size_t kAround = kRecordsHeaderBytes + 2 * kChunkHeaderBytes + kDirectoryEntryBytes;
    const std::size_t taken = encode_header(header).size() + kAround + kRecordBytes;
    if (options.max_bytes < taken)
      return EncodeError{"a stream of one vector has " + std::to_string(taken) + " bytes; expected at most " +
                         std::to_string(options.max_bytes)};
    // Requests about the number of vectors that fits, so that the last layer is complete.
    const auto room = static_cast<double>(options.max_bytes - taken) / kBytesPerVector;
    records.vectors = std::min(records.vectors, static_cast<std::size_t>(room) + 1);
  }
  if (progress) {
    progress->stage = "ordering";
    progress->done = progress->total = 0;
  }
  std::vector<RecordsChunk> encoded = encode_records(vectors, records);
  if (is_cancelled(progress)) return EncodeError{"cancelled"};
  std::vector<OutgoingChunk> chunks = fitting(std::move(encoded), header, options.max_bytes);
  for (const OutgoingChunk& chunk : chunks) header.vectors += chunk.entry.vectors;
  if (chunks.empty()) return EncodeError{"no vectors to encode"};
  return write_stream(std::move(header), std::move(chunks), options.max_bytes);
}

}  // namespace gs::qnv
