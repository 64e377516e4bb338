#include "app/formats/common/byte_order.h"
#include "app/formats/export/export.h"
#include "app/formats/export/export_vectors.h"
#include "app/formats/splats/splats.h"
#include "app/formats/splats/spz.h"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

namespace gs::app {
namespace {

using namespace spz;
using PlaneBytes = std::vector<std::byte>;

constexpr int kZstdLevel = 12;  // compression level of the reference writer
constexpr int kMaxFractionBits = 23;
constexpr float kMinSteps = 4096;  // min number of position steps across content far from 0; fewer would deform it
constexpr std::int32_t kMaxFixed = (1 << 23) - 1;

std::byte quantized(float value) { return static_cast<std::byte>(std::lround(std::clamp(value, 0.0f, 255.0f))); }

/// Returns the largest number of fraction bits with which each coordinate fits into 24 signed bits.
int fraction_bits_for(const std::vector<ExportSplat>& splats) {
  float most = 0;
  for (const ExportSplat& splat : splats)
    for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(splat.position[k]));
  int bits = kMaxFractionBits;
  while (bits > 0 && std::ldexp(most, bits) > static_cast<float>(kMaxFixed)) --bits;
  return bits;
}

/// Packs a rotation into 32 bits. The top two bits are the index of the largest component. Each other component has a
/// sign and nine bits.
std::uint32_t packed_rotation(const glm::vec4& q) {
  int largest = 0;
  for (int k = 1; k < 4; ++k)
    if (std::abs(q[k]) > std::abs(q[largest])) largest = k;
  const bool negate = q[largest] < 0;
  auto packed = static_cast<std::uint32_t>(largest);
  for (int k = 0; k < 4; ++k) {
    if (k == largest) continue;
    const auto size = static_cast<std::uint32_t>(
        std::lround(std::min(kQuaternionSteps * std::abs(q[k]) * std::numbers::sqrt2_v<float>, kQuaternionSteps)));
    packed = packed << 10 | ((q[k] < 0) != negate ? 512u : 0u) | size;
  }
  return packed;
}

std::array<PlaneBytes, plane_count + 1> planes_of(const ExportSplats& made, int fraction_bits) {
  const std::vector<ExportSplat>& splats = made.splats;
  std::array<PlaneBytes, plane_count + 1> planes;  // the last one has the spherical harmonics
  const auto widths = plane_widths(4);
  for (std::size_t plane = 0; plane < plane_count; ++plane) planes[plane].reserve(widths[plane] * splats.size());
  for (const ExportSplat& splat : splats) {
    for (int k = 0; k < 3; ++k) {
      const double scaled = std::ldexp(static_cast<double>(splat.position[k]), fraction_bits);
      const auto fixed = static_cast<std::int32_t>(
          std::lround(std::clamp(scaled, -static_cast<double>(kMaxFixed), static_cast<double>(kMaxFixed))));
      for (int shift = 0; shift < 24; shift += 8)
        planes[positions].push_back(static_cast<std::byte>(static_cast<std::uint32_t>(fixed) >> shift & 255));
      planes[colors].push_back(quantized((splat.dc[k] * kColorScale + 0.5f) * 255));
      planes[scales].push_back(quantized((std::log(splat.scale[k]) - kMinLogScale) * kLogScaleSteps));
    }
    planes[alphas].push_back(quantized(splat.opacity * 255));
    put_little(planes[rotations], packed_rotation(splat.rotation));
  }
  planes[plane_count].reserve(3 * made.harmonics.size());
  for (std::size_t i = 0; i < made.harmonics.size(); ++i)
    for (int k = 0; k < 3; ++k) planes[plane_count].push_back(quantized(made.harmonics[i][k] * 128 + 128));
  return planes;
}

/// Writes the 16 bytes that versions 3 and 4 both begin with. The last of these bytes is `streams` in version 4.
void put_header(std::vector<std::byte>& to, std::uint32_t version, const ExportSplats& made, int fraction_bits,
                std::uint8_t streams) {
  put_little(to, kSpzMagic);
  put_little(to, version);
  put_little(to, static_cast<std::uint32_t>(made.splats.size()));
  for (const int byte :
       {made.degree, fraction_bits, made.antialiased ? int{kAntialiased} : 0, static_cast<int>(streams)})
    to.push_back(static_cast<std::byte>(byte));
}

std::optional<std::vector<std::byte>> gzipped(const std::vector<std::byte>& data) {
  z_stream stream{};
  constexpr int kGzip = 15 + 16, kMemory = 8;
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    return std::nullopt;
  std::vector<std::byte> result, piece(std::size_t{256} << 10);
  std::size_t next = 0;
  int status = Z_OK;
  while (status == Z_OK) {
    const std::size_t given = std::min<std::size_t>(data.size() - next, std::numeric_limits<uInt>::max());
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(data.data() + next));
    stream.avail_in = static_cast<uInt>(given);
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    status = deflate(&stream, next + given == data.size() ? Z_FINISH : Z_NO_FLUSH);
    next += given - stream.avail_in;
    result.insert(result.end(), piece.begin(), piece.end() - stream.avail_out);
  }
  deflateEnd(&stream);
  if (status != Z_STREAM_END) return std::nullopt;
  return result;
}

