#include "qnv/container/cluster_directory.h"

#include "base/bytes.h"
#include "qnv/base/short_number.h"
#include "qnv/entropy/binary_coder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>

namespace gs::qnv {
namespace {

using displaced::BinaryDecoder;
using displaced::BinaryEncoder;
using displaced::BitModel;

// Limits of the format: bytes of a payload, bytes between two listed chunks, and Gaussians of a cluster.
constexpr std::uint32_t kMostPayload = 2047, kMostGap = (1u << 24) - 1, kMostVectors = 1u << 14;
constexpr std::uint32_t kMostInChunk = 1u << 14;  // entries
constexpr std::uint32_t kNoListedParent = 0xffffffff, kMostLevel = 254;
constexpr std::uint32_t kUsualRatio = 585, kMostRatio = 65535;  // Gaussians per byte, in 1/4096

/// Encoder with the functions of ListingGet, so that both directions share their code.
struct ListingPut {
  BinaryEncoder coder;

  bool bit(BitModel& model, bool value) {
    coder.put(model, value);
    return value;
  }
  std::uint32_t bits(std::uint32_t value, int count) {
    coder.put_bits(value, count);
    return value;
  }
};

/// Decoder. Ignores the values that it receives.
struct ListingGet {
  BinaryDecoder coder;

  bool bit(BitModel& model, bool) { return coder.get(model); }
  std::uint32_t bits(std::uint32_t, int count) { return coder.get_bits(count); }
};

/// Models of a number of `Bits` bits: a binary tree of decisions, highest bit first.
template <int Bits>
struct BitTree {
  std::array<BitModel, (std::size_t{1} << Bits) - 1> nodes;

  template <class Coder>
  std::uint32_t code(Coder& coder, std::uint32_t value) {
    std::uint32_t node = 1;
    for (int i = Bits; i-- > 0;) node = node << 1 | (coder.bit(nodes[node - 1], (value >> i & 1) != 0) ? 1u : 0u);
    return node - (1u << Bits);
  }
};

/// Models of a number below 2^24: its length in bits, then the two bits below the highest one, then the others.
struct LongNumber {
  BitTree<5> length;
  std::array<std::array<BitModel, 3>, 25> high;  // by length

  template <class Coder>
  std::uint32_t code(Coder& coder, std::uint32_t value) {
    constexpr std::uint32_t kMostLength = 24;
    const std::uint32_t bits =
        std::min(length.code(coder, static_cast<std::uint32_t>(std::bit_width(value))), kMostLength);
    if (bits == 0) return 0;
    int below = static_cast<int>(bits) - 1;
    std::uint32_t coded = 1;
    for (int i = 0; i < 2 && below > 0; ++i) {
      --below;
      coded = coded << 1 | (coder.bit(high[bits][coded - 1], (value >> below & 1) != 0) ? 1u : 0u);
    }
    return coded << below | coder.bits(value & ((1u << below) - 1), below);
  }
};

/// Models of a signed number with a magnitude below 2^24.
struct LongSigned {
  LongNumber magnitude;
  BitModel negative;

  template <class Coder>
  std::int32_t code(Coder& coder, std::int32_t value) {
    const auto size = static_cast<std::int32_t>(magnitude.code(coder, static_cast<std::uint32_t>(std::abs(value))));
    return size != 0 && coder.bit(negative, value < 0) ? -size : size;
  }
};

/// Listed cluster, for the entries that refer to it.
struct ListedCluster {
  BoxCodes box{};
  std::uint8_t level = 0;
};

/// Fields of a DirectoryEntry in the form that is coded.
struct ListedChunk {
  bool harmonics = false;
  std::uint32_t gap = 0;      // bytes between the previous entry and this one
  std::uint32_t payload = 0;  // bytes
  std::uint32_t parent = kNoListedParent;
  std::uint32_t vectors = 0;
  BoxCodes box{};  // of harmonics: that of their cluster
};

/// Models and state of a directory. They continue from chunk to chunk.
struct ListingModels {
  std::array<BitModel, 2> harmonics;  // by the kind of the previous entry
  BitModel gap;
  LongNumber gap_bytes;
  std::array<BitTree<6>, 2> payload;                // upper bits, by kind
  std::array<std::array<LongSigned, 4>, 2> parent;  // by kind and last_change
  LongSigned vectors;
  std::array<BitTree<7>, 2> side;  // lower and upper sides of boxes
  LongSigned far_side;

