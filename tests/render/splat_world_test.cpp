// Tests of pairs of worlds with equal pictures: one uses a feature, the other does not. Both paths draw both worlds.

#include "tests/render/drawing.h"
#include "tests/render/splat_scenes.h"
#include "vrml/syntax/parser.h"

#include <glm/gtc/matrix_transform.hpp>

#include <map>
#include <string>

using namespace gs;
using namespace gs::render;
using namespace gs::render::testing;

namespace {

using NamedGeometries = std::map<std::string, std::shared_ptr<const qnv::Geometry>>;

/// World with QNV nodes that show the geometry of their first url.
struct GeometryWorld {
  GeometryWorld(const std::string& body, const NamedGeometries& named)
      : scene(std::make_unique<vrml::SceneGraph>("test.wrl")) {
    Diagnostics diagnostics;
    vrml::parse("#VRML V2.0 utf8\n" + body, *scene, diagnostics);
    for (const Diagnostic& d : diagnostics.entries()) UNSCOPED_INFO(d.text());
    REQUIRE(diagnostics.errors() == 0);
    for (std::uint32_t i = 1; i <= scene->nodes().count(); ++i) {
      const vrml::Node& node = scene->nodes().at(i);
      if (node.type->name != "QNV") continue;
      const auto* url = std::get_if<vrml::MFString>(&node.values[node.type->find_field("url")->slot]);
      REQUIRE(url);
      REQUIRE(!url->empty());
      geometries[&node] = named.at(std::string(url->front().view()));
    }
  }
  RenderList collect(const glm::vec3& viewer) { return render::collect(*scene, {}, meshes, viewer, geometries); }

  std::unique_ptr<vrml::SceneGraph> scene;
  MeshCache meshes;
  Geometries geometries;
};

const std::string kPaint =
    "appearance Appearance { material Material { diffuseColor 0.9 0.5 0.3 specularColor 0.4 0.4 0.4 } }";

std::string shape(const std::string& geometry) {
  return "Shape { " + kPaint + " geometry QNV { url \"" + geometry + "\" } }\n";
}

Camera upright_camera(const glm::vec3& eye) {
  Camera camera;
  camera.world_from_camera = glm::inverse(glm::lookAt(eye, glm::vec3(0), glm::vec3(0, 1, 0)));
  return camera;
}

double psnr(const Image& a, const Image& b) {
  REQUIRE(a.pixels.size() == b.pixels.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const double difference = static_cast<double>(a.pixels[i]) - static_cast<double>(b.pixels[i]);
    sum += difference * difference;
  }
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(a.pixels.size()) / std::max(sum, 1e-9));
}

/// Draws both worlds on both paths. Neither picture may be empty.
void check_alike(const std::string& world, const std::string& same, const NamedGeometries& geometries, double least,
                 const glm::vec3& eye = {0, 0.5f, 6}) {
  static Drawing drawing;
  drawing.options.width = 160;
  drawing.options.height = 120;
  drawing.options.samples = 4;
  GeometryWorld first(world, geometries), second(same, geometries);
  const RenderList a = first.collect(eye), b = second.collect(eye);
  for (const SplatPath path : {SplatPath::cpu, SplatPath::gl}) {
    drawing.options.splats = path;
    const Image nothing = drawing.draw({}, upright_camera(eye)), of_a = drawing.draw(a, upright_camera(eye)),
                of_b = drawing.draw(b, upright_camera(eye));
    CHECK(psnr(of_b, nothing) < 25);
    INFO((path == SplatPath::gl ? "gl" : "cpu") << ", PSNR " << psnr(of_a, of_b));
    CHECK(psnr(of_a, of_b) >= least);
  }
}

/// Returns the splats transformed by `matrix`, with the areas of their ellipses.
std::shared_ptr<const qnv::Geometry> moved(const qnv::Splats& geometry, const glm::mat4& matrix) {
  auto result = std::make_shared<qnv::Splats>(geometry);
  const glm::mat3 linear(matrix), normals = glm::transpose(glm::inverse(linear)) * glm::determinant(linear);
  result->description.box = {};
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    result->positions[i] = glm::vec3(matrix * glm::vec4(geometry.positions[i], 1));
    const glm::vec3 n = normals * geometry.normals[i];
    result->normals[i] = glm::normalize(n);
    result->weights[i] = geometry.weights[i] * glm::length(n);
    result->description.box.add(result->positions[i]);
  }
  return shared_geometry(result);
}

/// Returns a sphere that is red towards +Z and green towards +X.
std::shared_ptr<const qnv::Geometry> painted() {
  auto geometry = sphere(3000);
  for (const glm::vec3& p : geometry->positions)
    geometry->colors.push_back(p.z > 0.6f   ? qnv::Rgb8{230, 20, 20}
                               : p.x > 0.6f ? qnv::Rgb8{20, 230, 20}
                                            : qnv::Rgb8{60, 60, 200});
  return shared_geometry(geometry);
}

}  // namespace

