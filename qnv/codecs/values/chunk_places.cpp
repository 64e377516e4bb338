#include "qnv/codecs/values/chunk_places.h"

#include "qnv/base/short_number.h"
#include "qnv/codecs/values/cluster.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/values_vectors.h"
#include "qnv/sampling/volume/gradients.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace gs::qnv::values {

namespace {

constexpr std::int64_t kUsualPayload = 1100;  // clusters have about this size, so that the difference takes one byte
constexpr std::uint64_t kMostOffset = std::uint64_t{1} << 42;

std::uint64_t zigzag(std::int64_t number) {
  return (static_cast<std::uint64_t>(number) << 1) ^ static_cast<std::uint64_t>(number >> 63);
}
std::int64_t unzigzag(std::uint64_t number) {
  return static_cast<std::int64_t>(number >> 1) ^ -static_cast<std::int64_t>(number & 1);
}

// Box of voxels from `first`, with the reach of the wavelets.
Box box_with_reach(const VolumeLayout& layout, const Extent& first, const Extent& size, int level) {
  const double reach = std::ldexp(4.0, std::max(level - 1, 0));
  std::array<std::array<double, 2>, 3> ends{};
  for (std::size_t a = 0; a < 3; ++a)
    ends[a] = {std::max(0.0, first[a] - reach),
               std::min(layout.dimensions[a] - 1.0, static_cast<double>(first[a]) + size[a] + reach)};
  Box box;
  for (unsigned c = 0; c < 8; ++c)
    box.add(voxel_position(layout, ends[0][c & 1], ends[1][c >> 1 & 1], ends[2][c >> 2]));
  return box;
}

}  // namespace

std::vector<std::vector<std::byte>> pack_places(std::span<const ChunkPlace> places) {
  constexpr std::size_t kFull = kMaxChunkBytes - 64;
  std::vector<std::vector<std::byte>> payloads;
  std::uint64_t end = 0, before = 0;
  ChunkType type = ChunkType::values;
  for (const ChunkPlace& place : places) {
    if (payloads.empty() || place.type != type || payloads.back().size() > kFull) {
      type = place.type;
      std::vector<std::byte>& begun = payloads.emplace_back();
      begun.push_back(static_cast<std::byte>(type));
      put_number(begun, place.offset);
      end = place.offset;
      before = 0;
    }
    std::vector<std::byte>& out = payloads.back();
    const std::uint64_t skipped = place.offset - end;
    put_number(out, zigzag(static_cast<std::int64_t>(place.first - before)) << 1 | (skipped > 0 ? 1 : 0));
    if (skipped > 0) put_number(out, skipped);
    put_number(out, zigzag(static_cast<std::int64_t>(place.bytes - kChunkHeaderBytes) - kUsualPayload));
    if (type != ChunkType::values) put_number(out, place.count);
    before = place.first;
    end = place.offset + place.bytes;
  }
  return payloads;
}