  bool after_harmonics = false;
  std::array<std::uint32_t, 2> last_parent{}, last_change{};  // by kind; bit length of the change / 5, at most 3
  std::uint32_t ratio = kUsualRatio;
  std::vector<ListedCluster> clusters;
  std::uint64_t end = 0;  // of the previous entry
};

constexpr BoxCodes kWholeBox{0, 0, 0, 65535, 65535, 65535};

/// Codes the box of a cluster relative to that of its parent.
template <class Coder>
BoxCodes code_box(Coder& coder, ListingModels& models, const BoxCodes& parent, const BoxCodes& box) {
  BoxCodes coded{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int32_t lower = parent[axis], upper = parent[axis + 3];
    const int shift = std::max(static_cast<int>(std::bit_width(static_cast<std::uint32_t>(upper - lower))) - 6, 0);
    std::array<std::int32_t, 2> ends{};
    for (std::size_t side = 0; side < 2; ++side) {
      constexpr std::int32_t kBelow = 32;
      constexpr std::uint32_t kFar = 127;
      const std::int32_t inside = (side == 0 ? box[axis] - lower : upper - box[axis + 3]) >> shift;
      const bool near = inside >= -kBelow && inside < static_cast<std::int32_t>(kFar) - kBelow;
      const std::uint32_t symbol =
          models.side[side].code(coder, near ? static_cast<std::uint32_t>(inside + kBelow) : kFar);
      const std::int32_t steps =
          symbol == kFar ? models.far_side.code(coder, inside) : static_cast<std::int32_t>(symbol) - kBelow;
      const auto moved = static_cast<std::int64_t>(steps) << shift;
      ends[side] =
          static_cast<std::int32_t>(std::clamp<std::int64_t>(side == 0 ? lower + moved : upper - moved, 0, 65535));
    }
    coded[axis] = static_cast<std::uint16_t>(ends[0]);
    coded[axis + 3] = static_cast<std::uint16_t>(std::max(ends[0], ends[1]));
  }
  return coded;
}

/// Codes one entry. With ListingPut, `chunk` is the input; with ListingGet, it is the result. Returns false if the
/// entry is invalid.
template <class Coder>
bool code_entry(Coder& coder, ListingModels& models, ListedChunk& chunk) {
  chunk.harmonics = coder.bit(models.harmonics[models.after_harmonics ? 1 : 0], chunk.harmonics);
  const std::size_t kind = chunk.harmonics ? 1 : 0;
  models.after_harmonics = chunk.harmonics;
  chunk.gap = coder.bit(models.gap, chunk.gap > 0) ? models.gap_bytes.code(coder, chunk.gap) : 0;
  chunk.payload = models.payload[kind].code(coder, chunk.payload >> 5) << 5 | coder.bits(chunk.payload & 31, 5);
  if (chunk.payload == 0) return false;
  const auto known = static_cast<std::uint32_t>(models.clusters.size());
  const bool root = !chunk.harmonics && known == 0;
  if (root) {
    chunk.parent = kNoListedParent;
  } else {
    std::uint32_t& last = models.last_parent[kind];
    std::uint32_t& change = models.last_change[kind];
    const std::int32_t moved = models.parent[kind][change].code(coder, static_cast<std::int32_t>(chunk.parent - last));
    chunk.parent = last + static_cast<std::uint32_t>(moved);
    if (chunk.parent >= known) return false;
    last = chunk.parent;
    change = std::min(static_cast<std::uint32_t>(std::bit_width(static_cast<std::uint32_t>(std::abs(moved)))) / 5, 3u);
  }
  if (chunk.harmonics) {
    chunk.vectors = 0;
    chunk.box = models.clusters[chunk.parent].box;
    return true;
  }
  const auto expected = static_cast<std::int32_t>(chunk.payload * models.ratio >> 12);
  const std::int32_t vectors =
      expected + models.vectors.code(coder, static_cast<std::int32_t>(chunk.vectors) - expected);
  if (vectors < 1 || vectors > static_cast<std::int32_t>(kMostVectors)) return false;
  chunk.vectors = static_cast<std::uint32_t>(vectors);
  models.ratio += std::min((chunk.vectors << 12) / chunk.payload, kMostRatio) / 16 - models.ratio / 16;
  ListedCluster cluster;
  if (!root) {
    const ListedCluster& parent = models.clusters[chunk.parent];
    if (parent.level >= kMostLevel) return false;
    cluster.level = static_cast<std::uint8_t>(parent.level + 1);
  }
  cluster.box = code_box(coder, models, root ? kWholeBox : models.clusters[chunk.parent].box, chunk.box);
  chunk.box = cluster.box;
  models.clusters.push_back(cluster);
  return true;
}

// Converts an entry for coding. Returns nullopt if the format does not support it.
std::optional<ListedChunk> listed_chunk(const DirectoryEntry& entry, const Box& whole, const ListingModels& models) {
  ListedChunk chunk;
  chunk.harmonics = entry.vectors == 0;
  chunk.parent = entry.parent;
  chunk.vectors = entry.vectors;
  const auto known = static_cast<std::uint32_t>(models.clusters.size());
  const bool root = !chunk.harmonics && known == 0;
  if (entry.bytes <= kChunkHeaderBytes || entry.bytes - kChunkHeaderBytes > kMostPayload) return std::nullopt;
  chunk.payload = entry.bytes - static_cast<std::uint32_t>(kChunkHeaderBytes);
  if (entry.offset < models.end || entry.offset - models.end > kMostGap) return std::nullopt;
  chunk.gap = static_cast<std::uint32_t>(entry.offset - models.end);
  if (entry.vectors > kMostVectors || (root ? entry.parent != kNoListedParent : entry.parent >= known))
    return std::nullopt;
  const std::uint32_t level = root ? 0 : models.clusters[entry.parent].level + (chunk.harmonics ? 0u : 1u);
  if (entry.level != level || level > kMostLevel) return std::nullopt;
  chunk.box = box_codes(entry.box, whole);
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (chunk.box[axis] > chunk.box[axis + 3]) return std::nullopt;
  return chunk;
}

}  // namespace

// The directory of all payloads (container.h).

BoxCodes box_codes(const Box& box, const Box& whole) {
  BoxCodes codes{};
  const glm::vec3 size = whole.size();
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const bool lower = i < 3;
    const auto axis = static_cast<int>(i % 3);
    const float at = ((lower ? box.lower : box.upper)[axis] - whole.lower[axis]) / std::max(size[axis], 1e-30f) * 65535;
    codes[i] = static_cast<std::uint16_t>(std::clamp(lower ? std::floor(at) : std::ceil(at), 0.0f, 65535.0f));
  }
  return codes;
}

