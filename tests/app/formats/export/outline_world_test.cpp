// Tests of models as outline groups, from the model to the picture.
#include "app/encode/outline_model.h"
#include "app/formats/export/outline_text.h"
#include "app/formats/qnv/outline_scene.h"
#include "app/loading/world_loading.h"
#include "qnv/codecs/outlines/outline_stream.h"
#include "render/draw/renderer.h"
#include "render/gl/context.h"
#include "render/scene/camera.h"
#include "tests/app/formats_helpers.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"
#include "tests/watched.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <variant>
#include <vector>

using namespace gs;
using namespace gs::app;
using test::string_of;

namespace {

/// A ball on a plate with a hole, in two appearances: curved and flat.
const std::string kModel = R"(#VRML V2.0 utf8
WorldInfo { title "ball on a plate" }
Shape { appearance Appearance { material Material { diffuseColor 1 .5 0 specularColor .2 .2 .2 shininess .4 } }
  geometry Sphere { radius 1 } }
Transform { translation 0 -1.5 0 children Shape {
  appearance Appearance { material Material { diffuseColor .2 .4 .8 transparency .25 } }
  geometry Extrusion { crossSection [ -2 -2, -2 2, 2 2, 2 -2, -2 -2 ] spine [ 0 0 0, 0 .5 0 ] } } }
)";

struct Encoded {
  OutlineModel model;
  qnv::OutlineGroups groups;
  double area = 0;
};

double area_of(const render::RenderList& list) {
  double sum = 0;
  for (const render::DrawItem& item : list.items)
    for (std::size_t i = 0; i + 2 < item.mesh->indices.size(); i += 3) {
      glm::vec3 p[3];
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = glm::vec3(item.world_from_node * glm::vec4(item.mesh->positions[item.mesh->indices[i + k]], 1));
      const glm::vec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
      sum += std::sqrt(glm::dot(n, n)) / 2;
    }
  return sum;
}

render::RenderList collected(const LoadedWorld& world) {
  REQUIRE(world.scene);
  render::MeshCache meshes;
  return render::collect(*world.scene, world.images, meshes);
}

Encoded encoded(const std::string& path, double tolerance = 0.05) {
  const LoadedWorld world = load_world(path);
  const render::RenderList list = collected(world);
  Encoded result{outline_model(list, texture_urls(world)), {}, area_of(list)};
  qnv::OutlineOptions options;
  options.tolerance = options.outline_tolerance = tolerance;
  auto grouped = qnv::group_outlines(result.model.model, options);
  REQUIRE(std::holds_alternative<qnv::OutlineGroups>(grouped));
  result.groups = std::move(std::get<qnv::OutlineGroups>(grouped));
  return result;
}

std::string outline_stream_of(const Encoded& from, int bits = 16) {
  qnv::OutlineEncodeOptions options;
  options.position_bits = bits;
  const auto made = qnv::encode_outlines(from.groups, from.model.appearances, options);
  REQUIRE(std::holds_alternative<qnv::EncodedStream>(made));
  return string_of(std::get<qnv::EncodedStream>(made).bytes);
}

/// Studio that draws without a window.
class OutlineStudio {
 public:
  OutlineStudio() {
    auto opened = render::open_headless_context("auto");
    if (auto* context = std::get_if<std::unique_ptr<render::GlContext>>(&opened)) context_ = std::move(*context);
    if (!context_) return;
    auto created = render::Renderer::create(*context_);
    if (auto* renderer = std::get_if<std::unique_ptr<render::Renderer>>(&created)) renderer_ = std::move(*renderer);
  }
  [[nodiscard]] bool good() const { return renderer_ != nullptr; }
  render::Image picture(const render::RenderList& list, const WideBox& bounds, float azimuth, float elevation) {
    render::DrawOptions draw;
    draw.width = 320;
    draw.height = 240;
    draw.background = glm::vec3(0);
    const auto camera = render::fit_depth(
        render::orbit_camera(bounds, glm::radians(azimuth), glm::radians(elevation), 0.785398f, 320, 240), bounds);
    auto drawn = renderer_->draw_to_image(list, camera, draw);
    REQUIRE(std::holds_alternative<render::Image>(drawn));
    return std::move(std::get<render::Image>(drawn));
  }