std::optional<std::vector<std::byte>> zstd_packed(const std::vector<std::byte>& data) {
  std::vector<std::byte> result(ZSTD_compressBound(data.size()));
  const std::size_t length = ZSTD_compress(result.data(), result.size(), data.data(), data.size(), kZstdLevel);
  if (ZSTD_isError(length)) return std::nullopt;
  result.resize(length);
  return result;
}

/// Converts vectors to splats. Returns a message if the splats do not fit into the format.
Exported checked(const qnv::Geometry& geometry, ExportSplats& made) {
  made = splats_of(geometry, kFromRightUpBack);
  std::vector<ExportSplat>& splats = made.splats;
  if (splats.empty()) return "SPZ needs at least one visible vector";
  if (splats.size() > kMaxSplats)
    return "too many vectors for SPZ (" + std::to_string(splats.size()) + "); expected at most " +
           std::to_string(kMaxSplats);
  const glm::dvec3& origin = geometry.description().origin;
  const glm::vec3 size = geometry.description().box.size();
  for (ExportSplat& splat : splats) splat.position = glm::vec3(origin + glm::dvec3(splat.position));
  const float step = std::ldexp(1.0f, -fraction_bits_for(splats));
  if (origin != glm::dvec3(0) && step * kMinSteps > std::max({size.x, size.y, size.z}))
    return "SPZ has 24 bits per coordinate; at this distance from 0, steps are " + std::to_string(step) +
           "; expected .ply, .3dgs.ply or .glb, which keep the positions";
  return std::vector<std::byte>();
}

Exported write_spz4(std::vector<std::byte> file, const ExportSplats& made) {
  const int fraction_bits = fraction_bits_for(made.splats);
  const auto planes = planes_of(made, fraction_bits);
  // A plane without bytes has no stream.
  const std::size_t streams_count = plane_count + (planes[plane_count].empty() ? 0 : 1);
  put_header(file, 4, made, fraction_bits, static_cast<std::uint8_t>(streams_count));
  put_little(file, static_cast<std::uint32_t>(kSpzHeaderBytes4));  // offset of the stream table
  file.resize(kSpzHeaderBytes4);
  std::vector<std::byte> streams;
  for (const PlaneBytes& plane : std::span(planes).first(streams_count)) {
    const auto packed = zstd_packed(plane);
    if (!packed) return "zstd cannot compress the data";
    put_little(file, std::uint64_t{packed->size()});
    put_little(file, std::uint64_t{plane.size()});
    streams.insert(streams.end(), packed->begin(), packed->end());
  }
  file.insert(file.end(), streams.begin(), streams.end());
  return file;
}

Exported write_spz3(std::vector<std::byte> data, const ExportSplats& made) {
  const int fraction_bits = fraction_bits_for(made.splats);
  put_header(data, 3, made, fraction_bits, 0);
  for (const PlaneBytes& plane : planes_of(made, fraction_bits)) data.insert(data.end(), plane.begin(), plane.end());
  auto packed = gzipped(data);
  if (!packed) return "zlib cannot compress the data";
  return std::move(*packed);
}

template <auto write>
Exported exported(const qnv::Geometry& geometry) {
  ExportSplats made;
  Exported bytes = checked(geometry, made);
  auto* file = std::get_if<std::vector<std::byte>>(&bytes);
  return file ? write(std::move(*file), made) : bytes;
}

}  // namespace

Exported export_spz(const qnv::Geometry& geometry, const ExportOptions&) { return exported<write_spz4>(geometry); }
Exported export_spz3(const qnv::Geometry& geometry, const ExportOptions&) { return exported<write_spz3>(geometry); }

}  // namespace gs::app