Box box_of(const BoxCodes& codes, const Box& whole) {
  const glm::vec3 step = whole.size() / 65535.0f;
  Box box;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const auto axis = static_cast<int>(i % 3);
    (i < 3 ? box.lower : box.upper)[axis] = whole.lower[axis] + static_cast<float>(codes[i]) * step[axis];
  }
  return box;
}

std::vector<std::byte> encode_directory(std::span<const DirectoryEntry> entries, const Box& box) {
  constexpr std::size_t kInOne = kMaxChunkBytes / kDirectoryEntryBytes;
  std::vector<std::byte> out;
  for (std::size_t first = 0; first < entries.size(); first += kInOne) {
    std::vector<std::byte> payload;
    ByteWriter write(payload);
    for (const DirectoryEntry& e : entries.subspan(first, std::min(kInOne, entries.size() - first))) {
      write.integer(e.offset);
      write.integer(static_cast<std::uint16_t>(e.bytes - kChunkHeaderBytes));
      write.integer(e.level);
      write.integer(std::uint8_t{0});
      write.integer(e.parent);
      write.integer(e.vectors);
      for (const std::uint16_t code : box_codes(e.box, box)) write.integer(code);
    }
    const std::vector<std::byte> chunk = encode_chunk(ChunkType::directory, payload);
    out.insert(out.end(), chunk.begin(), chunk.end());
  }
  return out;
}