TEST_CASE("draws splats under Transforms like splats with transformed positions") {
  const auto ball = sphere(8000);
  glm::mat4 rigid = glm::translate(glm::mat4(1), glm::vec3(0.7f, -0.3f, 0.5f));
  rigid = glm::scale(glm::rotate(rigid, 0.8f, glm::vec3(0, 0, 1)), glm::vec3(1.4f));
  check_alike(
      "Transform { translation 0.7 -0.3 0.5 rotation 0 0 1 0.8 scale 1.4 1.4 1.4 children " + shape("ball") + "}",
      shape("moved"), {{"ball", shared_geometry(ball)}, {"moved", moved(*ball, rigid)}}, 50);
  // Non-uniform after a rotation, so that it shears.
  glm::mat4 shear = glm::scale(glm::mat4(1), glm::vec3(1.7f, 0.7f, 1.1f));
  shear = glm::rotate(shear, 0.6f, glm::vec3(0, 0, 1));
  check_alike("Transform { scale 1.7 0.7 1.1 children Transform { rotation 0 0 1 0.6 children " + shape("ball") + "} }",
              shape("moved"), {{"ball", shared_geometry(ball)}, {"moved", moved(*ball, shear)}}, 55);
}

TEST_CASE("draws splats under any scale like the polygons that they represent") {
  const auto ball = sphere(20000);
  for (const std::string scale : {"1 1 1", "2 0.5 1", "0.3 1.5 1.5"}) {
    const std::string before = "Transform { rotation 0 0 1 0.4 scale " + scale + " children ";
    check_alike(before + shape("ball") + "}", before + "Shape { " + kPaint + " geometry Sphere { radius 1 } } }",
                {{"ball", shared_geometry(ball)}}, 44);
  }
}

TEST_CASE("hides splats and polygons behind each other like polygons") {
  const auto ball = sphere(20000);
  const std::string board =
      "Transform { rotation 0 1 0 0.7 children Shape { appearance Appearance { material Material { "
      "emissiveColor 0.1 0.7 0.2 diffuseColor 0 0 0 } } geometry Box { size 3 1 0.02 } } }\n";
  const std::string sphere_shape = "Shape { " + kPaint + " geometry Sphere { radius 1 } }\n";
  check_alike(board + shape("ball"), board + sphere_shape, {{"ball", shared_geometry(ball)}}, 40);
  check_alike(shape("ball") + board, board + sphere_shape, {{"ball", shared_geometry(ball)}}, 40);
  // Panes of glass are in front of the splats and behind them.
  const auto glass = [](const std::string& z) {
    return "Transform { translation 0 0 " + z +
           " children Shape { appearance Appearance { material Material { emissiveColor 0.2 0.2 0.9 diffuseColor 0 0 0 "
           "transparency 0.5 } } geometry Box { size 3 1 0.02 } } }\n";
  };
  check_alike(glass("2") + shape("ball") + glass("-2"), glass("2") + sphere_shape + glass("-2"),
              {{"ball", shared_geometry(ball)}}, 40);
}

TEST_CASE("draws intersecting splat items like one joint item") {
  auto red = std::make_shared<qnv::Splats>(*sphere(8000)), blue = std::make_shared<qnv::Splats>(*red);
  red->colors.assign(red->size(), {220, 40, 40});
  blue->colors.assign(blue->size(), {40, 40, 220});
  for (glm::vec3& p : blue->positions) p += glm::vec3(0.8f, 0.2f, 0.3f);
  blue->description.box = {{-0.2f, -0.8f, -0.7f}, {1.8f, 1.2f, 1.3f}};
  auto both = std::make_shared<qnv::Splats>(*red);
  both->description.box.add(blue->description.box.upper);
  for (std::size_t i = 0; i < blue->size(); ++i) {
    both->positions.push_back(blue->positions[i]);
    both->normals.push_back(blue->normals[i]);
    both->weights.push_back(blue->weights[i]);
    both->colors.push_back(blue->colors[i]);
  }
  const NamedGeometries geometries{
      {"red", shared_geometry(red)}, {"blue", shared_geometry(blue)}, {"both", shared_geometry(both)}};
  check_alike(shape("red") + shape("blue"), shape("both"), geometries, 37);
  check_alike(shape("blue") + shape("red"), shape("both"), geometries, 37);
}

TEST_CASE("chooses among splat items by Switch and LOD") {
  const NamedGeometries geometries{
      {"ball", shared_geometry(sphere(3000))}, {"coarse", shared_geometry(sphere(60))}, {"painted", painted()}};
  check_alike("Switch { whichChoice 1 choice [ " + shape("ball") + shape("painted") + "] }", shape("painted"),
              geometries, 100);
  GeometryWorld none("Switch { choice " + shape("ball") + "}", geometries);
  CHECK(none.collect({0, 0, 10}).splats.empty());
  const std::string lod = "LOD { range [ 5 ] level [ " + shape("ball") + shape("coarse") + "] }";
  check_alike(lod, shape("ball"), geometries, 100, {0, 0.5f, 4});
  check_alike(lod, shape("coarse"), geometries, 100, {0, 0.5f, 6});
}

