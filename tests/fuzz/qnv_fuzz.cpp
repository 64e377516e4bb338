// libFuzzer target, and with tests/fuzz/replay.cpp a plain program over a corpus: any bytes, whole and in
// pieces, must decode without harm and to the same sound cloud. Checksums that a mutation broke are mended first, so
// that the fuzzer reaches what is behind them.
#include "qnv/decoder.h"
#include "qnv/outline_stream.h"

#include <zlib.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

using namespace gs::qnv;

namespace {

constexpr std::size_t kMostVectors = 1 << 18;

std::uint32_t number_at(const std::vector<std::uint8_t>& bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value |= static_cast<std::uint32_t>(bytes[at + i]) << (8 * i);
  return value;
}

void put_checksum(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t sum) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(sum >> (8 * i));
}

std::uint32_t checksum(std::uint32_t from, const std::uint8_t* bytes, std::size_t size) {
  return static_cast<std::uint32_t>(crc32_z(from, bytes, size));
}

// Header and chunks as FORMAT.md has them.
void mend_checksums(std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t kLength = 12, kHeaderSum = 16;
  if (bytes.size() < 108) return;
  const std::size_t header = number_at(bytes, kLength, 4);
  if (header > bytes.size() || header < 108) return;
  put_checksum(bytes, kHeaderSum, 0);
  put_checksum(bytes, kHeaderSum, checksum(0, bytes.data(), header));
  for (std::size_t at = header; at + kChunkHeaderBytes <= bytes.size();) {
    const std::size_t payload = number_at(bytes, at + 2, 2);
    if (payload > bytes.size() - at - kChunkHeaderBytes) return;
    put_checksum(bytes, at + 6,
                 checksum(checksum(0, bytes.data() + at, 6), bytes.data() + at + kChunkHeaderBytes, payload));
    at += kChunkHeaderBytes + payload;
  }
}

void check_sound(const Cloud& cloud) {
  if (cloud.normals.size() != cloud.size() || cloud.weights.size() != cloud.size()) std::abort();
  if (!cloud.colors.empty() && cloud.colors.size() != cloud.size()) std::abort();
  if (!cloud.classes.empty() && cloud.classes.size() != cloud.size()) std::abort();
  if (!cloud.cells.empty() && cloud.cells.size() != cloud.size()) std::abort();
  for (const float weight : cloud.weights)
    if (!(weight > 0) || !std::isfinite(weight)) std::abort();
}

// One decoder gets everything at once, the other piece by piece.
template <class Decoder>
void read(std::span<const std::byte> bytes, Decoder& whole, Decoder& pieces) {
  (void)whole.push(bytes);
  whole.finish();
  // The size of the pieces comes from the input, so that the fuzzer can choose it.
  const std::size_t piece = bytes.empty() ? 1 : 1 + std::to_integer<std::size_t>(bytes.back()) * 7;
  for (std::size_t i = 0; i < bytes.size(); i += piece)
    (void)pieces.push(bytes.subspan(i, std::min(piece, bytes.size() - i)));
  pieces.finish();
}

void decode(std::span<const std::byte> bytes) {
  StreamDecoder whole(kMostVectors), pieces(kMostVectors);
  read(bytes, whole, pieces);
  const Cloud cloud = whole.cloud(), other = pieces.cloud();
  check_sound(cloud);
  if (cloud.size() != whole.vectors() || cloud.size() > kMostVectors) std::abort();
  if (cloud.positions != other.positions || cloud.weights != other.weights) std::abort();
  if (whole.problems().size() != pieces.problems().size()) std::abort();
}

// All polygons that have come, in the order of their kinds.
std::vector<glm::vec3> corners_of(OutlineDecoder& decoder, std::size_t& polygons) {
  std::vector<glm::vec3> corners;
  for (const OutlineBatch& batch : decoder.take()) {
    polygons += batch.polygons.size();
    if (batch.groups.size() != batch.polygons.size()) std::abort();
    for (std::size_t i = 0; i < batch.polygons.size(); ++i) {
      const OutlinePolygon polygon = batch.polygons[i];
      for (std::size_t ring = 0; ring < polygon.rings(); ++ring)
        if (polygon.ring(ring).size() < 3) std::abort();
      for (const std::uint32_t corner : bridged_ring(polygon))
        if (corner >= polygon.positions.size()) std::abort();
    }
    for (const glm::vec3& p : batch.polygons.positions) {
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) std::abort();
      corners.push_back(p);
    }
  }
  return corners;
}

void decode_outlines(std::span<const std::byte> bytes) {
  OutlineDecoder whole(kMostVectors), pieces(kMostVectors);
  read(bytes, whole, pieces);
  std::size_t polygons = 0, others = 0;
  if (corners_of(whole, polygons) != corners_of(pieces, others) || polygons != others) std::abort();
  if (polygons != whole.outline_polygons() + whole.inner_polygons()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  decode(std::as_bytes(std::span(data, size)));
  decode_outlines(std::as_bytes(std::span(data, size)));
  std::vector<std::uint8_t> mended(data, data + size);
  mend_checksums(mended);
  decode(std::as_bytes(std::span(mended)));
  decode_outlines(std::as_bytes(std::span(mended)));
  return 0;
}
