#include "app/formats/splats/splats.h"

#include "app/formats/mesh/points.h"
#include "tests/app/geometry_shapes.h"
#include "tests/gzip.h"

#include <algorithm>

namespace {

using namespace gs::test;
using namespace gs::app;
using gs::qnv::Rgb8;

constexpr float kPi = std::numbers::pi_v<float>;
const glm::vec4 kNoTurn(0, 0, 0, 1);

bool near(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-5f) { return length(a - b) <= tolerance; }

SplatModel one_splat(glm::vec3 position, glm::vec3 scale, glm::vec4 rotation) {
  SplatModel model;
  model.format = "test";
  model.axes = kFromRightUpBack;
  model.resize(1);
  model.positions[0] = position;
  model.scales[0] = scale;
  model.rotations[0] = rotation;
  model.opacities[0] = 1;
  return model;
}

TEST_CASE("converts a splat to the disc across its smallest axis") {
  SplatModel model = one_splat({1, 2, 3}, {2, 3, 0.02f}, kNoTurn);
  model.dc[0] = {0, 0.5f / kSphericalHarmonic0, -9};
  Splats geometry = vectors_of_splats(model);
  check_sound(geometry);
  REQUIRE(geometry.size() == 1);
  CHECK(geometry.positions[0] == glm::vec3(1, 2, 3));
  CHECK(near(geometry.normals[0], {0, 0, 1}));
  // The integral of the Gaussian, 2 pi s1 s2, is the area.
  CHECK(geometry.weights[0] == Approx(12 * kPi));
  CHECK(geometry.colors[0] == Rgb8{128, 255, 0});
  CHECK(metadata(geometry, "splats not discs").empty());
  CHECK(metadata(geometry, "source") == "test");

  // A quarter turn about x moves y to z, so the disc across y faces z.
  const float half = std::sqrt(0.5f);
  geometry = vectors_of_splats(one_splat({0, 0, 0}, {1, 0.01f, 1}, {half, 0, 0, half}));
  CHECK(near(geometry.normals[0] * geometry.normals[0], {0, 0, 1}));
  // A quaternion of another length, with the axes of most files, gives the same splat.
  model = one_splat({0, 5, 7}, {0.01f, 1, 1}, {0, 0, 3 * half, 3 * half});
  model.axes = kFromRightDownForward;
  geometry = vectors_of_splats(model);
  CHECK(near(geometry.normals[0] * geometry.normals[0], {0, 1, 0}));
  CHECK(geometry.positions[0] == glm::vec3(0, -5, -7));
}

TEST_CASE("orients splats away from the middle of the box unless they have normals") {
  // Round splats face away from the middle of the box. Flat splats keep their z axis. Given normals take precedence.
  SplatModel model = one_splat({0, 0, -1}, {1, 1, 0.1f}, kNoTurn);
  model.resize(2);
  model.positions[1] = {0, 0, 1};
  model.scales[1] = model.scales[0];
  model.rotations[1] = kNoTurn;
  model.opacities[1] = 1;
  CHECK(near(vectors_of_splats(model).normals[0], {0, 0, -1}));
  CHECK(near(vectors_of_splats(model).normals[1], {0, 0, 1}));
  model.scales[0].z = model.scales[1].z = 0;
  CHECK(near(vectors_of_splats(model).normals[0], {0, 0, 1}));
  model.normals = {{0, 0.1f, -2}, {0, 0, 0}};
  CHECK(near(vectors_of_splats(model).normals[0], {0, 0, -1}));
  CHECK(near(vectors_of_splats(model).normals[1], {0, 0, 1}));
}

TEST_CASE("counts splats that cannot be discs") {
  SplatModel model;
  model.format = "test";
  model.announced = 12;
  model.resize(10);
  for (std::size_t i = 0; i < model.size(); ++i) {
    model.positions[i] = {static_cast<float>(i), 0, 0};
    model.scales[i] = {1, 1, 0.2f};
    model.rotations[i] = kNoTurn;
    model.opacities[i] = 0.5f;
  }
  model.scales[1] = {1, 0.31f, 1};  // thick
  model.opacities[2] = 0.9f / 255;
  model.positions[3].y = NAN;
  model.scales[4].x = INFINITY;
  model.scales[5] = {0, 0, 0};
  model.rotations[6] = {0, 0, 0, 0};
  model.scales[7].z = -1;
  model.opacities[8] = NAN;
  const Splats geometry = vectors_of_splats(model);
  check_sound(geometry);
  CHECK(geometry.size() == 3);
  CHECK(metadata(geometry, "splats not discs") == "1");
  CHECK(metadata(geometry, "splats too faint") == "1");
  CHECK(metadata(geometry, "splats broken") == "6");
  CHECK(metadata(geometry, "splats missing") == "2");
  CHECK(std::holds_alternative<std::string>(import_result(SplatModel())));
}

TEST_CASE("names the opacity and the harmonics that splats lose") {
  SplatModel model = one_splat({1, 2, 3}, {2, 3, 0.02f}, kNoTurn);
  const auto drawn = [&] { return metadata(vectors_of_splats(model), kSplatsAsDiscs); };
  CHECK(drawn().empty());
  model.opacities[0] = 252.0f / 255;  // as in exports of GhostSpace
  CHECK(drawn().empty());
  model.harmonics = 3;
  CHECK(drawn() == "opaque surface splats, without their spherical harmonics up to degree 3");
  model.opacities[0] = 0.5f;
  CHECK(drawn() == "opaque surface splats, without their opacity and spherical harmonics up to degree 3");
  model.harmonics = 0;
  CHECK(drawn() == "opaque surface splats, without their opacity");
  // A dropped splat does not count as lost opacity.
  model.resize(2);
  model.opacities = {1, 0.001f};
  model.scales[1] = model.scales[0];
  model.rotations[1] = kNoTurn;
  CHECK(drawn().empty());
}

constexpr const char* k2dgs =
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
    "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\nproperty float opacity\n"
    "property float scale_0\nproperty float scale_1\n"
    "property float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\nend_header\n"
    "1 2 3 0 0 0 0 0 0 1 0 0 0\n"
    "4 5 6 1.7724539 0 -1.7724539 10 0.6931472 0 0 1 0 0\n";

TEST_CASE("reads 2DGS PLY") {
  CHECK(is_splats_ply(bytes_of(k2dgs)));
  CHECK_FALSE(is_splats_compressed_ply(bytes_of(k2dgs)));
  const Splats geometry = vectors_of(import_splats_ply, bytes_of(k2dgs));
  REQUIRE(geometry.size() == 2);
  CHECK(metadata(geometry, "source") == "2DGS PLY");
  CHECK(geometry.positions[0] == glm::vec3(1, -2, -3));
  CHECK(near(geometry.normals[0], {0, 0, -1}));  // +Z of the file faces away from the viewer
  CHECK(near(geometry.normals[1], {0, 0, 1}));   // half a turn around x
  CHECK(geometry.weights[0] == Approx(2 * kPi));
  CHECK(geometry.weights[1] == Approx(4 * kPi));  // ln 2
  CHECK(geometry.colors[1] == Rgb8{255, 128, 0});
  CHECK(metadata(geometry, kSplatsAsDiscs) == "opaque surface splats, without their opacity");
  check_hostile(import_splats_ply, bytes_of(k2dgs));
}

TEST_CASE("finds the degree of the harmonics in a PLY file") {
  for (const auto& [count, degree] : {std::pair(0, 0), {3, 1}, {9, 1}, {24, 2}, {45, 3}, {72, 4}}) {
    std::string text = k2dgs, header, values;
    for (int i = 0; i < count; ++i) {
      header += "property float f_rest_" + std::to_string(i) + "\n";
      values += " 0.25";
    }
    text.replace(text.find(" 0 0 0 0 0 0 1 0 0 0\n"), 20, " 0 0 0 20 0 0 1 0 0 0" + values);
    text.replace(text.rfind('\n'), 1, values + "\n");
    text.insert(text.find("end_header"), header);
    const std::string drawn = metadata(vectors_of(import_splats_ply, bytes_of(text)), kSplatsAsDiscs);
    INFO(text);
    CHECK(drawn == (degree == 0 ? std::string()
                                : "opaque surface splats, without their spherical harmonics up to degree " +
                                      std::to_string(degree)));
  }
}

TEST_CASE("reads 3DGS PLY of a trained scene") {
  const auto path = shared_folder() / "data/splats/train-1000.ply";
  if (!std::filesystem::exists(path)) {
    WARN("no " << path);
    return;
  }
  Bytes bytes = file_bytes(path);
  CHECK(is_splats_ply(bytes));
  CHECK_FALSE(is_points_ply(bytes_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n")));
  const Splats geometry = vectors_of(import_splats_ply, bytes);
  REQUIRE(geometry.size() == 1000);
  CHECK(metadata(geometry, "splats not discs") == "865");
  CHECK(metadata(geometry, kSplatsAsDiscs) ==
        "opaque surface splats, without their opacity and spherical harmonics up to degree 3");
  // This value was computed from the file by another program, in double precision.
  CHECK(geometry.description.total == Approx(12.003164223254227).epsilon(1e-5));
  CHECK(near(geometry.positions[500], {-3.191091775894165f, -0.17911396920681f, 1.1883732080459595f}));
  CHECK(near(geometry.normals[0], {0.9759472f, 0.2069927f, 0.0684179f}));
  CHECK(std::abs(dot(geometry.normals[500], {-0.0859895f, -0.9825963f, -0.1646523f})) == Approx(1));
  CHECK(geometry.weights[500] == Approx(0.005127410793246222));
  CHECK(geometry.colors[0] == Rgb8{110, 144, 108});
  CHECK(geometry.colors[999] == Rgb8{72, 105, 92});
  bytes.resize(bytes.size() - 248 * 100 - 7);
  const Splats shorter = vectors_of(import_splats_ply, bytes);
  CHECK(shorter.size() == 899);
  CHECK(metadata(shorter, "splats missing") == "101");
  bytes.resize(4000);
  check_hostile(import_splats_ply, bytes, 97);
}

void put_antimatter(Bytes& to, glm::vec3 p, glm::vec3 s, std::initializer_list<int> color_and_rotation) {
  for (int k = 0; k < 3; ++k) put(to, p[k]);
  for (int k = 0; k < 3; ++k) put(to, s[k]);
  for (const int b : color_and_rotation) to.push_back(static_cast<std::byte>(b));
}

TEST_CASE("reads antimatter .splat, and every prefix as a scene") {
  Bytes bytes;
  put_antimatter(bytes, {1, 2, 3}, {0.5f, 0.25f, 0.001f}, {255, 0, 51, 255, 255, 128, 128, 128});
  // (0, 1, 1, 0) as w x y z: half a turn about the diagonal moves z to -z and swaps x and y.
  put_antimatter(bytes, {-1, 0, 0}, {0.001f, 1, 1}, {0, 255, 0, 128, 128, 218, 218, 128});
  put_antimatter(bytes, {0, 0, 0}, {1, 1, 1}, {0, 0, 0, 0, 255, 128, 128, 128});  // invisible
  const Splats geometry = vectors_of(import_splats_antimatter, bytes);
  REQUIRE(geometry.size() == 2);
  CHECK(geometry.positions[0] == glm::vec3(1, -2, -3));
  CHECK(geometry.weights[0] == Approx(kPi / 4));
  CHECK(near(geometry.normals[0] * geometry.normals[0], {0, 0, 1}));
  CHECK(near(geometry.normals[1] * geometry.normals[1], {0, 1, 0}));
  CHECK(geometry.colors[0] == Rgb8{255, 0, 51});
  CHECK(metadata(geometry, "splats too faint") == "1");
  CHECK(metadata(geometry, kSplatsAsDiscs) == "opaque surface splats, without their opacity");
  CHECK(
      metadata(vectors_of(import_splats_antimatter, Bytes(bytes.begin(), bytes.begin() + 32)), kSplatsAsDiscs).empty());
  bytes.resize(70);
  CHECK(metadata(vectors_of(import_splats_antimatter, bytes), "splats missing") == "1");
  CHECK(problem_of(import_splats_antimatter, Bytes(31)).find("32 bytes") != std::string::npos);
  check_hostile(import_splats_antimatter, bytes);
}

struct Ksplat {
  std::uint16_t mode = 0, degree = 0;
  std::uint32_t count = 0, bucket_size = 0, full = 0;
  std::vector<std::uint32_t> partial;
  std::vector<glm::vec3> centers;
  float block = 0;
  Bytes splats;

  [[nodiscard]] Bytes file() const {
    Bytes bytes(4096 + 1024);
    const auto set = [&](std::size_t at, auto value) { std::memcpy(&bytes[at], &value, sizeof value); };
    bytes[1] = std::byte{1};
    for (const std::size_t at : {4, 8}) set(at, std::uint32_t{1});
    set(12, count);
    set(16, count);
    set(20, mode);
    set(4096, count);
    set(4100, count);
    set(4104, bucket_size);
    set(4108, static_cast<std::uint32_t>(centers.size()));
    set(4112, block);
    set(4116, std::uint16_t{12});
    set(4128, full);
    set(4132, static_cast<std::uint32_t>(partial.size()));
    set(4136, degree);
    for (const auto size : partial) put(bytes, size);
    for (const auto& center : centers)
      for (int k = 0; k < 3; ++k) put(bytes, center[k]);
    bytes.insert(bytes.end(), splats.begin(), splats.end());
    return bytes;
  }
};

TEST_CASE("reads .ksplat with floats") {
  Ksplat made;
  made.count = 2;
  made.degree = 1;
  for (int i = 0; i < 2; ++i) {
    for (const float f : {1.0f, 2.0f, 3.0f + static_cast<float>(i), 0.5f, 0.25f, 0.001f, 2.0f, 0.0f, 0.0f, 0.0f})
      put(made.splats, f);
    for (const int b : {10, 20, 30, 255}) made.splats.push_back(static_cast<std::byte>(b));
    for (int k = 0; k < 9; ++k) put(made.splats, 0.5f);
  }
  const Bytes bytes = made.file();
  const Splats geometry = vectors_of(import_splats_ksplat, bytes);
  REQUIRE(geometry.size() == 2);
  CHECK(geometry.positions[1] == glm::vec3(1, -2, -4));
  CHECK(geometry.weights[0] == Approx(kPi / 4));
  CHECK(geometry.colors[0] == Rgb8{10, 20, 30});
  CHECK(near(geometry.normals[0], {0, 0, -1}));
  CHECK(metadata(geometry, kSplatsAsDiscs) ==
        "opaque surface splats, without their spherical harmonics up to degree 1");
  Bytes wrong = bytes;
  wrong[0] = std::byte{1};
  CHECK(problem_of(import_splats_ksplat, wrong).find("version 1.1") != std::string::npos);
  wrong = bytes;
  wrong.resize(wrong.size() - 1);
  CHECK(problem_of(import_splats_ksplat, wrong).find("too early") != std::string::npos);
}

TEST_CASE("reads small files of splats that another program wrote") {
  const auto folder = shared_folder() / "data/splats-formats";
  if (!std::filesystem::exists(folder / "minimal.ksplat")) {
    WARN("no " << folder);
    return;
  }
  for (const char* name : {"minimal-raw.spz", "minimal-v2.spz", "minimal-v3.spz", "minimal-v4.spz"}) {
    INFO(name);
    CHECK(vectors_of(import_splats_spz, file_bytes(folder / name)).size() == 4);
  }
  check_any(import_splats_ksplat, file_bytes(folder / "minimal.ksplat"));
}

TEST_CASE("reads .ksplat with buckets") {
  for (const std::uint16_t mode : {1, 2}) {
    Ksplat made;
    made.mode = mode;
    made.degree = 1;
    made.count = 4;
    made.bucket_size = 2;
    made.full = 1;
    made.partial = {1, 1};
    made.centers = {{10, 0, 0}, {20, 0, 0}, {30, 0, 0}};
    made.block = 2 * 32767;  // one unit per step
    for (int i = 0; i < 4; ++i) {
      for (const int c : {32767 + i, 32767, 32766}) put(made.splats, static_cast<std::uint16_t>(c));
      for (const int half : {0x3800, 0x3400, 0x0400})
        put(made.splats, static_cast<std::uint16_t>(half));                                         // 1/2 1/4 2^-14
      for (const int half : {0, 0x3c00, 0, 0}) put(made.splats, static_cast<std::uint16_t>(half));  // x = 1
      for (const int b : {10, 20, 30, 255}) made.splats.push_back(static_cast<std::byte>(b));
      for (int k = 0; k < 9 * (mode == 1 ? 2 : 1); ++k) made.splats.push_back(std::byte{7});
    }
    const Bytes bytes = made.file();
    const Splats geometry = vectors_of(import_splats_ksplat, bytes);
    REQUIRE(geometry.size() == 4);
    CHECK(geometry.positions[0] == glm::vec3(10, 0, 1));
    CHECK(geometry.positions[1] == glm::vec3(11, 0, 1));
    CHECK(geometry.positions[2] == glm::vec3(22, 0, 1));
    CHECK(geometry.positions[3] == glm::vec3(33, 0, 1));
    CHECK(geometry.weights[3] == Approx(kPi / 4));
    CHECK(near(geometry.normals[0], {0, 0, 1}));
    check_hostile(import_splats_ksplat, bytes, 13);
  }
}

/// Returns two splats of an SPZ file before compression.
Bytes spz(std::uint32_t version, int flags = 0) {
  Bytes data;
  put(data, std::uint32_t{0x5053474e});
  put(data, version);
  put(data, std::uint32_t{2});
  for (const int b : {0, 4, flags, 0}) data.push_back(static_cast<std::byte>(b));
  for (int i = 0; i < 2; ++i)
    for (const int fixed : {16, -16, 40 + i}) {  // 1, -1, 2.5
      if (version == 1) {
        put(data, static_cast<std::uint16_t>(fixed == 16 ? 0x3c00 : fixed == -16 ? 0xbc00 : 0x4100));
        continue;
      }
      for (int shift = 0; shift < 24; shift += 8) data.push_back(static_cast<std::byte>(fixed >> shift & 255));
    }
  for (int i = 0; i < 2; ++i) data.push_back(std::byte{255});
  for (int i = 0; i < 6; ++i) data.push_back(std::byte{255});                                // dc 10/3: colour over 1
  for (const int s : {160, 160, 0, 160, 160, 0}) data.push_back(static_cast<std::byte>(s));  // exp(0), exp(-10)
  for (int i = 0; i < 2; ++i) {
    if (version < 3) {
      for (const int b : {255, 127, 127}) data.push_back(static_cast<std::byte>(b));  // x = 1: half a turn
    } else {
      // Component 0, x, is dropped; y, z and the lowest, w, are 0.
      put(data, std::uint32_t{0});
    }
  }
  if (flags & 2) {
    put(data, 0xadbe0003u);
    put(data, std::uint32_t{4});
    put(data, std::uint32_t{6});  // right, down, forward
  }
  return data;
}

/// Returns the first position in the coordinates of the file.
glm::vec3 first_place(const Splats& geometry) {
  return glm::vec3(geometry.description.origin + glm::dvec3(geometry.positions[0]));
}

TEST_CASE("reads SPZ versions 1 to 3") {
  for (const std::uint32_t version : {1u, 2u, 3u}) {
    const Bytes bytes = gs::test::deflated(spz(version));
    const Splats geometry = vectors_of(import_splats_spz, bytes);
    REQUIRE(geometry.size() == 2);
    CHECK(first_place(geometry) == glm::vec3(1, -1, 2.5f));
    CHECK(geometry.weights[0] == Approx(2 * kPi));
    CHECK(geometry.colors[0] == Rgb8{255, 255, 255});
    CHECK(near(geometry.normals[0], {0, 0, -1}, 0.01f));
    CHECK(metadata(geometry, kSplatsAsDiscs).empty());
    Bytes lossy = spz(version);
    lossy[12] = std::byte{2};
    lossy[16 + (version == 1 ? 12 : 18)] = std::byte{128};
    lossy.resize(lossy.size() + 2 * 24);
    CHECK(metadata(vectors_of(import_splats_spz, gs::test::deflated(lossy)), kSplatsAsDiscs) ==
          "opaque surface splats, without their opacity and spherical harmonics up to degree 2");
    check_hostile(import_splats_spz, bytes);
    // Invalid data that decompresses.
    Bytes data = spz(version);
    for (std::size_t i = 0; i < data.size(); ++i) {
      Bytes changed = data;
      changed[i] ^= std::byte{0xff};
      check_any(import_splats_spz, gs::test::deflated(changed));
      changed.resize(i);
      check_any(import_splats_spz, gs::test::deflated(changed));
    }
  }
  CHECK(first_place(vectors_of(import_splats_spz, gs::test::deflated(spz(3, 2)))) == glm::vec3(1, 1, -2.5f));
  CHECK(problem_of(import_splats_spz, gs::test::deflated(spz(5))).find("version 5") != std::string::npos);
  // Some writers leave out gzip.
  CHECK(first_place(vectors_of(import_splats_spz, spz(3))) == first_place(vectors_of(import_splats_spz, gs::test::deflated(spz(3)))));
  check_hostile(import_splats_spz, spz(2));
  CHECK_FALSE(problem_of(import_splats_spz, bytes_of("hello, world")).empty());
}

TEST_CASE("allocates nothing for SPZ counts that the file cannot hold") {
  Bytes bytes = spz(4);
  bytes.resize(32);
  const std::uint32_t count = 60'000'000;
  std::memcpy(&bytes[8], &count, 4);
  CHECK(problem_of(import_splats_spz, bytes).find("which exceed the file") != std::string::npos);
  std::memcpy(&bytes[4], "\x03\0\0\0", 4);
  CHECK(problem_of(import_splats_spz, gs::test::deflated(bytes)).find("which exceed the file") != std::string::npos);
}

TEST_CASE("reads the same scene from SPZ version 4 and compressed PLY") {
  const auto folder = shared_folder() / "data/splats";
  if (!std::filesystem::exists(folder / "biker.spz")) {
    WARN("no " << folder);
    return;
  }
  const Bytes packed = file_bytes(folder / "biker.spz"), ply = file_bytes(folder / "biker.compressed.ply");
  CHECK(is_splats_spz(packed));
  CHECK(is_splats_compressed_ply(ply));
  CHECK_FALSE(is_splats_ply(ply));
  const Splats a = vectors_of(import_splats_spz, packed), b = vectors_of(import_splats_compressed_ply, ply);
  REQUIRE(a.size() == 152746);
  REQUIRE(b.size() == a.size());
  float position = 0, area = 0;
  int color = 0;
  std::size_t turned = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int k = 0; k < 3; ++k) position = std::max(position, std::abs(a.positions[i][k] - b.positions[i][k]));
    area = std::max(area, std::abs(std::log(a.weights[i] / b.weights[i])));
    color = std::max({color, std::abs(a.colors[i].r - b.colors[i].r), std::abs(a.colors[i].g - b.colors[i].g),
                      std::abs(a.colors[i].b - b.colors[i].b)});
    turned += std::abs(dot(a.normals[i], b.normals[i])) < 0.99f ? 1 : 0;
  }
  // SPZ: positions to 1/4096, two scales to half of 1/16 in their logarithm, colours to 0.28 / (255 * 0.15). The PLY
  // adds smaller steps.
  CHECK(position < 0.0015f);
  CHECK(area < 0.08f);
  CHECK(color <= 3);
  // If two axes are equally long, quantisation decides which one is the smallest.
  CHECK(static_cast<double>(turned) < 0.05 * static_cast<double>(a.size()));
  CHECK(a.description.total == Approx(b.description.total).epsilon(0.002));
  CHECK(near(a.description.box.upper, {0.414307f, 3.18018f, 0.532227f}, 0.001f));

  Bytes head(packed.begin(), packed.begin() + 4000);
  check_hostile(import_splats_spz, head, 499);
  for (const std::size_t n : {packed.size() - 1, packed.size() / 2}) {
    head.assign(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(n));
    check_any(import_splats_spz, head);
  }
  head.assign(ply.begin(), ply.begin() + 60000);
  const Splats less = vectors_of(import_splats_compressed_ply, head);
  CHECK(metadata(less, "splats missing") == std::to_string(152746 - less.size()));
  head.resize(46000);
  check_hostile(import_splats_compressed_ply, head, 5003);
}

TEST_CASE("names what splats of a compressed PLY file lose") {
  const auto compressed = [](std::uint32_t color, bool harmonics) {
    const Bytes bytes = compressed_ply(color, std::vector<int>(harmonics ? 24 : 0, 128));
    return metadata(vectors_of(import_splats_compressed_ply, bytes), kSplatsAsDiscs);
  };
  CHECK(compressed(0x808080ffu, false).empty());
  CHECK(compressed(0x80808080u, false) == "opaque surface splats, without their opacity");
  CHECK(compressed(0x80808080u, true) ==
        "opaque surface splats, without their opacity and spherical harmonics up to degree 2");
}

}  // namespace
