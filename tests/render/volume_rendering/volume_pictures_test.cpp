// Pictures of volumes of X3D, compared with the equations of the standard (clause 41).

#include "tests/render/drawing.h"
#include "tests/render/volume_rendering/volume_texts.h"
#include "tests/render/x3d_scene.h"

#include <catch2/catch.hpp>
#include <glm/gtc/constants.hpp>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gs::render::volume_pictures_test {

using namespace gs::render::testing;

namespace {

/// Volume of equal values, in a box of 2 metres.
std::string even_volume(int value, int side = 2) {
  return "dimensions 2 2 2 voxels " + pixel_volume({side, side, side}, [&](double, double, double) { return value; }) +
         " ";
}

/// Slices of these values from front to back, seen from +Z.
std::string sliced_volume(const std::vector<int>& values) {
  const int count = static_cast<int>(values.size());
  return "dimensions 2 2 2 voxels " +
         pixel_volume({1, 1, count},
                      [&](double, double, double z) {
                        return values[static_cast<std::size_t>(count - 1 - static_cast<int>(z * count))];
                      }) +
         " ";
}

/// Isosurface at half of a ramp along Z; `turn` turns it about the Y axis. Its normal is +Z before.
std::string surface(const std::string& style, double turn = 0) {
  return "Transform { rotation 0 1 0 " + std::to_string(turn) +
         " children IsoSurfaceVolumeData { dimensions 3 3 1 surfaceValues 0.5 voxels " + ramp_volume() +
         " renderStyle " + style + " } }";
}

struct Pictures {
  Drawing drawing;
  Image draw(const std::string& body, const glm::vec3& eye = {0, 0, 6}) {
    const auto scene = x3d_scene(body);
    MeshCache meshes;
    return drawing.draw(collect(*scene, {}, meshes), camera_at(eye));
  }
  glm::vec3 middle(const std::string& body, const glm::vec3& eye = {0, 0, 6}) { return pixel(draw(body, eye), 32, 32); }
};

}  // namespace

TEST_CASE("casts shadows of voxels on others if a ShadedVolumeStyle asks for them (X3D 41.4.10)") {
  Pictures pictures;
  pictures.drawing.options.headlight = false;
  // A slab above a block; the light comes from above and from the viewer.
  const std::string voxels = pixel_volume({8, 32, 32}, [](double, double y, double z) {
    return y > 0.8 ? 255 : y < 0.4 && z < 0.7 ? 255 : 0;
  });
  const auto picture = [&](const std::string& style) {
    return pictures.draw(
        "NavigationInfo { headlight FALSE } DirectionalLight { direction 0 -1 -0.3 ambientIntensity 0.2 } "
        "VolumeData { dimensions 2 2 2 voxels " +
        voxels + " renderStyle " + style + " }");
  };
  const std::string shaded =
      "ShadedVolumeStyle { lighting TRUE material Material { diffuseColor 1 1 1 ambientIntensity 0.1 } shadows ";
  const Image plain = picture(shaded + "FALSE }"), shadowed = picture(shaded + "TRUE }");
  const auto mean = [](const Image& image, std::uint32_t first, std::uint32_t last) {
    double sum = 0;
    for (std::uint32_t y = first; y < last; ++y)
      for (std::uint32_t x = 28; x < 36; ++x) sum += pixel(image, x, y).x;
    return sum / (8.0 * (last - first));
  };
  // Rows of the front of the block, and of the slab.
  CHECK(mean(plain, 37, 45) > 20);
  CHECK(mean(shadowed, 37, 45) < 0.5 * mean(plain, 37, 45));
  CHECK(mean(shadowed, 20, 24) > 0.8 * mean(plain, 20, 24));
}

