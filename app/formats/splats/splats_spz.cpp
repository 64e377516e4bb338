#include "app/formats/common/byte_order.h"
#include "app/formats/splats/splats.h"
#include "app/formats/splats/spz.h"
#include "base/gzip.h"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>
#include <optional>
#include <string_view>

namespace gs::app {
namespace {

using namespace spz;
using Bytes = std::span<const std::byte>;

constexpr std::array<std::size_t, 5> kHarmonicBytes = {0, 9, 24, 45, 72};  // bytes per splat, by degree
constexpr std::size_t kMaxSplatBytes = 20 + kHarmonicBytes.back();
constexpr std::size_t kMaxExtensionBytes = std::size_t{64} << 10;  // limit of the extension records

struct Header {
  std::uint32_t version = 0, count = 0;
  std::uint8_t harmonics_degree = 0, fraction_bits = 0, flags = 0;
};

/// Reads the 16 bytes that all versions share. Returns a message if they are invalid. `file_bytes` is the size of the
/// compressed file.
std::optional<std::string> read_header(const std::byte* from, std::size_t file_bytes, Header& header) {
  if (load_little<std::uint32_t>(from) != kSpzMagic) return "not an SPZ file: expected NGSP at the start";
  header.version = load_little<std::uint32_t>(from + 4);
  header.count = load_little<std::uint32_t>(from + 8);
  header.harmonics_degree = std::to_integer<std::uint8_t>(from[12]);
  header.fraction_bits = std::to_integer<std::uint8_t>(from[13]);
  header.flags = std::to_integer<std::uint8_t>(from[14]);
  if (header.version < 1 || header.version > 4)
    return "SPZ version " + std::to_string(header.version) + "; expected 1 to 4";
  if (header.count == 0) return "an SPZ file without splats";
  // This is the rule of the reference implementation. No real file compresses better.
  if (header.count > std::uint64_t{file_bytes} * 1024 / 9)
    return std::to_string(header.count) + " splats, which exceed the file";
  if (header.fraction_bits > 30) return std::to_string(header.fraction_bits) + " fraction bits; expected up to 30";
  return std::nullopt;
}

/// Returns the factors from a file's axes to those of VRML97. `system` is the number of the coordinate system
/// extension, 1 to 8. It encodes left or right, down or up, forward or back.
std::optional<glm::vec3> axes_of(std::uint32_t system) {
  if (system < 1 || system > 8) return std::nullopt;
  const std::uint32_t bits = system - 1;
  return glm::vec3((bits & 1) ? 1 : -1, (bits & 2) ? 1 : -1, (bits & 4) ? -1 : 1);
}

/// Reads the extension records. Each has type, length and payload.
void read_extensions(Bytes bytes, SplatModel& model) {
  while (bytes.size() >= 8) {
    const auto type = load_little<std::uint32_t>(bytes.data());
    const std::size_t length = load_little<std::uint32_t>(bytes.data() + 4);
    if (length > bytes.size() - 8) return;
    if (type == kCoordinateSystem && length >= 4)
      if (const auto axes = axes_of(load_little<std::uint32_t>(bytes.data() + 8))) model.axes = *axes;
    bytes = bytes.subspan(8 + length);
  }
}

double unpack_position(const std::byte* from, const Header& header) {
  if (header.version == 1) return static_cast<double>(float_of_half(load_little<std::uint16_t>(from)));
  const std::uint32_t low = std::to_integer<std::uint32_t>(from[0]) | std::to_integer<std::uint32_t>(from[1]) << 8 |
                            std::to_integer<std::uint32_t>(from[2]) << 16;
  const auto fixed = static_cast<std::int32_t>(low << 8) >> 8;  // sign-extends bit 23
  return std::ldexp(static_cast<double>(fixed), -static_cast<int>(header.fraction_bits));
}

glm::vec4 unpack_rotation(const std::byte* from, std::uint32_t version) {
  glm::vec4 q(0);
  float rest = 1;
  if (version < 3) {
    for (int k = 0; k < 3; ++k) {
      q[k] = static_cast<float>(std::to_integer<int>(from[k])) / 127.5f - 1;
      rest -= q[k] * q[k];
    }
    q.w = std::sqrt(std::max(rest, 0.0f));
    return q;
  }
  auto packed = load_little<std::uint32_t>(from);
  const int largest = static_cast<int>(packed >> 30);
  for (int k = 3; k >= 0; --k) {
    if (k == largest) continue;
    const float size = static_cast<float>(packed & 511) / kQuaternionSteps * (std::numbers::sqrt2_v<float> / 2);
    q[k] = (packed & 512) ? -size : size;
    rest -= size * size;
    packed >>= 10;
  }
  q[largest] = std::sqrt(std::max(rest, 0.0f));
  return q;
}

/// Converts the planes to splats. Each plane must have its full length.
void unpack(const Header& header, const std::array<Bytes, plane_count>& planes, Bytes harmonics, SplatModel& model) {
  const auto value = [](std::byte b) { return static_cast<float>(std::to_integer<int>(b)); };
  const std::size_t coordinate = plane_widths(header.version)[positions] / 3;
  const std::size_t rotation = plane_widths(header.version)[rotations];
  model.resize(header.count);
  for (std::size_t i = 0; i < header.count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      model.positions[i][axis] = unpack_position(planes[positions].data() + (3 * i + k) * coordinate, header);
      model.scales[i][axis] = std::exp(value(planes[scales][3 * i + k]) / kLogScaleSteps + kMinLogScale);
      model.dc[i][axis] = (value(planes[colors][3 * i + k]) / 255 - 0.5f) / kColorScale;
    }
    model.opacities[i] = value(planes[alphas][i]) / 255;
    model.rotations[i] = unpack_rotation(planes[rotations].data() + i * rotation, header.version);
    for (std::size_t k = 0; k < 3 * qnv::harmonic_count(model.degree) && !harmonics.empty(); ++k)
      model.coefficient(i, k / 3)[static_cast<int>(k % 3)] =
          (value(harmonics[i * kHarmonicBytes[static_cast<std::size_t>(model.harmonics)] + k]) - 128) / 128;
  }
}

/// Decompresses a zstd frame in pieces, so that memory grows with the data and not with the size in the header.
std::optional<std::string> unzstd(Bytes packed, std::size_t expected, std::vector<std::byte>& to) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  if (!context) return "zstd cannot be initialised";
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  std::vector<std::byte> piece(ZSTD_DStreamOutSize());
  while (to.size() < expected) {
    ZSTD_outBuffer out{piece.data(), piece.size(), 0};
    const std::size_t before = in.pos;
    const std::size_t left = ZSTD_decompressStream(context.get(), &out, &in);
    if (ZSTD_isError(left)) return std::string("the zstd data is damaged (") + ZSTD_getErrorName(left) + ")";
    if (out.pos == 0 && in.pos == before) return "the zstd data is truncated";
    to.insert(to.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(out.pos));
  }
  if (to.size() != expected) return "a plane decompresses to more than its " + std::to_string(expected) + " bytes";
  return std::nullopt;
}