std::vector<DirectoryEntry> decode_directory(std::span<const std::byte> payload, const Box& box) {
  std::vector<DirectoryEntry> entries;
  ByteReader read(payload);
  while (read.left() >= kDirectoryEntryBytes) {
    DirectoryEntry e;
    e.offset = read.integer<std::uint64_t>();
    e.bytes = static_cast<std::uint32_t>(read.integer<std::uint16_t>() + kChunkHeaderBytes);
    e.level = read.integer<std::uint8_t>();
    (void)read.integer<std::uint8_t>();
    e.parent = read.integer<std::uint32_t>();
    e.vectors = read.integer<std::uint32_t>();
    BoxCodes codes{};
    for (std::uint16_t& code : codes) code = read.integer<std::uint16_t>();
    e.box = box_of(codes, box);
    entries.push_back(e);
  }
  return entries;
}

std::optional<std::vector<std::vector<std::byte>>> pack_clusters(std::span<const DirectoryEntry> entries,
                                                                 const Box& box) {
  constexpr std::size_t kFull = kMaxChunkBytes - 1024;
  std::vector<std::vector<std::byte>> payloads;
  ListingModels models;
  for (std::size_t i = 0; i < entries.size();) {
    ListingPut put;
    const std::size_t first = i;
    for (; i < entries.size() && i - first < kMostInChunk && put.coder.size() < kFull; ++i) {
      auto chunk = listed_chunk(entries[i], box, models);
      if (!chunk || !code_entry(put, models, *chunk)) return std::nullopt;
      models.end = entries[i].offset + entries[i].bytes;
    }
    std::vector<std::byte>& payload = payloads.emplace_back();
    put_number(payload, first);
    put_number(payload, i - first);
    const std::vector<std::byte> coded = put.coder.finish();
    payload.insert(payload.end(), coded.begin(), coded.end());
  }
  return payloads;
}

/// State of the decoder of clusters.
struct DirectoryReader::Clusters {
  ListingModels models;
  std::uint64_t entries = 0;
  bool invalid = false;
};

DirectoryReader::DirectoryReader(const StreamHeader& header)
    : box_(header.description.box), gaussians_(header.payload == Payload::gaussians) {}
DirectoryReader::~DirectoryReader() = default;
DirectoryReader::DirectoryReader(DirectoryReader&&) noexcept = default;
DirectoryReader& DirectoryReader::operator=(DirectoryReader&&) noexcept = default;

bool DirectoryReader::add(ChunkType type, std::span<const std::byte> payload, std::vector<DirectoryEntry>& entries) {
  if (entries.size() >= kMaxDirectoryEntries) return false;
  if (type == ChunkType::directory) {
    const std::vector<DirectoryEntry> more = decode_directory(payload, box_);
    entries.insert(entries.end(), more.begin(), more.end());
    return true;
  }
  return type == ChunkType::cluster_directory && gaussians_ && add_clusters(payload, entries);
}

bool DirectoryReader::add_clusters(std::span<const std::byte> payload, std::vector<DirectoryEntry>& entries) {
  if (!clusters_) clusters_ = std::make_unique<Clusters>();
  Clusters& state = *clusters_;
  const auto first = take_wide_number(payload), count = take_wide_number(payload);
  // Limits the clusters that the models keep, even if the caller passes an empty list for each chunk.
  const std::uint64_t known = std::max<std::uint64_t>(entries.size(), state.entries);
  const bool follows = !state.invalid && first && count && *first == state.entries && *count > 0 &&
                       *count <= kMostInChunk && *count <= kMaxDirectoryEntries - known;
  if (!follows) return false;
  // The models depend on all earlier entries, so no chunk after an invalid one can be decoded.
  state.invalid = true;
  const std::size_t before = entries.size();
  ListingGet get{BinaryDecoder(payload)};
  for (std::uint64_t i = 0; i < *count; ++i) {
    ListedChunk chunk;
    if (!code_entry(get, state.models, chunk) || get.coder.exhausted()) {
      entries.resize(before);
      return false;
    }
    DirectoryEntry& entry = entries.emplace_back();
    entry.offset = state.models.end + chunk.gap;
    entry.bytes = static_cast<std::uint32_t>(kChunkHeaderBytes) + chunk.payload;
    const std::vector<ListedCluster>& clusters = state.models.clusters;
    entry.level = chunk.harmonics ? clusters[chunk.parent].level : clusters.back().level;
    entry.parent = chunk.parent;
    entry.vectors = chunk.vectors;
    entry.box = box_of(chunk.box, box_);
    state.models.end = entry.offset + entry.bytes;
  }
  state.entries += *count;
  state.invalid = false;
  return true;
}

}  // namespace gs::qnv
