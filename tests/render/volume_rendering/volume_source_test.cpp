#include "render/volume_rendering/volume_source.h"
#include "render/volume_rendering/voxel_fields.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>

// Tests of the code of volume styles, and of the numbers that the ray caster derives from volumes.
namespace gs::render::volume_source_test {
namespace {

using Kind = VolumeStep::Kind;

std::shared_ptr<const Image> image_of(std::uint32_t width, std::uint32_t rows, std::uint32_t slices,
                                      std::vector<std::uint8_t> pixels, std::uint32_t components = 1) {
  Image image{width, rows * slices, components, std::move(pixels)};
  image.slices = slices;
  return std::make_shared<const Image>(std::move(image));
}

VolumeStep step(Kind kind, std::vector<glm::vec4> values = {glm::vec4(0.5f)}) {
  VolumeStep made;
  made.kind = kind;
  made.values = std::move(values);
  return made;
}

VolumeLook look_of(std::vector<VolumeStep> steps) {
  VolumeLook look;
  look.voxels = image_of(2, 2, 2, std::vector<std::uint8_t>(8, 128));
  look.chains.push_back({std::move(steps), false});
  return look;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("gives each volume style its code, and uniforms by the number of its step") {
  const auto code = [](Kind kind) { return volume_source(look_of({step(kind, std::vector(3, glm::vec4(0.5f)))})); };
  CHECK(contains(code(Kind::opacity_map).code, "c = color_of(raw, 1);"));
  CHECK(contains(code(Kind::boundary).code, "values_0[0].y * pow(max(n.w"));
  CHECK(contains(code(Kind::edge).code, "mix(values_0[0].rgb, c.rgb, facing)"));
  CHECK(contains(code(Kind::silhouette).code, "pow(max(1.0 - facing"));
  CHECK(contains(code(Kind::cartoon).code, "#define COUNT_0 3"));
  CHECK(contains(code(Kind::tone).code, "toned(n.xyz"));
  CHECK(code(Kind::tone).lights);
  CHECK_FALSE(code(Kind::edge).lights);
  CHECK_FALSE(contains(code(Kind::opacity_map).defines, "GRADIENTS"));
  CHECK(contains(code(Kind::edge).defines, "#define GRADIENTS"));
}

TEST_CASE("shares the code of volumes with equal styles and other values") {
  const VolumeSource one = volume_source(look_of({step(Kind::edge), step(Kind::silhouette)})),
                     other = volume_source(look_of({step(Kind::edge, {glm::vec4(0)}), step(Kind::silhouette)})),
                     turned = volume_source(look_of({step(Kind::silhouette), step(Kind::edge)}));
  CHECK(one.code == other.code);
  CHECK(one.code != turned.code);
}

TEST_CASE("numbers the styles inside of a blend after it, and weighs both volumes (X3D Table 41.3)") {
  VolumeStep blend = step(Kind::blend);
  blend.voxels = image_of(1, 1, 1, {255});
  blend.weights = {VolumeStep::Weight::alpha_2, VolumeStep::Weight::one_minus_alpha_1};
  blend.inner = {step(Kind::silhouette)};
  const VolumeLook look = look_of({step(Kind::edge), blend, step(Kind::boundary)});
  const auto steps = numbered_steps(look);
  REQUIRE(steps.size() == 4);
  CHECK(steps[2]->kind == Kind::silhouette);
  CHECK(steps[3]->kind == Kind::boundary);
  const std::string code = volume_source(look).code;
  CHECK(contains(code, "w1 = d.a, w2 = 1.0 - c.a"));
  CHECK(contains(code, "normal_at(gradients_1, p)"));
  CHECK(contains(code, "uniform sampler3D gradients_1"));
}

TEST_CASE("turns volumes upright, and finds their gradients and empty blocks") {
  // Two rows: the upper one, the first of an Image, is 200.
  std::array<std::uint32_t, 3> size{};
  const auto rows = image_of(1, 2, 1, {200, 100});
  CHECK(upright_voxels(*rows, 2048, size) == std::vector<std::uint8_t>{100, 200});
  CHECK(size == std::array<std::uint32_t, 3>{1, 2, 1});

  std::vector<std::uint8_t> voxels(32 * 16 * 8, 0);
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (i % 32 >= 20) voxels[i] = 100;
  const std::array<std::uint32_t, 3> sides{32, 16, 8};
  const auto gradients = voxel_gradients(voxels, sides, 1);
  const auto at = [&](std::size_t x) { return gradients.data() + (4 * 32 * 16 + 8 * 32 + x) * 4; };
  CHECK(at(20)[0] == 255);  // towards larger x
  CHECK(std::abs(int{at(20)[1]} - 127) <= 1);
  CHECK(int{at(20)[3]} == Approx(50 / 0.866).margin(1));  // 50 per voxel
  CHECK(int{at(4)[3]} == 0);

  VolumeLook look = look_of({step(Kind::opacity_map)});
  look.voxels = image_of(32, 16, 8, voxels);
  const VoxelRanges ranges = voxel_ranges(voxels, sides, 1);
  CHECK(ranges.blocks == std::array<std::uint32_t, 3>{4, 2, 1});
  CHECK(occupied_blocks(ranges, look) == std::vector<std::uint8_t>{0, 0, 255, 255, 0, 0, 255, 255});
  // A transfer function that shows only small values.
  look.chains[0].steps[0].tables[0] = image_of(4, 1, 1, {9, 255, 9, 0, 9, 0, 9, 0}, 2);
  CHECK(occupied_blocks(ranges, look) == std::vector<std::uint8_t>{255, 255, 255, 0, 255, 255, 255, 0});
  look.chains[0].steps[0].tables[0] = image_of(4, 1, 1, {9, 0, 9, 0, 9, 0, 9, 255}, 2);
  CHECK(occupied_blocks(ranges, look) == std::vector<std::uint8_t>(8, 0));
  look.iso_surfaces = true;
  look.surfaces = {0.2f};
  CHECK(occupied_blocks(ranges, look) == std::vector<std::uint8_t>{0, 0, 255, 0, 0, 0, 255, 0});
}

}  // namespace gs::render::volume_source_test