/// Converts the unpacked data of versions 1 to 3. `stopped` is the reason why the end is missing, or nullopt.
std::optional<std::string> read_planes(const Header& header, Bytes data, const std::optional<std::string>& stopped,
                                       SplatModel& model) {
  model.announced = header.count;
  std::array<Bytes, plane_count> planes;
  std::size_t at = kSpzHeaderBytes;
  const auto widths = plane_widths(header.version);
  for (std::size_t plane = 0; plane < plane_count; ++plane) {
    const std::size_t length = widths[plane] * header.count;
    if (length > data.size() - at) return stopped ? *stopped : "the file ends too early";
    planes[plane] = data.subspan(at, length);
    at += length;
  }
  const std::size_t all_harmonics = kHarmonicBytes[static_cast<std::size_t>(model.harmonics)] * header.count;
  const Bytes harmonics = all_harmonics <= data.size() - at ? data.subspan(at, all_harmonics) : Bytes();
  if ((header.flags & kHasExtensions) && header.harmonics_degree < kHarmonicBytes.size() &&
      all_harmonics <= data.size() - at)
    read_extensions(data.subspan(at + all_harmonics), model);
  model.antialiased = (header.flags & kAntialiased) != 0;
  unpack(header, planes, harmonics, model);
  return std::nullopt;
}

std::optional<std::string> read_gzip(Bytes bytes, SplatModel& model, const WorldBudget& budget) {
  Array<std::byte> data;  // an Array grows without a copy
  Header header;
  std::optional<std::string> problem;
  bool known = false;
  std::size_t wanted = kSpzHeaderBytes;
  Share share(budget, Resource::files);
  const auto stopped = gunzip(bytes, budget, [&](std::string_view piece) {
    if (!share.grow(piece.size())) problem = "unpacks to " + budget->refusal(Resource::files);
    if (problem) return false;
    std::memcpy(data.prepare(piece.size()), piece.data(), piece.size());
    data.commit(piece.size());
    if (!known && data.size() >= kSpzHeaderBytes) {
      known = true;
      problem = read_header(data.data(), bytes.size(), header);
      if (!problem && header.version > 3) problem = "SPZ version 4 within gzip; expected 1 to 3";
      model.set_degree(std::min(int{header.harmonics_degree}, static_cast<int>(kHarmonicBytes.size()) - 1));
      if (!problem) problem = model.draw(budget, header.count);
      wanted = kSpzHeaderBytes + header.count * kMaxSplatBytes + kMaxExtensionBytes;
    }
    return !problem && (!known || data.size() < wanted);
  });
  if (problem) return problem;
  if (!known) return stopped ? "not an SPZ file: " + *stopped : "not an SPZ file: expected a header of 16 bytes";
  return read_planes(header, data.span(), stopped, model);
}

