#include "qnv/codecs/payloads.h"

#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/gaussians/encode/gaussians_stream.h"
#include "qnv/codecs/octree/encode/encode_surface.h"
#include "qnv/codecs/progressive/encode/progressive_stream.h"
#include "qnv/codecs/progressive/progressive.h"
#include "qnv/codecs/records/encode/encode_vectors.h"
#include "qnv/codecs/records/record.h"
#include "qnv/codecs/records/records_payload.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/codecs/values/labels/encode/label_stream.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>
#include <utility>

namespace gs::qnv {
namespace {

using Encoded = std::variant<EncodedStream, EncodeError>;

const TriangleSource* triangles_of(const EncodeSource& source) {
  const auto* triangles = std::get_if<std::reference_wrapper<const TriangleSource>>(&source);
  return triangles ? &triangles->get() : nullptr;
}

/// Returns the vectors of a source: discs, in the case of Gaussians.
std::optional<VectorView> vectors_of(const EncodeSource& source) {
  if (const auto* gaussians = std::get_if<std::reference_wrapper<const Gaussians>>(&source))
    return VectorView(gaussians->get());
  const auto* vectors = std::get_if<VectorView>(&source);
  return vectors ? std::optional(*vectors) : std::nullopt;
}

Suitability choose_records(const EncodeSource& source, const EncodeRequest&) {
  const bool points = vectors_of(source).has_value();
  return points ? Suitability{1, "records keep the positions of vectors"} : Suitability{};
}

Suitability choose_packed(const EncodeSource& source, const EncodeRequest& request) {
  if (!triangles_of(source)) return {};
  if (request.options.vectors > 0) return {1, "only an octree can have a given number of vectors"};
  return {1, "no base mesh follows the surface"};
}

Suitability choose_displaced(const EncodeSource& source, const EncodeRequest& request) {
  if (!triangles_of(source) || request.options.vectors > 0) return {};
  return {2, "a base mesh follows the surface"};
}

Suitability choose_outlines(const EncodeSource& source, const EncodeRequest&) {
  return std::holds_alternative<OutlineSource>(source) ? Suitability{1, "the source is polygons"} : Suitability{};
}

Suitability choose_values(const EncodeSource& source, const EncodeRequest&) {
  const bool values = std::holds_alternative<std::reference_wrapper<const VolumeSource>>(source);
  return values ? Suitability{1, "the source is the values of a volume"} : Suitability{};
}

Suitability choose_gaussians(const EncodeSource& source, const EncodeRequest&) {
  const bool splats = std::holds_alternative<std::reference_wrapper<const Gaussians>>(source) ||
                      std::holds_alternative<std::reference_wrapper<const GaussianSource>>(source);
  return splats ? Suitability{2, "the source is Gaussian splats"} : Suitability{};
}

Encoded encode_packed(const EncodeSource& source, EncodeOptions options, Progress* progress) {
  if (const auto vectors = vectors_of(source)) return encode_points(*vectors, options, progress);
  const TriangleSource* triangles = triangles_of(source);
  if (!triangles) return EncodeError{"a packed stream needs a surface; expected triangles or vectors"};
  return encode_surface(*triangles, options, progress);
}

Encoded encode_records(const EncodeSource& source, EncodeOptions options, Progress* progress) {
  if (const TriangleSource* triangles = triangles_of(source))
    return encode_surface_records(*triangles, options, progress);
  if (const auto vectors = vectors_of(source)) return encode_vectors(*vectors, options, progress);
  return EncodeError{"a records stream needs a surface or vectors; outline groups are not supported"};
}

Encoded encode_groups(const EncodeSource& source, EncodeOptions, Progress* progress) {
  const auto* polygons = std::get_if<OutlineSource>(&source);
  if (!polygons) return EncodeError{"an outlines stream needs outline groups"};
  return encode_outlines(polygons->groups, polygons->appearances, polygons->options, progress);
}

Encoded encode_base_and_displacements(const EncodeSource& source, EncodeOptions options, Progress* progress) {
  const TriangleSource* triangles = triangles_of(source);
  if (!triangles) return EncodeError{"a displaced stream needs a surface; expected triangles"};
  return encode_displaced(*triangles, options, progress);
}

Encoded encode_growing(const EncodeSource& source, EncodeOptions options, Progress* progress) {
  const TriangleSource* triangles = triangles_of(source);
  if (!triangles) return EncodeError{"a progressive stream needs a surface; expected triangles"};
  return encode_progressive(*triangles, options, progress);
}

Encoded encode_volume_values(const EncodeSource& source, EncodeOptions options, Progress* progress) {
  const auto* volume = std::get_if<std::reference_wrapper<const VolumeSource>>(&source);
  if (!volume) return EncodeError{"a values stream needs a volume; expected its values"};
  if (volume->get().layout.labels) return encode_labels(volume->get(), options, progress);
  return encode_values(volume->get(), options, progress);
}

Encoded encode_splats(const EncodeSource& source, EncodeOptions options, Progress* progress) {
  if (const auto* pieces = std::get_if<std::reference_wrapper<const GaussianSource>>(&source))
    return encode_gaussians(pieces->get(), options, progress);
  const auto* splats = std::get_if<std::reference_wrapper<const Gaussians>>(&source);
  if (!splats) return EncodeError{"a Gaussians stream needs Gaussian splats; expected a file of splats"};
  return encode_gaussians(splats->get(), options, progress);
}

std::unique_ptr<Decoder> make_volume_decoder(const StreamHeader& header, std::size_t most_vectors) {
  if (header.grid.labels)
    return header.steps.times.empty() ? make_labels_decoder(header, most_vectors)
                                      : make_label_series_decoder(header, most_vectors);
  if (!header.steps.times.empty()) return make_series_decoder(header, most_vectors);
  if (header.grid.components > 1) return make_components_decoder(header, most_vectors);
  return make_values_decoder(header, most_vectors);
}

/// Returns a list of chunk types, padded by repeating the last one.
constexpr ChunkTypes types(std::initializer_list<ChunkType> told) {
  ChunkTypes all{};
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = told.begin()[std::min(i, told.size() - 1)];
  return all;
}
constexpr ChunkTypes only(ChunkType type) { return types({type}); }

bool is_progressive(const StreamHeader& header) { return progressive::is_front(header.base); }

constexpr std::array<PayloadRow, 7> kRows = {{
    {Payload::records, "records", PayloadReader::vectors, RequestOrder::stream, nullptr, only(ChunkType::records),
     kRecordsHeaderBytes, kRecordBytes, 1200 / kRecordBytes, choose_records, encode_records, make_records_decoder},
    {Payload::packed, "packed", PayloadReader::levels, RequestOrder::visible_first, nullptr,
     types({ChunkType::packed, ChunkType::piece, ChunkType::shading, ChunkType::exact, ChunkType::low_bits,
            ChunkType::picture, ChunkType::normals}),
     0, 0, 0, choose_packed, encode_packed, make_octree_decoder},
    {Payload::outlines, "outlines", PayloadReader::polygons, RequestOrder::stream, nullptr,
     types({ChunkType::outlines, ChunkType::inner}), 0, 0, 0, choose_outlines, encode_groups, nullptr},
    {Payload::displaced, "progressive", PayloadReader::vectors, RequestOrder::stream, is_progressive,
     types({ChunkType::splits, ChunkType::piece, ChunkType::shading, ChunkType::exact, ChunkType::low_bits,
            ChunkType::cover, ChunkType::picture, ChunkType::normals}),
     0, 0, 0, nullptr, encode_growing, make_progressive_decoder},
    {Payload::displaced, "displaced", PayloadReader::vectors, RequestOrder::visible_first, nullptr,
     types({ChunkType::displaced, ChunkType::piece, ChunkType::shading, ChunkType::exact, ChunkType::low_bits,
            ChunkType::cover, ChunkType::picture, ChunkType::normals}),
     0, 0, 0, choose_displaced, encode_base_and_displacements, make_displaced_decoder},
    {Payload::values, "values", PayloadReader::vectors, RequestOrder::visible_first, nullptr,
     types({ChunkType::values, ChunkType::gaps, ChunkType::remainders, ChunkType::labels}), 0, 0, 0, choose_values,
     encode_volume_values, make_volume_decoder},
    {Payload::gaussians, "gaussians", PayloadReader::vectors, RequestOrder::visible_first, nullptr,
     types({ChunkType::gaussians, ChunkType::harmonics, ChunkType::coarse_harmonics}), 0, 0, 0, choose_gaussians,
     encode_splats, make_gaussians_decoder},
}};

// Checks the order of the table: ascending payload numbers, which may have gaps. Among rows with the same number,
// only the last row has no `sniff`.
static_assert([] {
  for (std::size_t i = 1; i < kRows.size(); ++i)
    if (!(kRows[i - 1].payload < kRows[i].payload) && !(kRows[i - 1].payload == kRows[i].payload && kRows[i - 1].sniff))
      return false;
  return true;
}());

const PayloadRow* row_with(std::uint8_t number) {
  for (const PayloadRow& row : kRows)
    if (static_cast<std::uint8_t>(row.payload) == number && !row.sniff) return &row;
  return nullptr;
}

}  // namespace

std::span<const PayloadRow> payload_rows() { return kRows; }

const PayloadRow& row_of(const StreamHeader& header) {
  for (const PayloadRow& row : kRows)
    if (row.payload == header.payload && row.sniff && row.sniff(header)) return row;
  return row_of(header.payload);
}

const PayloadRow& row_of(Payload payload) { return *row_with(static_cast<std::uint8_t>(payload)); }

const PayloadRow* payload_of(std::span<const std::byte> bytes) {
  const std::optional<std::uint8_t> number = payload_number(bytes);
  return number ? row_with(*number) : nullptr;
}

bool carries(const PayloadRow& row, ChunkType type) { return std::ranges::find(row.chunks, type) != row.chunks.end(); }

std::optional<ChunkParts> cut_chunk(const PayloadRow& row, std::span<const std::byte> chunk) {
  const std::optional<ChunkHead> head = chunk_head(chunk);
  if (!head || head->bytes != chunk.size() || !carries(row, head->type)) return {};
  if (row.record_bytes == 0) return ChunkParts{{}, chunk};
  const std::size_t front = kChunkHeaderBytes + row.head_bytes;
  if (chunk.size() <= front || (chunk.size() - front) % row.record_bytes != 0) return {};
  return ChunkParts{chunk.first(front), chunk.subspan(front)};
}

}  // namespace gs::qnv