 private:
  std::unique_ptr<render::GlContext> context_;
  std::unique_ptr<render::Renderer> renderer_;
};

/// Hides back faces. Otherwise rounding decides at each pixel whether the front or the back of a closed part is visible
/// where they meet.
void show_fronts(render::RenderList& list) {
  for (render::DrawItem& item : list.items) {
    vrml::Mesh mesh = *item.mesh;
    mesh.solid = true;
    item.mesh = std::make_shared<const vrml::Mesh>(std::move(mesh));
  }
}

std::size_t different_pixels(const render::Image& a, const render::Image& b, int most = 0) {
  REQUIRE(a.pixels.size() == b.pixels.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.pixels.size(); i += a.components) {
    int worst = 0;
    for (std::size_t k = 0; k < a.components; ++k) worst = std::max(worst, std::abs(a.pixels[i + k] - b.pixels[i + k]));
    different += worst > most ? 1 : 0;
  }
  return different;
}

}  // namespace

TEST_CASE("keeps appearance, area and shading of a model as outline groups, as text and as stream") {
  const ScratchFolder folder;
  const Encoded made = encoded(folder.write("model.wrl", kModel));
  REQUIRE(made.model.appearances.size() == 2);
  const qnv::OutlineAppearance& ball = made.model.appearances[0];
  CHECK(ball.diffuse == qnv::Rgb8{255, 128, 0});
  CHECK(ball.shininess == 102);
  CHECK(ball.crease_angle > 0.2f);  // of 32 segments, smoothed
  CHECK(made.model.appearances[1].transparency == 64);
  CHECK(made.model.appearances[1].crease_angle == 0);
  CHECK(made.groups.groups.size() < 80);

  const std::string text =
      folder.write("outlines.wrl", string_of(outline_world(made.groups, made.model.appearances, "x")));
  const std::string stream = folder.write("outlines.qnv", outline_stream_of(made, 20));
  for (const std::string& path : {text, stream}) {
    INFO(path);
    const LoadedWorld world = load_world(path);
    for (const auto& diagnostic : world.diagnostics.entries()) FAIL(diagnostic.text());
    const render::RenderList list = collected(world);
    CHECK(area_of(list) == Approx(made.area).epsilon(1e-4));
    std::size_t filled = 0;
    for (const render::DrawItem& item : list.items) {
      if (item.mesh->indices.empty()) continue;
      ++filled;
      const bool is_ball = item.material.diffuse.x > 0.9f;
      CHECK(item.material.transparency == Approx(is_ball ? 0 : 0.25f).margin(0.003));
      CHECK(item.mesh->solid);
      // A ball's normals point away from its centre.
      for (std::size_t k = 0; is_ball && k < item.mesh->indices.size(); ++k) {
        const std::uint32_t i = item.mesh->indices[k];
        REQUIRE(glm::dot(item.mesh->normals[i], item.mesh->positions[i]) > 0.97f);
      }
    }
    CHECK(filled >= 2);
  }
}

TEST_CASE("shows the groups of every prefix of an outline stream, with ever better area") {
  const ScratchFolder folder;
  const Encoded made = encoded(folder.write("model.wrl", kModel));
  const std::string stream = outline_stream_of(made), path = folder.write("outlines.qnv", stream);
  double outlines = 0;  // visible area with all outlines
  for (const qnv::OutlineGroup& group : made.groups.groups)
    for (std::size_t i = 0; i < group.outline.size(); ++i) outlines += group.outline[i].area;
  const std::size_t kPiece = 97 * watched_step(3);
  double last = 0;
  for (std::size_t bytes = 200; bytes <= stream.size() + kPiece; bytes += kPiece) {
    LoadOptions options;
    options.max_bytes = bytes;
    const LoadedWorld world = load_world(path, options);
    if (!world.scene) continue;
    const double area = area_of(collected(world));
    INFO(bytes);
    REQUIRE(area >= last * 0.97);  // an outline is slightly smaller or larger than its polygons
    last = area;
  }
  CHECK(last == Approx(made.area).epsilon(1e-3));
  CHECK(outlines == Approx(made.area).epsilon(0.1));
}