/// Reads versions 1 to 3 without gzip.
std::optional<std::string> read_unpacked(Bytes bytes, const Header& header, SplatModel& model,
                                         const WorldBudget& budget) {
  // A splat has at least 16 bytes.
  if (header.count > bytes.size() / 16) return std::to_string(header.count) + " splats, which exceed the file";
  model.set_degree(std::min(int{header.harmonics_degree}, static_cast<int>(kHarmonicBytes.size()) - 1));
  if (auto problem = model.draw(budget, header.count)) return problem;
  return read_planes(header, bytes, std::nullopt, model);
}

/// Reads version 4, and files of earlier versions without gzip.
std::optional<std::string> read_plain(Bytes bytes, SplatModel& model, const WorldBudget& budget) {
  if (bytes.size() < kSpzHeaderBytes4) return "the file ends within its header of 32 bytes";
  Header header;
  if (auto problem = read_header(bytes.data(), bytes.size(), header)) return problem;
  if (header.version != 4) return read_unpacked(bytes, header, model, budget);
  const std::size_t streams = std::to_integer<std::size_t>(bytes[15]);
  const std::size_t table = load_little<std::uint32_t>(bytes.data() + 16);
  if (streams < plane_count) return std::to_string(streams) + " streams; expected at least 5";
  if (table < kSpzHeaderBytes4 || table > bytes.size() || streams * 16 > bytes.size() - table)
    return "the table of streams exceeds the file";
  if (header.flags & kHasExtensions) read_extensions(bytes.subspan(kSpzHeaderBytes4, table - kSpzHeaderBytes4), model);
  model.announced = header.count;
  model.set_degree(std::min(int{header.harmonics_degree}, static_cast<int>(kHarmonicBytes.size()) - 1));
  if (auto problem = model.draw(budget, header.count)) return problem;
  constexpr std::size_t kHarmonicsPlane = plane_count;
  std::array<std::vector<std::byte>, plane_count + 1> data;
  Share share(budget, Resource::files);
  std::array<Bytes, plane_count> planes;
  std::size_t at = table + streams * 16;
  const auto widths = plane_widths(header.version);
  const std::size_t harmonic_bytes = kHarmonicBytes[static_cast<std::size_t>(model.harmonics)];
  const bool shaded = harmonic_bytes > 0 && streams > kHarmonicsPlane;
  for (std::size_t plane = 0; plane < plane_count + (shaded ? 1 : 0); ++plane) {
    const auto packed = load_little<std::uint64_t>(bytes.data() + table + plane * 16);
    const auto unpacked = load_little<std::uint64_t>(bytes.data() + table + plane * 16 + 8);
    const std::size_t expected = (plane == kHarmonicsPlane ? harmonic_bytes : widths[plane]) * header.count;
    if (unpacked != expected)
      return "stream " + std::to_string(plane) + " of " + std::to_string(unpacked) + " bytes; expected " +
             std::to_string(expected);
    // The list doubles when it grows, so charge twice its size.
    if (!share.grow(2 * expected)) return "unpacks to " + budget->refusal(Resource::files);
    if (packed > bytes.size() - at) return "the file ends too early: stream " + std::to_string(plane) + " is truncated";
    if (auto problem = unzstd(bytes.subspan(at, static_cast<std::size_t>(packed)), expected, data[plane]))
      return problem;
    if (plane < plane_count) planes[plane] = data[plane];
    at += static_cast<std::size_t>(packed);
  }
  model.antialiased = (header.flags & kAntialiased) != 0;
  unpack(header, planes, data[kHarmonicsPlane], model);
  return std::nullopt;
}

}  // namespace

bool is_splats_spz(std::span<const std::byte> bytes) {
  return bytes.size() >= 4 && load_little<std::uint32_t>(bytes.data()) == kSpzMagic;
}

std::optional<std::string> read_spz_model(std::span<const std::byte> bytes, const WorldBudget& budget,
                                          SplatModel& model) {
  model.format = "SPZ";
  model.axes = kFromRightUpBack;
  return is_gzip(bytes)         ? read_gzip(bytes, model, budget)
         : is_splats_spz(bytes) ? read_plain(bytes, model, budget)
                                : std::optional<std::string>("not an SPZ file: expected NGSP or gzip data");
}

ImportedVectors import_splats_spz(std::span<const std::byte> bytes, const WorldBudget& budget) {
  SplatModel model;
  if (auto problem = read_spz_model(bytes, budget, model)) return std::move(*problem);
  return import_result(model);
}

}  // namespace gs::app