TEST_CASE("integrates the opacity of voxels along rays, per voxel (X3D 41.4.7)") {
  Pictures pictures;
  // Default: grey and opacity are the value. Two voxels of opacity a have 1 - (1 - a)^2.
  const float v = 128 / 255.0f, two = 1 - (1 - v) * (1 - v);
  check_color(pictures.middle("VolumeData { " + even_volume(128) + "}"), glm::vec3(v * two), 2);
  // The table maps the value 1 to red with opacity 1, and 0 to nothing.
  const std::string table =
      "renderStyle OpacityMapVolumeStyle { transferFunction PixelTexture { image 2 1 4 "
      "0x00000000 0xFF0000FF } }";
  check_color(pictures.middle("VolumeData { " + even_volume(255) + table + "}"), {1, 0, 0});
  check_color(pictures.middle("VolumeData { " + even_volume(0) + table + "}"), glm::vec3(0));
  check_color(pictures.middle("Background { skyColor 0 1 0 } VolumeData { " + even_volume(0) + "}"), {0, 1, 0});
}

TEST_CASE("reads a transfer function in three dimensions by the colours of voxels") {
  Pictures pictures;
  const std::string colored =
      "VolumeData { dimensions 2 2 2 voxels PixelTexture3D { image [ 3 1 1 1 0xFF0000 ] } "
      "renderStyle OpacityMapVolumeStyle { transferFunction PixelTexture3D { image "
      "[ 3 2 1 1 0x0000FF 0x00FF00 ] } } }";
  check_color(pictures.middle(colored), {0, 1, 0});
}

TEST_CASE("projects the largest, smallest and mean value of each ray (X3D 41.4.8)") {
  Pictures pictures;
  const auto projected = [&](const std::vector<int>& values, const std::string& fields) {
    return pictures.middle("Background { skyColor 1 0 0 } VolumeData { " + sliced_volume(values) +
                           "renderStyle ProjectionVolumeStyle { " + fields + " } }");
  };
  const std::vector<int> values = {0, 0, 128, 128, 128, 0, 255};
  check_color(projected(values, ""), glm::vec3(1));
  check_color(projected(values, "type \"MIN\""), glm::vec3(0));
  check_color(projected(values, "type \"AVERAGE\""), glm::vec3(639 / 7.0f / 255), 2);
  // The first local maximum above the threshold.
  check_color(projected(values, "intensityThreshold 0.3"), glm::vec3(128 / 255.0f), 2);
  check_color(projected(values, "intensityThreshold 0.7"), glm::vec3(1));
}

TEST_CASE("colours projected values by a table with opacities") {
  Drawing drawing;
  const auto projected = [&](int value, std::vector<std::uint8_t> colors) {
    const auto scene = x3d_scene("Background { skyColor 0 0 1 } VolumeData { " + even_volume(value) +
                                 "renderStyle ProjectionVolumeStyle { } }");
    MeshCache meshes;
    RenderList list = collect(*scene, {}, meshes);
    REQUIRE(list.items.size() == 1);
    auto look = std::make_shared<VolumeLook>(*list.items[0].volume);
    look->projection_colors = std::make_shared<const Image>(Image{2, 1, 4, std::move(colors)});
    list.items[0].volume = look;
    return pixel(drawing.draw(list, camera_at({0, 0, 6})), 32, 32);
  };
  check_color(projected(0, {255, 0, 0, 255, 0, 255, 0, 255}), {1, 0, 0});
  check_color(projected(255, {255, 0, 0, 255, 0, 255, 0, 255}), {0, 1, 0});
  check_color(projected(255, {255, 0, 0, 255, 255, 0, 0, 128}), {128 / 255.0f, 0, 127 / 255.0f}, 2);
  check_color(projected(0, {255, 0, 0, 0, 0, 255, 0, 255}), {0, 0, 1});
}

TEST_CASE("draws the silhouette of an isosurface where the analytic ball has it") {
  Pictures pictures;
  // The value 0.4 lies at the radius 0.3 of a box of 4 metres: 1.2 metres.
  const Image image =
      pictures.draw("IsoSurfaceVolumeData { dimensions 4 4 4 surfaceValues 0.4 voxels " + ball_volume(32) + " }");
  int covered = 0;
  for (std::uint32_t y = 0; y < 64; ++y)
    for (std::uint32_t x = 0; x < 64; ++x) covered += pixel(image, x, y).x > 0 ? 1 : 0;
  const double tangent = 1.2 / std::sqrt(36 - 1.44), radius = tangent / std::tan(0.785398 / 2) * 32;
  CHECK(covered == Approx(glm::pi<double>() * radius * radius).epsilon(0.06));
}