TEST_CASE("loads an outline stream by the url of an OutlineGroup, and rejects it in a QNV node") {
  const ScratchFolder folder;
  const Encoded made = encoded(folder.write("model.wrl", kModel));
  (void)folder.write("outlines.qnv", outline_stream_of(made));
  const std::string world =
      folder.write("world.wrl",
                   "#VRML V2.0 utf8\nShape { appearance Appearance { material Material { diffuseColor 0 1 0 } } "
                   "geometry OutlineGroup { url [ \"none.qnv\" \"outlines.qnv\" ] solid FALSE } }\n"
                   "Shape { geometry QNV { url \"outlines.qnv\" } }\n");
  const LoadedWorld opened = load_world(world);
  const render::RenderList list = collected(opened);
  CHECK(area_of(list) == Approx(made.area).epsilon(1e-3));
  CHECK(list.items.front().material.diffuse == glm::vec3(0, 1, 0));
  CHECK(list.splats.empty());
  REQUIRE(opened.diagnostics.entries().size() == 1);
  CHECK(opened.diagnostics.entries()[0].message.find("or an OutlineGroup for outlines") != std::string::npos);
}

TEST_CASE("shows the remaining polygons by the fallback of an outline world") {
  const ScratchFolder folder;
  const Encoded made = encoded(folder.write("model.wrl", kModel));
  std::string text = string_of(outline_world(made.groups, made.model.appearances, "x"));
  // Another browser has no such node type, and uses the PROTO.
  for (std::size_t at = 0; (at = text.find("OutlineGroup", at)) != std::string::npos; at += 5)
    text.replace(at, std::string("OutlineGroup").size(), "Other");
  const LoadedWorld world = load_world(folder.write("other.wrl", text));
  for (const auto& diagnostic : world.diagnostics.entries()) FAIL(diagnostic.text());
  CHECK(area_of(collected(world)) == Approx(made.area).epsilon(1e-4));
}

TEST_CASE("changes no more than a pixel of flat-shaded CAD parts by merging coplanar polygons", "[optimised]") {
  OutlineStudio studio;
  if (!studio.good()) {
    WARN("nothing can be drawn here; not tested");
    return;
  }
  const std::string data = GHOSTSPACE_TESTS "/../../shared/data/meshes/cad/";
  for (const char* part : {"featuretype.STL", "42400-IDGH.stl", "ADIS16480.STL", "gears.stl"}) {
    if (!std::filesystem::exists(data + part)) {
      WARN("without " << part << " this is not tested");
      continue;
    }
    INFO(part);
    const LoadedWorld world = load_world(data + part);
    render::RenderList list = collected(world);
    const Encoded made = encoded(data + part, 0);
    std::size_t inner = 0;
    for (const qnv::OutlineGroup& group : made.groups.groups)
      inner += std::max(group.inner.size(), group.outline.size());
    CHECK(inner < made.groups.counts.polygons);
    vrml::SceneGraph scene("outlines.wrl");
    Diagnostics diagnostics;
    REQUIRE(vrml::parse(string_of(outline_world(made.groups, made.model.appearances, "")), scene, diagnostics) ==
            vrml::ParseOutcome::complete);
    render::MeshCache meshes;
    render::RenderList merged = render::collect(scene, {}, meshes);
    show_fronts(list);
    show_fronts(merged);
    CHECK(area_of(merged) == Approx(made.area).epsilon(1e-5));
    for (int orbit = 0; orbit < 20; ++orbit) {
      const float azimuth = 18.0f * static_cast<float>(orbit), elevation = 12.0f * static_cast<float>(orbit % 7) - 36;
      // Rounding decides for samples on an edge, because the edges have other corners.
      CHECK(different_pixels(studio.picture(list, list.bounds, azimuth, elevation),
                             studio.picture(merged, list.bounds, azimuth, elevation)) <= 1);
    }
  }
}

