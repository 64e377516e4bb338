#include "qnv/container/container.h"

#include "base/bytes.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace gs::qnv {
namespace {

constexpr std::array<unsigned char, 8> kMagic{0x89, 'Q', 'N', 'V', 0x0d, 0x0a, 0x1a, 0x0a};
constexpr std::uint16_t kSync = 0x4351;  // "QC"
constexpr std::size_t kFixedHeaderBytes = 108;
constexpr std::size_t kChecksumAt = 16;
constexpr double kMaxOrigin = 1e18;  // maximum coordinate of an origin, and of positions in volumes
constexpr std::uint64_t kMaxWasted = std::uint64_t{16} << 20;
enum Tag : std::uint16_t {
  kPalette = 1,
  kTransfer = 2,
  kMetadata = 3,
  kOutlines = 4,
  kBase = 5,
  kOrigin = 7,
  kGrid = 8,
  kLabels = 9,
  kGaussians = 10,
  kComponent = 11,
  kSteps = 12
};
enum HeaderFlag : std::uint16_t { kTwoSided = 1, kColored = 2, kMeshed = 4, kParity = 8 };

std::uint32_t checksum(std::uint32_t from, std::span<const std::byte> bytes) {
  if (bytes.empty()) return from;  // for a null pointer, crc32_z would return the initial value
  return static_cast<std::uint32_t>(crc32_z(from, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

void put_section(std::vector<std::byte>& out, Tag tag, std::span<const std::byte> data) {
  ByteWriter write(out);
  write.integer(static_cast<std::uint16_t>(tag));
  write.integer(static_cast<std::uint32_t>(data.size()));
  out.insert(out.end(), data.begin(), data.end());
}

void put_color(ByteWriter& write, const Rgb8& c) {
  write.integer(c.r);
  write.integer(c.g);
  write.integer(c.b);
}

Rgb8 get_color(ByteReader& read) {
  return {read.integer<std::uint8_t>(), read.integer<std::uint8_t>(), read.integer<std::uint8_t>()};
}

/// Writes the bytes of a chunk header that its checksum covers.
void put_chunk_start(std::vector<std::byte>& out, ChunkType type, std::size_t bytes) {
  ByteWriter write(out);
  write.integer(kSync);
  write.integer(static_cast<std::uint16_t>(bytes));
  write.integer(static_cast<std::uint8_t>(type));
  write.integer(std::uint8_t{0});
}

bool has_origin(const Description& d) { return d.origin != glm::dvec3(0); }

bool all_finite(std::initializer_list<float> values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

/// Reads all sections. Returns false if a required section is missing or invalid: the outlines, base or grid section
/// of the payload, the labels of a label volume, the grid of a component, the steps of a time series, or the origin
/// section in version 2.
bool read_sections(ByteReader& read, StreamHeader& header, std::uint16_t version) {
  bool origin = version == kVersionWithoutOrigin;
  bool outlines = header.payload != Payload::outlines;
  bool base = header.payload != Payload::displaced, grid = header.payload != Payload::values;
  bool gaussians = header.payload != Payload::gaussians;
  LabelPalette labels;
  while (read.left() >= 6) {
    const auto tag = read.integer<std::uint16_t>();
    ByteReader section(read.bytes(read.integer<std::uint32_t>()));
    if (tag == kPalette) {
      while (section.left() >= 3 && header.palette.size() < 256) header.palette.push_back(get_color(section));
    } else if (tag == kTransfer) {
      while (section.left() >= 11) {
        TransferPoint point;
        point.value = section.f32();
        point.color = get_color(section);
        point.opacity = section.f32();
        if (!all_finite({point.value, point.opacity})) continue;
        point.value = std::clamp(point.value, 0.0f, 1.0f);
        point.opacity = std::clamp(point.opacity, 0.0f, 1.0f);
        header.description.transfer.push_back(point);
      }
      std::stable_sort(header.description.transfer.begin(), header.description.transfer.end(),
                       [](const TransferPoint& a, const TransferPoint& b) { return a.value < b.value; });
    } else if (tag == kMetadata) {
      const auto text = section.bytes(section.left());
      const std::string all(reinterpret_cast<const char*>(text.data()), text.size());
      const std::size_t end = all.find('\0');
      if (end != std::string::npos) header.description.metadata.emplace_back(all.substr(0, end), all.substr(end + 1));
    } else if (tag == kOutlines && !outlines) {
      auto decoded = decode_outline_header(section.bytes(section.left()));
      if (!decoded) return false;
      header.outlines = std::move(*decoded);
      outlines = true;
    } else if (tag == kBase && !base) {
      const auto bytes = section.bytes(section.left());
      header.base.assign(bytes.begin(), bytes.end());
      base = true;
    } else if (tag == kGrid && !grid) {
      auto decoded = decode_value_grid(section.bytes(section.left()));
      if (!decoded) return false;
      header.grid = std::move(*decoded);
      grid = true;
    } else if (tag == kGaussians && !gaussians) {
      const auto decoded = decode_gaussian_coding(section.bytes(section.left()));
      if (!decoded) return false;
      header.gaussians = *decoded;
      gaussians = true;
    } else if (tag == kComponent && grid && header.more_grids.size() + 1 < header.grid.components) {
      auto decoded = decode_value_grid(section.bytes(section.left()));
      if (!decoded || !fits(*decoded, header.grid)) return false;
      header.more_grids.push_back(std::move(*decoded));
    } else if (tag == kSteps && grid && header.steps.times.empty()) {
      auto decoded = decode_step_table(section.bytes(section.left()), header.grid.components);
      if (!decoded) return false;
      header.steps = std::move(*decoded);
    } else if (tag == kLabels && labels.empty()) {
      auto decoded = decode_label_palette(section.bytes(section.left()));
      if (!decoded) return false;
      labels = std::move(*decoded);
    } else if (tag == kOrigin && !origin) {
      if (section.left() < 3 * sizeof(double)) return false;
      for (int i = 0; i < 3; ++i) header.description.origin[i] = section.f64();
      origin = true;
      for (int i = 0; i < 3; ++i)
        if (!(std::abs(header.description.origin[i]) <= kMaxOrigin)) return false;
    }
    // Skips sections that later versions define.
  }
  if (header.grid.components != header.more_grids.size() + 1) return false;
  if (header.grid.labels) {
    if (labels.empty()) return false;
    header.grid.palette = std::move(labels);
  }
  return outlines && base && grid && gaussians && origin;
}

}  // namespace

std::vector<std::byte> encode_header(const StreamHeader& header) {
  std::vector<std::byte> out;
  ByteWriter write(out);
  const Description& d = header.description;
  for (const unsigned char c : kMagic) write.integer(c);
  write.integer(has_origin(d) ? kVersion : kVersionWithoutOrigin);
  write.integer(static_cast<std::uint8_t>(header.kind));
  write.integer(static_cast<std::uint8_t>(header.payload));
  write.integer(std::uint32_t{0});  // placeholder for the length
  write.integer(std::uint32_t{0});  // placeholder for the checksum
  write.integer(static_cast<std::uint16_t>((d.two_sided ? kTwoSided : 0) | (header.colored ? kColored : 0) |
                                           (header.meshed ? kMeshed : 0) | (header.parity ? kParity : 0)));
  put_color(write, header.color);
  write.integer(std::uint8_t{0});
  for (const glm::vec3& p : {d.box.lower, d.box.upper})
    for (int i = 0; i < 3; ++i) write.f32(p[i]);
  write.integer(std::uint16_t{0});
  write.f64(d.total);
  write.f32(d.spacing);
  write.f32(d.value_range.first);
  write.f32(d.value_range.second);
  write.integer(header.vectors);
  write.integer(header.chunks);
  write.integer(header.directory);
  for (int i = 0; i < 3; ++i) write.f32(header.cube.lower[i]);
  write.f32(header.cube.edge);
  std::vector<std::byte> data;
  ByteWriter section(data);
  for (const Rgb8& c : header.palette) put_color(section, c);
  if (!data.empty()) put_section(out, kPalette, data);
  data.clear();
  for (const TransferPoint& point : d.transfer) {
    section.f32(point.value);
    put_color(section, point.color);
    section.f32(point.opacity);
  }
  if (!data.empty()) put_section(out, kTransfer, data);
  data.clear();
  if (has_origin(d)) {
    for (int i = 0; i < 3; ++i) section.f64(d.origin[i]);
    put_section(out, kOrigin, data);
  }
  if (header.payload == Payload::outlines) put_section(out, kOutlines, encode_outline_header(header.outlines));
  if (header.payload == Payload::displaced) put_section(out, kBase, header.base);
  if (header.payload == Payload::gaussians) put_section(out, kGaussians, encode_gaussian_coding(header.gaussians));
  if (header.payload == Payload::values) put_section(out, kGrid, encode_value_grid(header.grid));
  for (const ValueGrid& one : header.more_grids) put_section(out, kComponent, encode_value_grid(one));
  if (!header.steps.times.empty()) put_section(out, kSteps, encode_step_table(header.steps));
  if (header.grid.labels) put_section(out, kLabels, encode_label_palette(header.grid.palette));
  for (const auto& [key, value] : d.metadata) {
    data.clear();
    for (const char c : key + '\0' + value) data.push_back(static_cast<std::byte>(c));
    if (out.size() + data.size() + 6 <= kMaxHeaderBytes) put_section(out, kMetadata, data);
  }
  for (std::size_t i = 0; i < 4; ++i) out[12 + i] = static_cast<std::byte>(out.size() >> (8 * i) & 255);
  const std::uint32_t sum = checksum(0, out);
  for (std::size_t i = 0; i < 4; ++i) out[kChecksumAt + i] = static_cast<std::byte>(sum >> (8 * i) & 255);
  return out;
}

bool is_stream(std::span<const std::byte> bytes) {
  return bytes.size() >= kMagic.size() && std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) == 0;
}

std::variant<StreamHeader, StreamProblem> decode_header(std::span<const std::byte> bytes, std::size_t& header_bytes,
                                                        bool& need_more) {
  need_more = false;
  const std::size_t there = std::min(bytes.size(), kMagic.size());
  if (there > 0 && std::memcmp(bytes.data(), kMagic.data(), there) != 0)
    return StreamProblem{0, "not a QNV stream; expected the bytes 89 51 4E 56 0D 0A 1A 0A at the start"};
  if (bytes.size() < kFixedHeaderBytes) {
    need_more = true;
    return StreamProblem{0, "the header is incomplete"};
  }
  ByteReader read(bytes);
  (void)read.bytes(kMagic.size());
  const auto version = read.integer<std::uint16_t>();
  if (version != kVersion && version != kVersionWithoutOrigin)
    return StreamProblem{8, "is QNV version " + std::to_string(version) + "; expected " +
                                std::to_string(kVersionWithoutOrigin) + " or " + std::to_string(kVersion)};
  const auto kind = read.integer<std::uint8_t>(), payload = read.integer<std::uint8_t>();
  header_bytes = read.integer<std::uint32_t>();
  if (header_bytes < kFixedHeaderBytes || header_bytes > kMaxHeaderBytes)
    return StreamProblem{12, "the header states " + std::to_string(header_bytes) + " bytes; expected " +
                                 std::to_string(kFixedHeaderBytes) + " to " + std::to_string(kMaxHeaderBytes)};
  if (bytes.size() < header_bytes) {
    need_more = true;
    return StreamProblem{0, "the header is incomplete"};
  }
  const auto sum = read.integer<std::uint32_t>();
  std::vector<std::byte> copy(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(header_bytes));
  std::fill_n(copy.begin() + kChecksumAt, 4, std::byte{0});
  if (checksum(0, copy) != sum) return StreamProblem{kChecksumAt, "the header is damaged; its checksum is wrong"};
  if (kind > 1) return StreamProblem{10, "holds vectors of kind " + std::to_string(kind) + "; expected 0 or 1"};
  constexpr std::array<const char*, 7> kNames{"records", "packed", "outlines", "displaced", "", "values", "gaussians"};
  constexpr std::array<bool, 7> kOfSurface{true, true, true, true, false, false, true};
  constexpr std::array<bool, 7> kOfVolume{true, false, false, false, false, true, false};
  if (payload >= kNames.size() || *kNames[payload] == '\0')
    return StreamProblem{11, "holds payload " + std::to_string(payload) + "; expected 0 to 3, 5 or 6"};
  if (kind == 0 && !kOfSurface[payload])
    return StreamProblem{11, std::string("holds ") + kNames[payload] + " of a surface; expected a volume"};
  if (kind == 1 && !kOfVolume[payload])
    return StreamProblem{11, std::string("holds a volume with the payload ") + kNames[payload] +
                                 "; expected records, voxels or values, or a surface"};
  if (version != kVersionWithoutOrigin && payload == 2)
    return StreamProblem{8, "is of version 2 and has outlines, which have their own lattices; expected version 1"};
  StreamHeader header;
  Description& d = header.description;
  header.kind = static_cast<Kind>(kind);
  header.payload = static_cast<Payload>(payload);
  const auto flags = read.integer<std::uint16_t>();
  d.two_sided = (flags & kTwoSided) != 0;
  header.colored = (flags & kColored) != 0;
  header.meshed = (flags & kMeshed) != 0;
  header.parity = (flags & kParity) != 0;
  header.color = get_color(read);
  (void)read.integer<std::uint8_t>();
  for (glm::vec3* p : {&d.box.lower, &d.box.upper})
    for (int i = 0; i < 3; ++i) (*p)[i] = read.f32();
  (void)read.integer<std::uint16_t>();
  d.total = read.f64();
  d.spacing = read.f32();
  d.value_range.first = read.f32();
  d.value_range.second = read.f32();
  header.vectors = read.integer<std::uint64_t>();
  header.chunks = read.integer<std::uint32_t>();
  header.directory = read.integer<std::uint64_t>();
  for (int i = 0; i < 3; ++i) header.cube.lower[i] = read.f32();
  header.cube.edge = read.f32();
  const Box& b = d.box;
  const glm::vec3 size = b.size(), c = header.cube.lower, end = c + header.cube.edge;
  if (!all_finite({b.lower.x, b.lower.y, b.lower.z, b.upper.x, b.upper.y, b.upper.z, size.x, size.y, size.z, c.x, c.y,
                   c.z, end.x, end.y, end.z, header.cube.edge, d.spacing, d.value_range.first, d.value_range.second}) ||
      !std::isfinite(d.total) || b.empty() || !(header.cube.edge > 0))
    return StreamProblem{26, "the header has an invalid box or number"};
  ByteReader sections(bytes.subspan(kFixedHeaderBytes, header_bytes - kFixedHeaderBytes));
  if (!read_sections(sections, header, version))
    return StreamProblem{kFixedHeaderBytes,
                         std::string("the header's section of ") +
                             (header.payload == Payload::values      ? "the grid, or of its labels or components,"
                              : header.payload == Payload::gaussians ? "Gaussians"
                              : header.payload == Payload::displaced ? "the base"
                              : header.payload == Payload::outlines  ? "outlines"
                                                                     : "the origin") +
                             (version == kVersionWithoutOrigin ? "" : ", or of the origin,") +
                             " is missing or invalid"};
  return header;
}

std::optional<ChunkHead> chunk_head(std::span<const std::byte> bytes) {
  if (bytes.size() < kChunkHeaderBytes) return {};
  ByteReader read(bytes);
  const auto sync = read.integer<std::uint16_t>();
  const std::size_t length = read.integer<std::uint16_t>();
  const auto type = read.integer<std::uint8_t>(), zero = read.integer<std::uint8_t>();
  if (sync != kSync || zero != 0) return {};
  return ChunkHead{static_cast<ChunkType>(type), kChunkHeaderBytes + length};
}

std::optional<std::uint8_t> payload_number(std::span<const std::byte> bytes) {
  constexpr std::size_t kPayloadAt = 11;
  if (bytes.size() <= kPayloadAt || !is_stream(bytes)) return {};
  return std::to_integer<std::uint8_t>(bytes[kPayloadAt]);
}

std::uint32_t chunk_checksum(ChunkType type, std::span<const std::byte> payload) {
  std::vector<std::byte> start;
  put_chunk_start(start, type, payload.size());
  return checksum(checksum(0, start), payload);
}

std::vector<std::byte> encode_chunk(ChunkType type, std::span<const std::byte> payload) {
  std::vector<std::byte> out;
  out.reserve(kChunkHeaderBytes + payload.size());
  put_chunk_start(out, type, payload.size());
  ByteWriter(out).integer(checksum(checksum(0, out), payload));
  out.insert(out.end(), payload.begin(), payload.end());
  return out;
}

void StreamReader::problem(std::uint64_t offset, std::string message) {
  if (problems_.size() < kMaxProblems) problems_.push_back({offset, std::move(message)});
}

bool StreamReader::read_header() {
  std::size_t bytes = 0;
  bool need_more = false;
  auto read = decode_header(waiting_, bytes, need_more);
  if (need_more) return false;
  if (auto* error = std::get_if<StreamProblem>(&read)) {
    refused_ = true;
    problem(error->offset, std::move(error->message));
    return false;
  }
  header_ = std::move(std::get<StreamHeader>(read));
  at_ = bytes;
  return true;
}

std::optional<bool> StreamReader::ends_well(std::size_t bytes) const {
  const std::span<const std::byte> behind = std::span<const std::byte>(waiting_).subspan(at_ + bytes);
  if (behind.size() >= sizeof(kSync)) return ByteReader(behind).integer<std::uint16_t>() == kSync;
  if (ended_) return behind.empty();
  return std::nullopt;
}

// Reads one chunk, or makes one step of the search for the next chunk. Returns false if more bytes are needed.
bool StreamReader::read_chunk(const OnChunk& on_chunk, const OnDamaged& on_damaged) {
  const std::span<const std::byte> rest = std::span<const std::byte>(waiting_).subspan(at_);
  if (rest.size() < kChunkHeaderBytes) return false;
  ByteReader read(rest);
  const auto sync = read.integer<std::uint16_t>();
  const std::size_t length = read.integer<std::uint16_t>();
  const auto type = read.integer<std::uint8_t>();
  const auto zero = read.integer<std::uint8_t>();
  const auto sum = read.integer<std::uint32_t>();
  const bool plausible = sync == kSync && zero == 0;
  if (plausible && rest.size() < kChunkHeaderBytes + length) return false;
  if (plausible) {
    const auto payload = rest.subspan(kChunkHeaderBytes, length);
    const bool whole = checksum(checksum(0, rest.first(6)), payload) == sum;
    bool used = whole;
    if (whole && is_known(type)) on_chunk(static_cast<ChunkType>(type), payload, offset_ + at_);
    if (!whole && on_damaged && header_->payload == Payload::outlines && (type == 2 || type == 3)) {
      const std::optional<bool> behind = ends_well(kChunkHeaderBytes + length);
      if (!behind) return false;
      used = *behind && on_damaged(static_cast<ChunkType>(type), payload, offset_ + at_);
      if (used) problem(offset_ + at_, "a chunk is damaged; its intact parts are used");
    }
    if (used) {
      lost_ = false;
      at_ += kChunkHeaderBytes + length;
      return true;
    }
  }
  if (!lost_) problem(offset_ + at_, "a chunk is damaged and left out");
  lost_ = true;
  // Bounds the work for checksums of bytes that look like chunks everywhere, as in hostile streams.
  wasted_ += plausible ? length : 0;
  if (wasted_ > kMaxWasted + 16 * (offset_ + at_)) {
    problem(offset_ + at_, "too much of the stream is damaged; skipped the rest");
    refused_ = true;
    return false;
  }
  // Continues at the next possible start of a chunk.
  const auto from = waiting_.begin() + static_cast<std::ptrdiff_t>(at_) + 1;
  at_ = static_cast<std::size_t>(std::find(from, waiting_.end(), std::byte{kSync & 255}) - waiting_.begin());
  return true;
}

bool StreamReader::push(std::span<const std::byte> bytes, const OnChunk& on_chunk, const OnDamaged& on_damaged) {
  // Processes the bytes in pieces, to keep the buffer small.
  constexpr std::size_t kPiece = std::size_t{1} << 18;
  while (!bytes.empty() && !refused_) {
    const std::size_t size = std::min(bytes.size(), kPiece);
    waiting_.insert(waiting_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    bytes = bytes.subspan(size);
    if (!header_ && !read_header()) continue;
    while (read_chunk(on_chunk, on_damaged)) {
    }
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(at_));
    offset_ += at_;
    at_ = 0;
  }
  return !refused_;
}

void StreamReader::finish(const OnChunk& on_chunk, const OnDamaged& on_damaged) {
  if (refused_) return;
  if (!header_) {
    problem(0, "ends inside its header");
    return;
  }
  ended_ = true;
  bool told = lost_;
  // After a damaged length, the bytes that waited for the end of a chunk may contain whole chunks.
  while (at_ < waiting_.size() && !refused_) {
    if (read_chunk(on_chunk, on_damaged)) continue;
    if (!refused_ && !std::exchange(told, true)) problem(offset_ + at_, "ends inside a chunk");
    lost_ = true;
    ++at_;
  }
}

}  // namespace gs::qnv
