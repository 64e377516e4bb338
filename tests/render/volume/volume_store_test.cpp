#include "render/volume/volume_store.h"

#include "tests/render/volume_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>

using namespace gs;
using namespace gs::test;
using namespace gs::render;

namespace {

SharedVolume shared(std::size_t count, unsigned seed, std::size_t counted = 1u << 30) {
  const auto geometry = std::make_shared<const qnv::Volume>(random_volume(count, seed, 0.1f));
  return {geometry, std::make_shared<const VolumeModel>(volume_model(*geometry, 0, counted))};
}

/// Code as the vertex shader decodes it, before shading.
struct VolumeDecoded {
  glm::vec3 position{0}, normal{0};
  float weight = 0;
};

VolumeDecoded decode_volume_code(const VolumeCode& code, const VolumeCoding& coding) {
  VolumeDecoded out;
  for (int axis = 0; axis < 3; ++axis)
    out.position[axis] =
        coding.lower[axis] + static_cast<float>(code[static_cast<std::size_t>(axis)] & 0xFFFFFu) * coding.step[axis];
  const std::uint32_t u = code[0] >> 20 & 1023u, v = code[1] >> 20 & 1023u;
  if (u != VolumeCoding::kNoNormal) {
    constexpr float half = 0.5f * static_cast<float>(VolumeCoding::kLargestNormal);
    glm::vec3 n(static_cast<float>(u) / half - 1, static_cast<float>(v) / half - 1, 0);
    n.z = 1 - std::abs(n.x) - std::abs(n.y);
    const float fold = std::max(-n.z, 0.0f);
    n.x += n.x >= 0 ? -fold : fold;
    n.y += n.y >= 0 ? -fold : fold;
    out.normal = n / std::sqrt(glm::dot(n, n));
  }
  const std::uint32_t weight = code[0] >> 30 | (code[1] >> 30) << 2 | (code[2] >> 20) << 4;
  out.weight = weight == 0 ? 0.0f : std::exp2(coding.weight.x + static_cast<float>(weight) * coding.weight.y);
  return out;
}

}  // namespace

TEST_CASE("stores positions, directions, weights, colours and classes of volumes") {
  qnv::Volume geometry = random_volume(3000, 2, 0.1f);
  for (std::size_t i = 0; i < geometry.size(); ++i)
    geometry.colors.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i / 7), 3});
  geometry.weights[5] = 0;
  geometry.normals[6] = glm::vec3(0);
  geometry.normals[7] = {kNaN, 0, 1};
  const VolumeCoding coding = volume_coding(geometry, geometry.size());
  std::vector<VolumeCode> codes(geometry.size());
  encode_volume_codes(geometry, coding, 0, codes);
  for (std::size_t k = 0; k < codes.size(); ++k) {
    const VolumeDecoded decoded = decode_volume_code(codes[k], coding);
    for (int axis = 0; axis < 3; ++axis)
      REQUIRE(std::abs(decoded.position[axis] - geometry.positions[k][axis]) <= 0.51f * coding.step[axis] + 1e-6f);
    REQUIRE(decoded.weight == Approx(geometry.weights[k]).epsilon(1e-4));
    REQUIRE(codes[k][3] >> 24 == geometry.classes[k]);
    REQUIRE((codes[k][3] & 255) == geometry.colors[k].r);
    REQUIRE((codes[k][3] >> 8 & 255) == geometry.colors[k].g);
    if (k == 6 || k == 7) {
      REQUIRE(decoded.normal == glm::vec3(0));
    } else {
      // Ten bits per octahedral axis give an error of a quarter of a degree.
      REQUIRE(glm::dot(decoded.normal, glm::normalize(geometry.normals[k])) > 0.99999f);
    }
  }
}

TEST_CASE("stores volumes without extent and with equal weights") {
  qnv::Volume geometry = empty_volume(0.5f, 1);
  for (int i = 0; i < 4; ++i) add(geometry, {1, 2, 3}, {0, 0, -1}, 2, 9);
  const VolumeCoding coding = volume_coding(geometry, 4);
  std::vector<VolumeCode> codes(4);
  encode_volume_codes(geometry, coding, 0, codes);
  const VolumeDecoded decoded = decode_volume_code(codes[3], coding);
  CHECK(decoded.position == glm::vec3(1, 2, 3));
  CHECK(decoded.weight == Approx(2));
  CHECK(decoded.normal.z == Approx(-1));
}

TEST_CASE("keeps volumes that are drawn, and removes others to make room") {
  VolumePicture picture;
  VolumeStore store(picture.gl, 1000 * VolumeStore::kBytes);
  const std::array<SharedVolume, 2> both{shared(300, 1), shared(400, 2)};
  const auto places = store.place(both);
  REQUIRE(places.size() == 2);
  CHECK((places[0].first >= places[1].first + 400 || places[1].first >= places[0].first + 300));
  store.forget_unused();
  const auto again = store.place(both);
  REQUIRE(again.size() == 2);
  CHECK(again[0].first == places[0].first);
  CHECK(again[1].first == places[1].first);
  // The next viewport has a third volume.
  const SharedVolume third = shared(250, 3);
  CHECK(store.place(std::span(&third, 1)).size() == 1);
  CHECK(store.bytes() <= 1000 * VolumeStore::kBytes);
  const SharedVolume large = shared(990, 4), larger = shared(1001, 5);
  CHECK(store.place(std::span(&large, 1)).size() == 1);
  CHECK(store.place(std::span(&larger, 1)).empty());
  CHECK(store.place({}).empty());
  // Two uses in one picture share storage.
  const std::array<SharedVolume, 2> twice{both[0], both[0]};
  const auto one = store.place(twice);
  REQUIRE(one.size() == 2);
  CHECK(one[0].first == one[1].first);
  // Many volumes are added and dropped.
  for (unsigned i = 0; i < 50; ++i) {
    store.forget_unused();
    const SharedVolume passing = shared(200, i);
    REQUIRE(store.place(std::span(&passing, 1)).size() == 1);
  }
  CHECK(picture.gl.GetError() == GL_NO_ERROR);
}