TEST_CASE("colours surfaces by each style as the equations of X3D 41.4 say") {
  Pictures pictures;
  constexpr double kTurn = 1.0471976;  // the cosine is 0.5
  check_color(pictures.middle(surface("CartoonVolumeStyle { orthogonalColor 1 0 0 1 parallelColor 0 0 1 1 }")),
              {1, 0, 0});
  check_color(pictures.middle(surface("CartoonVolumeStyle { colorSteps 3 }", kTurn * 0.75)), glm::vec3(0.5f), 3);
  check_color(pictures.middle(surface("CartoonVolumeStyle { colorSteps 3 }", 3.1415927)), glm::vec3(0));
  const std::string lit = "ShadedVolumeStyle { lighting TRUE material Material { diffuseColor 1 0.5 0 } }";
  check_color(pictures.middle(surface(lit)), {1, 0.5f, 0}, 2);
  check_color(pictures.middle(surface(lit, kTurn)), {0.5f, 0.25f, 0}, 6);
  check_color(pictures.middle(surface("ShadedVolumeStyle { material Material { diffuseColor 0 1 0 } }", kTurn)),
              {0, 1, 0});
  check_color(
      pictures.middle(surface("ShadedVolumeStyle { material Material { diffuseColor 0 1 0 transparency 0.5 } }")),
      {0, 0.5f, 0});
  // The headlight: the warm colour for normals towards it.
  check_color(pictures.middle(surface("ToneMappedVolumeStyle { }")), {1, 1, 0}, 2);
  check_color(pictures.middle(surface("ToneMappedVolumeStyle { }", kTurn)), {0.75f, 0.75f, 0.25f}, 6);
  // Without other styles, the surface has the grey of its value.
  check_color(pictures.middle(surface("EdgeEnhancementVolumeStyle { edgeColor 1 0 0 1 }")), glm::vec3(0.5f), 2);
  check_color(pictures.middle(surface("EdgeEnhancementVolumeStyle { edgeColor 1 0 0 1 }", kTurn)),
              {0.75f, 0.25f, 0.25f}, 6);
  const std::string silhouette =
      "SilhouetteEnhancementVolumeStyle { silhouetteRetainedOpacity 0.2 "
      "silhouetteBoundaryOpacity 0.8 silhouetteSharpness 2 }";
  check_color(pictures.middle(surface(silhouette)), glm::vec3(0.1f), 2);
  check_color(pictures.middle(surface(silhouette, kTurn)), glm::vec3(0.2f), 4);  // 0.2 + 0.8 / 4
  // The ramp has 1/32 per voxel.
  check_color(pictures.middle(surface("BoundaryEnhancementVolumeStyle { retainedOpacity 0.25 boundaryOpacity 16 "
                                      "opacityFactor 1 }")),
              glm::vec3(0.5f * (0.25f + 0.5f)), 6);
}

TEST_CASE("takes the normals of surfaceNormals and gradients instead of its own (X3D 41.4)") {
  Pictures pictures;
  // Normals along +X, which are orthogonal to the view.
  const std::string normals = "PixelTexture3D { image [ 3 1 1 1 0xFF8080 ] }";
  check_color(pictures.middle(surface("CartoonVolumeStyle { parallelColor 0 0 1 1 surfaceNormals " + normals + " }"),
                              {-0.3f, 0, 6}),
              glm::vec3(0), 1);
  const auto along = [&](const std::string& field) {
    return "IsoSurfaceVolumeData { dimensions 3 3 1 surfaceValues 0.5 voxels " + ramp_volume() + field +
           " renderStyle EdgeEnhancementVolumeStyle { edgeColor 1 0 0 1 } }";
  };
  check_color(pictures.middle(along("")), glm::vec3(0.5f), 2);
  check_color(pictures.middle(along(" gradients " + normals)), {1, 0, 0}, 6);
}