TEST_CASE("derives creaseAngle from normals") {
  const auto of = [](const std::string& geometry) {
    vrml::SceneGraph scene("a.wrl");
    Diagnostics diagnostics;
    REQUIRE(vrml::parse("#VRML V2.0 utf8\nShape { geometry " + geometry + " }\n", scene, diagnostics) ==
            vrml::ParseOutcome::complete);
    render::MeshCache meshes;
    return crease_angle_of(*render::collect(scene, {}, meshes).items.at(0).mesh);
  };
  CHECK(of("Box { }") == 0);
  CHECK(of("Sphere { }") > 3);
  const float cylinder = of("Cylinder { }");  // sides of 11 degrees, edges of 90
  CHECK(cylinder > 0.2f);
  CHECK(cylinder < 1.57f);
  const std::string roof =
      "IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 .5, 0 1 .5, 1 2 0, 0 2 0 ] } "
      "coordIndex [ 0 1 2 3 -1 3 2 4 5 -1 ] creaseAngle ";
  CHECK(of(roof + "0 }") == 0);
  CHECK(of(roof + "3 }") > 0.92f);  // the slopes meet at 53 degrees
}

TEST_CASE("encode --outlines writes worlds and streams, and reports its result") {
  const ScratchFolder folder;
  const std::string in = folder.write("model.wrl", kModel);
  for (const char* name : {"out.wrl", "out.wrz", "out.qnv"}) {
    INFO(name);
    const std::string out = folder.path(name);
    const Run made = run("encode --outlines " + quoted(in) + " " + quoted(out));
    CHECK(made.status == 0);
    CHECK(made.output.find("outlines of") != std::string::npos);
    CHECK(run("check " + quoted(out)).status == (std::string(name) == "out.qnv" ? 0 : 0));
    CHECK(run("info " + quoted(out)).status == 0);
    CHECK(run("--snapshot " + quoted(folder.path("out.png")) + " --size 80x60 " + quoted(out)).status == 0);
  }
  // The stream as a world for all browsers.
  CHECK(run("export --vrml97 " + quoted(folder.path("out.qnv")) + " " + quoted(folder.path("back.wrl"))).status == 0);
  CHECK(run("check " + quoted(folder.path("back.wrl"))).status == 0);
  CHECK(folder.read("back.wrl").find("PROTO OutlineGroup") != std::string::npos);
  CHECK(area_of(collected(load_world(folder.path("back.wrl")))) ==
        Approx(area_of(collected(load_world(folder.path("out.qnv"))))).epsilon(1e-5));
  CHECK(run("info " + quoted(folder.path("out.qnv"))).output.find("inner polygons") != std::string::npos);
  CHECK(folder.read("out.wrl").starts_with("#VRML V2.0 utf8"));
  CHECK(folder.read("out.wrz").starts_with("\x1f\x8b"));
  CHECK(folder.read("out.wrz").size() < folder.read("out.wrl").size() / 2);
  CHECK(run("encode --outlines --packed " + quoted(in) + " " + quoted(folder.path("a.qnv"))).status == 2);
  CHECK(run("encode --outlines " + quoted(in) + " " + quoted(folder.path("a.ply"))).status == 2);
  const Run volume = run("encode --outlines --dims 2x2x2 --type u8 " + quoted(in) + " " + quoted(folder.path("v.qnv")));
  CHECK(volume.status == 1);
  CHECK(volume.output.find("--isovalue") != std::string::npos);
}