bool PlacesReader::add(std::span<const std::byte> payload) {
  if (payload.empty()) return false;
  ChunkPlace place;
  place.type = static_cast<ChunkType>(payload.front());
  if (place.type != ChunkType::values && place.type != ChunkType::gaps && place.type != ChunkType::remainders)
    return false;
  payload = payload.subspan(1);
  const auto start = take_wide_number(payload);
  if (!start || *start < end_ || *start > kMostOffset) return false;
  std::uint64_t end = *start;
  std::int64_t before = 0;
  while (!payload.empty()) {
    const auto step = take_wide_number(payload);
    std::uint64_t skipped = 0;
    if (step && (*step & 1) != 0) {
      const auto more = take_wide_number(payload);
      if (!more || *more > kMostOffset) return false;
      skipped = *more;
    }
    const auto bytes = take_wide_number(payload);
    if (!step || !bytes || places_.size() >= kMaxDirectoryEntries) return false;
    const std::int64_t size = unzigzag(*bytes) + kUsualPayload;
    if (*bytes > 4 * kMaxChunkBytes || size < 0 || size > static_cast<std::int64_t>(kMaxChunkBytes)) return false;
    // Each number has at most 42 bits, so that the sums do not overflow.
    before += unzigzag(*step >> 1);
    if (before < 0 || before > static_cast<std::int64_t>(kMostOffset)) return false;
    place.first = static_cast<std::uint64_t>(before);
    place.offset = end + skipped;
    if (place.offset > kMostOffset) return false;
    place.bytes = static_cast<std::uint32_t>(kChunkHeaderBytes + static_cast<std::size_t>(size));
    end = place.offset + place.bytes;
    if (place.type == ChunkType::values) {
      place.count = counts_[place.first]++;
    } else {
      const auto count = take_wide_number(payload);
      if (!count || *count == 0 || *count > kMostRunCubes) return false;
      place.count = static_cast<std::uint32_t>(*count);
    }
    places_.push_back(place);
  }
  end_ = end;
  return true;
}

std::optional<std::vector<ChunkPlace>> places_of(std::span<const std::byte> chunks, const StreamHeader& header) {
  PlacesReader reader;
  while (!chunks.empty()) {
    const auto head = chunk_head(chunks);
    if (!head || head->type != ChunkType::places || head->bytes > chunks.size()) return std::nullopt;
    const auto payload = chunks.subspan(kChunkHeaderBytes, head->bytes - kChunkHeaderBytes);
    const std::vector<std::byte> expected = encode_chunk(ChunkType::places, payload);
    if (!std::ranges::equal(std::span(expected).first(kChunkHeaderBytes), chunks.first(kChunkHeaderBytes)) ||
        !reader.add(payload))
      return std::nullopt;
    chunks = chunks.subspan(head->bytes);
  }
  if (header.chunks != 0 && reader.places().size() != header.chunks) return std::nullopt;
  return reader.places();
}

PlaceEntries::PlaceEntries(const ValueGrid& grid, bool series)
    : blocks_(grid.dimensions, level_count(grid.dimensions)), series_(series) {
  layout_.dimensions = grid.dimensions;
  layout_.axes = grid.axes;
  layout_.origin = grid.origin;
}

DirectoryEntry PlaceEntries::operator()(const ChunkPlace& place) const {
  DirectoryEntry entry;
  entry.offset = place.offset;
  entry.bytes = place.bytes;
  entry.parent = 0xffffffff;
  const Extent cubes = cube_extent(layout_.dimensions);
  const std::uint64_t slice = std::uint64_t{cubes[0]} * cubes[1];
  std::uint64_t number = place.first;
  if (series_) {
    const std::uint64_t count = place.type == ChunkType::values ? blocks_.count() : slice * cubes[2];
    entry.parent = static_cast<std::uint32_t>(std::min<std::uint64_t>(number / count, 0xffffffff));
    number %= count;
  }
  if (place.type == ChunkType::values) {
    if (number >= blocks_.count()) return entry;
    const BlockPlace block = blocks_.place(number);
    entry.level = static_cast<std::uint8_t>(block.level);
    entry.box = box_with_reach(layout_, block.first, block.size, block.level);
    if (place.count == 0 && block.level == 1)
      entry.vectors = static_cast<std::uint32_t>(kShownFraction * static_cast<double>(sample_count(block.size)));
    return entry;
  }
  const std::uint64_t most = cubes[2] - 1, first = std::min(number / slice, most),
                      last = std::min((number + place.count - 1) / slice, most);
  entry.box = box_with_reach(
      layout_, {0, 0, static_cast<std::uint32_t>(first * kCubeEdge)},
      {layout_.dimensions[0], layout_.dimensions[1], static_cast<std::uint32_t>((last - first + 1) * kCubeEdge)}, 0);
  return entry;
}

}  // namespace gs::qnv::values