TEST_CASE("blends two volumes by weight functions (X3D 41.4.1)") {
  Pictures pictures;
  const std::string second = "voxels PixelTexture3D { image [ 1 1 1 1 255 ] } ";
  const auto blended = [&](const std::string& fields) {
    return pictures.middle(
        "VolumeData { dimensions 2 2 2 voxels PixelTexture3D { image [ 1 1 1 1 128 ] } renderStyle "
        "BlendedVolumeStyle { " +
        second + fields + " } }");
  };
  // One voxel: the colour times the opacity. Both volumes are grey and as opaque as their values.
  const auto square = [](float v) { return glm::vec3(v * v); };
  check_color(blended(""), square(0.5f * 0.502f + 0.5f), 3);
  check_color(blended("weightConstant1 1 weightConstant2 0"), square(0.502f), 2);
  check_color(blended("weightFunction1 \"ALPHA1\" weightConstant2 0"), square(0.502f * 0.502f), 2);
  check_color(blended("weightConstant1 0 weightFunction2 \"ONE_MINUS_ALPHA1\""), square(0.498f), 2);
  check_color(blended("weightConstant1 0 weightFunction2 \"ALPHA2\""), glm::vec3(1), 2);
  check_color(blended("weightConstant1 0 weightFunction2 \"TABLE\" weightTransferFunction2 PixelTexture { image 1 1 1 "
                      "0x80 }"),
              square(0.502f), 2);
}

TEST_CASE("draws each segment with its style, and omits disabled ones (X3D 41.4.9)") {
  Pictures pictures;
  const auto drawn = [&](const std::string& segment, const std::string& fields) {
    return pictures.middle(
        "SegmentedVolumeData { dimensions 2 2 2 voxels PixelTexture3D { image [ 1 1 1 1 255 ] } "
        "segmentIdentifiers PixelTexture3D { image [ 1 " +
        segment +
        " ] } renderStyle "
        "[ OpacityMapVolumeStyle { } ShadedVolumeStyle { material Material { diffuseColor 1 0 0 } } ] " +
        fields + " }");
  };
  check_color(drawn("1 1 1 0", ""), glm::vec3(1));
  check_color(drawn("1 1 1 1", ""), {1, 0, 0});
  check_color(drawn("1 1 1 9", ""), glm::vec3(1));
  check_color(drawn("1 1 1 1", "segmentEnabled [ TRUE FALSE ]"), glm::vec3(0));
  // Identifiers of another size are ignored.
  check_color(drawn("1 1 2 1 1", "segmentEnabled [ TRUE FALSE ]"), glm::vec3(1));
}

TEST_CASE("draws equal pictures of a PixelTexture3D and a ComposedTexture3D") {
  Pictures pictures;
  std::string slices, words = "PixelTexture3D { image [ 1 3 2 4 ";
  for (int z = 0; z < 4; ++z) {
    slices += "PixelTexture { image 3 2 1 ";
    for (int i = 0; i < 6; ++i) {
      const std::string value = std::to_string(z * 60 + i * 9);
      words += value + " ";
      slices += value + " ";
    }
    slices += "} ";
  }
  const glm::vec3 eye(0.5f, 0.3f, 4);
  const Image one = pictures.draw("VolumeData { dimensions 2 2 2 voxels " + words + "] } }", eye),
              other = pictures.draw(
                  "VolumeData { dimensions 2 2 2 voxels ComposedTexture3D { texture [ " + slices + "] } }", eye);
  CHECK(one.pixels == other.pixels);
  CHECK(pixel(one, 32, 32).x > 20);
}

TEST_CASE("ends rays at opaque objects, and blends volumes among transparent ones") {
  Pictures pictures;
  const auto wall = [](double z, double transparency) {
    return "Transform { translation 0 0 " + std::to_string(z) +
           " children Shape { appearance Appearance { material UnlitMaterial { emissiveColor 1 0 0 transparency " +
           std::to_string(transparency) + " } } geometry Rectangle2D { size 8 8 } } } ";
  };
  const std::string volume = "VolumeData { " + even_volume(128) + "} ";
  const float v = 128 / 255.0f, two = 1 - (1 - v) * (1 - v);
  check_color(pictures.middle(wall(2, 0) + volume), {1, 0, 0});
  check_color(pictures.middle(wall(0, 0) + volume), {v * v + 1 - v, v * v, v * v}, 2);  // one voxel before it
  check_color(pictures.middle(wall(-2, 0) + volume), {v * two + 1 - two, v * two, v * two}, 2);
  const float grey = v * two;
  check_color(pictures.middle(wall(2, 0.5) + volume), {0.5f + 0.5f * grey, 0.5f * grey, 0.5f * grey}, 2);
  check_color(pictures.middle(volume + wall(2, 0.5)), {0.5f + 0.5f * grey, 0.5f * grey, 0.5f * grey}, 2);
  check_color(pictures.middle(wall(-2, 0.5) + volume), {grey + 0.5f * (1 - two), grey, grey}, 2);
  pictures.drawing.options.samples = 4;
  check_color(pictures.middle(wall(0, 0) + volume), {v * v + 1 - v, v * v, v * v}, 2);
}