TEST_CASE("turns the splats of a Billboard to the viewer") {
  const NamedGeometries geometries{{"painted", painted()}};
  // Seen from +X, the side of +Z turns to the viewer, as by a quarter turn about Y.
  check_alike("Billboard { children " + shape("painted") + "}",
              "Transform { rotation 0 1 0 1.5707963 children " + shape("painted") + "}", geometries, 50, {6, 0, 0});
  check_alike("Billboard { children " + shape("painted") + "}", shape("painted"), geometries, 60, {0, 0, 6});
}

TEST_CASE("draws the splats of each instance of a PROTO at its position") {
  const NamedGeometries geometries{{"painted", painted()}};
  const std::string proto =
      "PROTO Place [ field SFVec3f at 0 0 0 field SFVec3f size 1 1 1 ] { Transform { translation IS at scale IS size "
      "children " +
      shape("painted") + "} }\n";
  check_alike(proto + "Place { at -1.2 0 0 } Place { at 1.2 0.3 0 size 0.5 1 0.8 }",
              "Transform { translation -1.2 0 0 children " + shape("painted") +
                  "} Transform { translation 1.2 0.3 0 scale 0.5 1 0.8 children " + shape("painted") + "}",
              geometries, 100);
  // One geometry by USE, and a stream at two instances.
  const NamedGeometries stream{{"stream", bumpy_stream(5000)}};
  check_alike("Transform { translation -1.2 0 0 children DEF S " + shape("stream") +
                  "} Transform { translation 1.2 0 -6 children USE S }",
              "Transform { translation -1.2 0 0 children " + shape("stream") +
                  "} Transform { translation 1.2 0 -6 children " + shape("stream") + "}",
              stream, 60);
}

TEST_CASE("collects the detail of a QNV node within bounds") {
  const NamedGeometries geometries{{"ball", shared_geometry(sphere(100))}};
  const auto detail = [&](const std::string& value) {
    GeometryWorld world("Shape { geometry QNV { url \"ball\" " + value + " } }", geometries);
    const RenderList list = world.collect({0, 0, 10});
    REQUIRE(list.splats.size() == 1);
    return list.splats[0].detail;
  };
  CHECK(detail("") == 1);
  CHECK(detail("detail 2.5") == 2.5f);
  CHECK(detail("detail 1e30") == 100);
  CHECK(detail("detail 0") == 0.01f);
  CHECK(detail("detail -3") == 0.01f);
}

TEST_CASE("draws streams by budget and detail, and reports pending data") {
  Drawing drawing;
  GeometryWorld world("Shape { geometry QNV { url \"stream\" } }", {{"stream", bumpy_stream(60000)}});
  const Camera camera = upright_camera({0, 0, 3});
  RenderList list = world.collect({0, 0, 3});
  drawing.options.width = drawing.options.height = 200;
  (void)drawing.draw(list, camera);
  const std::size_t all = drawing.statistics.vectors;
  CHECK(!drawing.statistics.pending);
  CHECK(all > 5000);
  drawing.options.budget = 2000;
  (void)drawing.draw(list, camera);
  CHECK(drawing.statistics.vectors <= 2000);
  drawing.options.budget = 0;
  list.splats[0].detail = 0.1f;
  (void)drawing.draw(list, camera);
  CHECK(drawing.statistics.vectors < all / 4);

  GeometryWorld fresh("Shape { geometry QNV { url \"stream\" } }", {{"stream", bumpy_stream(60000)}});
  list = fresh.collect({0, 0, 3});
  drawing.options.most_decoded = 3000;
  drawing.options.viewport = 3;
  (void)drawing.draw(list, camera);
  CHECK(drawing.statistics.pending);
  for (int frame = 0; frame < 200 && drawing.statistics.pending; ++frame) (void)drawing.draw(list, camera);
  CHECK(!drawing.statistics.pending);
  // OpenGL estimates the splats in view.
  CHECK(static_cast<double>(drawing.statistics.vectors) == Approx(static_cast<double>(all)).epsilon(0.01));
}

TEST_CASE("draws colours that distinguish vectors with any material") {
  Drawing drawing;
  drawing.options.width = drawing.options.height = 64;
  GeometryWorld world(
      "Shape { appearance Appearance { material Material { diffuseColor 0 0 0 } } geometry QNV { url \"ball\" } }",
      {{"ball", shared_geometry(sphere(6000))}});
  const RenderList list = world.collect({0, 0, 4});
  for (const SplatPath path : {SplatPath::cpu, SplatPath::gl}) {
    drawing.options.splats = path;
    const auto middle = [&](ColorBy color_by) {
      drawing.options.splat_style.color_by = color_by;
      return pixel(drawing.draw(list, upright_camera({0, 0, 4})), 32, 32);
    };
    CHECK(middle(ColorBy::own) == glm::vec3(0));
    // The normal +Z is shown blue, and the headlight lights it head-on.
    check_color(middle(ColorBy::normal), {0.5f, 0.5f, 1}, 6);
    // The first splats of the spiral face +Z and are the oldest.
    check_color(middle(ColorBy::age), {0, 0, 1}, 6);
    check_color(middle(ColorBy::level), {0, 0, 1}, 6);
    check_color(middle(ColorBy::chunk), {1, 0, 0}, 6);
  }
}
