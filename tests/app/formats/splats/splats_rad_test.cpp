#include "app/formats/splats/splats_rad.h"

#include "app/formats/common/byte_order.h"
#include "app/formats/content_types.h"
#include "tests/app/geometry_shapes.h"

#include <zlib.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace gs::app::splats_rad_test {
namespace {

using RadBytes = std::vector<std::byte>;

void put_raw(RadBytes& to, std::initializer_list<int> bytes) {
  for (const int byte : bytes) to.push_back(static_cast<std::byte>(byte));
}

RadBytes raw(std::initializer_list<int> bytes) {
  RadBytes made;
  put_raw(made, bytes);
  return made;
}

template <class Number>
RadBytes numbers(std::initializer_list<Number> values) {
  RadBytes made;
  for (const Number value : values) put_little(made, value);
  return made;
}

/// Returns the numbers split into byte planes, beginning with the lowest bytes.
RadBytes split_floats(std::initializer_list<float> values) {
  const RadBytes whole = numbers(values);
  RadBytes made;
  for (std::size_t b = 0; b < 4; ++b)
    for (std::size_t i = b; i < whole.size(); i += 4) made.push_back(whole[i]);
  return made;
}

RadBytes deflated(const RadBytes& bytes) {
  RadBytes made(bytes.size() + 64);
  z_stream stream{};
  REQUIRE(deflateInit2(&stream, 6, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) == Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(made.data());
  stream.avail_out = static_cast<uInt>(made.size());
  REQUIRE(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  made.resize(stream.total_out);
  deflateEnd(&stream);
  return made;
}

void pad(RadBytes& to) {
  while (to.size() % 8 != 0) to.push_back(std::byte{0});
}

/// Appends a mark, the length of a text, and the text.
void put_head(RadBytes& to, const char* mark, const std::string& text) {
  for (int i = 0; i < 4; ++i) to.push_back(static_cast<std::byte>(mark[i]));
  put_little(to, static_cast<std::uint32_t>(text.size()));
  for (const char c : text) to.push_back(static_cast<std::byte>(c));
  pad(to);
}

struct RadProperty {
  std::string name, encoding, limits;
  RadBytes data;
};

RadBytes rad_chunk(std::size_t base, std::size_t count, const std::vector<RadProperty>& properties) {
  RadBytes payload;
  std::string list;
  for (const RadProperty& one : properties) {
    const RadBytes packed = deflated(one.data);
    list += (list.empty() ? "" : ",") + std::string("{\"offset\":") + std::to_string(payload.size()) +
            ",\"bytes\":" + std::to_string(packed.size()) + ",\"property\":\"" + one.name + "\",\"encoding\":\"" +
            one.encoding + "\",\"compression\":\"gz\"" + one.limits + "}";
    payload.insert(payload.end(), packed.begin(), packed.end());
    pad(payload);
  }
  RadBytes chunk;
  put_head(chunk, "RADC",
           "{\"version\":1,\"base\":" + std::to_string(base) + ",\"count\":" + std::to_string(count) +
               ",\"payloadBytes\":" + std::to_string(payload.size()) + ",\"properties\":[" + list + "]}");
  put_little(chunk, std::uint64_t{payload.size()});
  chunk.insert(chunk.end(), payload.begin(), payload.end());
  return chunk;
}

/// Returns a tree of a splat and its two parts, in two chunks.
RadBytes rad_file(const std::string& version = "1") {
  const std::string byte = ",\"min\":0,\"max\":1", scale = ",\"min\":-12,\"max\":9", sh = ",\"min\":-2,\"max\":2";
  const RadBytes root = rad_chunk(0, 1,
                                  {{"center", "f32_lebytes", "", split_floats({0, 1, 2})},
                                   {"alpha", "f32", "", numbers<float>({1.5f})},
                                   {"rgb", "r8_delta", byte, raw({255, 0, 51})},
                                   {"scales", "ln_0r8", scale, raw({128, 128, 128})},
                                   {"orientation", "oct88r8", "", raw({128, 128, 0})},
                                   {"sh1", "s8", sh, raw({0, 0, 0, 0, 0, 0, 0, 0, 0})},
                                   {"child_count", "u16", "", numbers<std::uint16_t>({2})},
                                   {"child_start", "u32", "", numbers<std::uint32_t>({1})}});
  const RadBytes parts =
      rad_chunk(1, 2,
                {{"center", "f32_lebytes", "", split_floats({1, -1, 3, 4, 5, 6})},  // x, x, y, y, z, z
                 {"alpha", "r8", byte, raw({204, 51})},
                 {"rgb", "r8_delta", byte, raw({0, 51, 255, 1, 102, 0})},
                 {"scales", "ln_0r8", scale, raw({1, 255, 128, 128, 0, 0})},
                 {"orientation", "oct88r8", "", raw({255, 128, 128, 128, 128, 255})},
                 {"sh1", "s8", sh, raw({127, 0, 0, 129, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 64, 0, 0, 0})},
                 {"child_count", "u16", "", numbers<std::uint16_t>({0, 0})},
                 {"child_start", "u32", "", numbers<std::uint32_t>({0, 0})}});
  RadBytes file;
  put_head(file, "RAD0",
           "{\"version\":" + version +
               ",\"type\":\"gsplat\",\"count\":3,\"maxSh\":1,\"lodTree\":true,\"chunks\":[{\"offset\":0,\"bytes\":" +
               std::to_string(root.size()) + "},{\"offset\":" + std::to_string(root.size()) +
               ",\"bytes\":" + std::to_string(parts.size()) + "}]}");
  file.insert(file.end(), root.begin(), root.end());
  file.insert(file.end(), parts.begin(), parts.end());
  return file;
}

struct ReadRad {
  Asset asset;
  Diagnostics diagnostics;
};
ReadRad read_rad(const RadBytes& bytes) {
  ReadRad result;
  result.asset = read_splats_rad({bytes, "a.rad", nullptr, own_budget(), result.diagnostics});
  return result;
}

}  // namespace

TEST_CASE("reads the finest splats of RAD") {
  const RadBytes file = rad_file();
  CHECK(content_type_of("x", file).name == "RAD");
  const ReadRad read = read_rad(file);
  REQUIRE(std::holds_alternative<qnv::Gaussians>(read.asset));
  CHECK(read.diagnostics.entries().empty());
  const auto& splats = std::get<qnv::Gaussians>(read.asset);
  test::check_gaussians(splats);
  REQUIRE(splats.size() == 2);
  CHECK(splats.positions[0] == glm::vec3(1, -3, -5));  // y is down and z forward in the file
  CHECK(splats.positions[1] == glm::vec3(-1, -4, -6));
  CHECK(splats.opacities[0] == Approx(0.8f));
  CHECK(splats.opacities[1] == Approx(0.2f));
  CHECK(splats.bases[0].x == Approx(0).margin(1e-6));
  CHECK(splats.bases[1].x == Approx(0.2f));
  CHECK(splats.bases[1].y == Approx(0).margin(1e-6));  // 255 + 1 is 0
  CHECK(splats.bases[1].z == Approx(0.4f));
  CHECK(splats.scales[0].x == Approx(std::exp(-12.0f)));
  CHECK(splats.scales[1].x == Approx(std::exp(9.0f)));
  CHECK(splats.scales[1].z == 0);
  // Half a turn about z, and a quarter turn about x.
  CHECK(std::abs(splats.rotations[1].z) == Approx(1).margin(0.01));
  CHECK(std::abs(splats.rotations[0].x) == Approx(std::sqrt(0.5f)).margin(0.01));
  REQUIRE(splats.degree == 1);
  CHECK(splats.harmonics[0].x == Approx(-2));               // of y, which changes its sign
  CHECK(splats.harmonics[3].y == Approx(2));                // -127 of the second splat
  CHECK(splats.harmonics[2].y == Approx(2 * 64 / 127.0f));  // of x
}

TEST_CASE("reads coarser splats of a RAD file without its end") {
  const RadBytes file = rad_file();
  const ReadRad read = read_rad(RadBytes(file.begin(), file.end() - 40));
  REQUIRE(std::holds_alternative<qnv::Gaussians>(read.asset));
  const auto& splats = std::get<qnv::Gaussians>(read.asset);
  REQUIRE(splats.size() == 1);
  CHECK(splats.positions[0] == glm::vec3(0, -1, -2));
  CHECK(splats.opacities[0] == 1);
  REQUIRE(read.diagnostics.entries().size() == 1);
  CHECK(read.diagnostics.entries()[0].message.find("its end is missing; coarser splats remain") != std::string::npos);
}

TEST_CASE("refuses RAD files that claim more than their bytes can hold") {
  const auto first_message = [](const RadBytes& chunk, const std::string& chunks) {
    RadBytes file;
    put_head(file, "RAD0", "{\"version\":1,\"type\":\"gsplat\",\"count\":9,\"maxSh\":0,\"chunks\":[" + chunks + "]}");
    file.insert(file.end(), chunk.begin(), chunk.end());
    const ReadRad read = read_rad(file);
    REQUIRE_FALSE(read.diagnostics.entries().empty());
    return read.diagnostics.entries()[0].message;
  };
  const auto range_of = [](const RadBytes& chunk) {
    return "{\"offset\":0,\"bytes\":" + std::to_string(chunk.size()) + "}";
  };
  const RadProperty center{"center", "f32_lebytes", "", split_floats({0, 1, 2})};
  const RadBytes many = rad_chunk(0, 1'000'000'000, {center});
  CHECK(first_message(many, range_of(many)).find("announces 1000000000 splats") != std::string::npos);
  const RadBytes once = rad_chunk(0, 1, {center});
  CHECK(
      first_message(once, range_of(once) + "," + range_of(once) + "," + range_of(once)).find("coarser splats remain") !=
      std::string::npos);
}

TEST_CASE("reads damaged RAD files without faults") {
  CHECK(read_rad(rad_file("2")).diagnostics.errors() == 1);
  const RadBytes file = rad_file();
  for (std::size_t length = 0; length < file.size(); length += 3)
    (void)read_rad(RadBytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(length)));
  RadBytes damaged = file;
  for (std::size_t i = 0; i < file.size(); i += 2) {
    damaged[i] ^= std::byte{0x15};
    (void)read_rad(damaged);
    damaged[i] = file[i];
  }
}

}  // namespace gs::app::splats_rad_test