TEST_CASE("draws a volume around the viewer, a mirrored one, and its part behind a ClipPlane") {
  Pictures pictures;
  const float v = 128 / 255.0f;
  // One voxel is ahead of the viewer in the middle of the box.
  check_color(pictures.middle("VolumeData { " + even_volume(128) + "}", {0, 0, 0}), glm::vec3(v * v), 4);
  check_color(pictures.middle("Transform { scale -1 1 1 children VolumeData { " + even_volume(128) + "} }"),
              glm::vec3(v * (1 - (1 - v) * (1 - v))), 2);
  check_color(
      pictures.middle("Group { children [ ClipPlane { plane 0 0 -1 0 } VolumeData { " + even_volume(128) + "} ] }"),
      glm::vec3(v * v), 2);
  // The first slice of a volume lies at -Z, its first row at -Y.
  const Image image =
      pictures.draw("VolumeData { dimensions 2 2 2 voxels PixelTexture3D { image [ 1 1 2 1 255 0 ] } }");
  CHECK(pixel(image, 32, 40).x > 200);
  CHECK(pixel(image, 32, 24).x < 50);
}

TEST_CASE("draws a volume in bands that can be cancelled") {
  Pictures pictures;
  const auto scene = x3d_scene("VolumeData { " + even_volume(255) + "}");
  MeshCache meshes;
  const RenderList list = collect(*scene, {}, meshes);
  pictures.drawing.options.height = 200;
  int calls = 0;
  pictures.drawing.options.go_on = [&] { return ++calls > 0; };
  check_color(pixel(pictures.drawing.draw(list, camera_at({0, 0, 6})), 32, 100), glm::vec3(1));
  CHECK(calls >= 4);
  CHECK_FALSE(pictures.drawing.statistics.given_up);
  pictures.drawing.options.go_on = [] { return false; };
  (void)pictures.drawing.draw(list, camera_at({0, 0, 6}));
  CHECK(pictures.drawing.statistics.given_up);
}

TEST_CASE("draws volumes in the part of a picture that a layer fills") {
  Pictures pictures;
  const auto scene = x3d_scene("VolumeData { " + even_volume(128) + "} Shape { geometry Sphere { radius 0.3 } }");
  MeshCache meshes;
  RenderList list = collect(*scene, {}, meshes);
  list.boundary = {0.5f, 1, 0.5f, 1};
  const Image image = pictures.drawing.draw(list, camera_at({0, 0, 6}));
  const float v = 128 / 255.0f;
  // The middle of the part shows the white ball behind 0.7 voxels.
  const float seen = 1 - std::pow(1 - v, 0.7f);
  check_color(pixel(image, 48, 16), glm::vec3(v * seen + 1 - seen), 4);
  check_color(pixel(image, 16, 48), glm::vec3(0));
}

TEST_CASE("hides volumes in fog, and changes the picture with the style") {
  Pictures pictures;
  check_color(pictures.middle("Fog { color 0 1 0 visibilityRange 2 } VolumeData { " + even_volume(255) + "}"),
              {0, 1, 0}, 2);
  const Image all = pictures.draw("VolumeData { dimensions 3 3 3 voxels " + ball_volume(16) + " }"),
              edges = pictures.draw("VolumeData { dimensions 3 3 3 voxels " + ball_volume(16) +
                                    " renderStyle EdgeEnhancementVolumeStyle { edgeColor 1 0 0 1 } }");
  CHECK(all.pixels != edges.pixels);
}

}  // namespace gs::render::volume_pictures_test
