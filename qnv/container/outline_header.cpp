#include "qnv/container/outline_header.h"

#include "base/bytes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::qnv {
namespace {

constexpr std::size_t kAppearanceBytes = 19;  // size of an encoded appearance without its URL
enum AppearanceFlag : std::uint8_t { kLit = 1, kSolid = 2, kTextured = 4 };

template <std::size_t Axes>
void put(ByteWriter& write, const OutlineLattice<Axes>& lattice) {
  write.integer(static_cast<std::int16_t>(lattice.exponent));
  for (const std::int64_t origin : lattice.origin) write.integer(origin);
  for (const std::uint32_t size : lattice.size) write.integer(size);
}

template <std::size_t Axes>
bool get(ByteReader& read, OutlineLattice<Axes>& lattice) {
  lattice.exponent = read.integer<std::int16_t>();
  for (std::int64_t& origin : lattice.origin) origin = read.integer<std::int64_t>();
  for (std::uint32_t& size : lattice.size) size = read.integer<std::uint32_t>();
  if (lattice.exponent < -149 || lattice.exponent > 127) return false;
  for (std::size_t axis = 0; axis < Axes; ++axis) {
    if (lattice.origin[axis] < -kMaxLatticeOrigin || lattice.origin[axis] > kMaxLatticeOrigin) return false;
    if (lattice.size[axis] >> kMaxLatticeBits != 0) return false;
    if (!std::isfinite(lattice.at(axis, 0)) || !std::isfinite(lattice.at(axis, lattice.size[axis]))) return false;
  }
  return true;
}

void put(ByteWriter& write, const Rgb8& color) {
  for (const std::uint8_t c : {color.r, color.g, color.b}) write.integer(c);
}

void get(ByteReader& read, Rgb8& color) {
  for (std::uint8_t* c : {&color.r, &color.g, &color.b}) *c = read.integer<std::uint8_t>();
}

OutlineAppearance get_appearance(ByteReader& read) {
  OutlineAppearance a;
  for (Rgb8* color : {&a.diffuse, &a.emissive, &a.specular}) get(read, *color);
  for (std::uint8_t* part : {&a.ambient_intensity, &a.shininess, &a.transparency}) *part = read.integer<std::uint8_t>();
  const auto flags = read.integer<std::uint8_t>();
  a.lit = (flags & kLit) != 0;
  a.solid = (flags & kSolid) != 0;
  a.textured = (flags & kTextured) != 0;
  a.crease_angle = read.f32();
  if (!(a.crease_angle >= 0 && std::isfinite(a.crease_angle))) a.crease_angle = 0;
  const auto url = read.bytes(read.integer<std::uint16_t>());
  a.texture_url.assign(reinterpret_cast<const char*>(url.data()), url.size());
  return a;
}

}  // namespace

std::vector<std::byte> encode_outline_header(const OutlineHeader& header) {
  std::vector<std::byte> out;
  ByteWriter write(out);
  put(write, header.positions);
  put(write, header.texture_coordinates);
  write.integer(header.groups);
  write.integer(header.outline_polygons);
  write.integer(header.inner_polygons);
  const std::size_t count = std::min(header.appearances.size(), kMaxOutlineAppearances);
  write.integer(static_cast<std::uint16_t>(count));
  for (const OutlineAppearance& a : std::span(header.appearances).first(count)) {
    for (const Rgb8& color : {a.diffuse, a.emissive, a.specular}) put(write, color);
    for (const std::uint8_t part : {a.ambient_intensity, a.shininess, a.transparency}) write.integer(part);
    write.integer(
        static_cast<std::uint8_t>((a.lit ? kLit : 0) | (a.solid ? kSolid : 0) | (a.textured ? kTextured : 0)));
    write.f32(a.crease_angle);
    const std::string url = a.texture_url.substr(0, 65535);
    write.integer(static_cast<std::uint16_t>(url.size()));
    for (const char c : url) out.push_back(static_cast<std::byte>(c));
  }
  return out;
}

std::optional<OutlineHeader> decode_outline_header(std::span<const std::byte> section) {
  ByteReader read(section);
  OutlineHeader header;
  if (!get(read, header.positions) || !get(read, header.texture_coordinates)) return std::nullopt;
  header.groups = read.integer<std::uint32_t>();
  header.outline_polygons = read.integer<std::uint32_t>();
  header.inner_polygons = read.integer<std::uint32_t>();
  const std::size_t count = read.integer<std::uint16_t>();
  if (!read.good() || read.left() < count * kAppearanceBytes) return std::nullopt;
  header.appearances.reserve(count);
  for (std::size_t i = 0; i < count; ++i) header.appearances.push_back(get_appearance(read));
  if (!read.good()) return std::nullopt;
  return header;
}

}  // namespace gs::qnv
